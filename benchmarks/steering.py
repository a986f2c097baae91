"""Many sleighs are parked at once: time per member, how many arrive, and with how much effort.

    python benchmarks/steering.py [--members 1000] [--rounds 3] [--compare] [--obstacles] [--smoke]

Starts are random poses (angles, and places within some units of length) and velocities, goals the pose at the origin,
at rest; 40 steps over 4 units of time, with torque and thrust along the blade. The first call compiles. Seconds of the
processor stand beside those of the clock, which grow with whatever else runs.

With --compare, the same problems by the same solver on other steps too: Runge's and Kutta's of fourth order and the
implicit midpoint, of the reduced equations with angle and place; then in steps ten times as long. The controls that
each finds, constant over a step, go through the continuous sleigh, and what these miss there is printed.

With --obstacles, a robot on two wheels among ten discs by IPOPT, from a straight guess and from a path, in 100 to 800
steps over ten units of time: seconds, iterations, effort.
"""

import functools
import statistics
import time
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from _command import SMOKE, small
from _command import options as command
from _inside import Gaps, best, in_double
from scipy.integrate import solve_ivp

import nonholo as nh

DURATION, STEPS = 4.0, small(40, 20)
SLEIGH = nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.2)
MASS, A = float(SLEIGH.mass), float(SLEIGH.a)
INERTIA = float(SLEIGH.inertia) + MASS * A**2  # about the point of contact
GOAL = {"configuration": np.eye(3), "restricted_velocity": (0.0, 0.0)}
BLOCK = 32  # members in one compiled call, as in `nh.steer`
NEWTON = 12  # iterations of the midpoint
Step = Callable[[Any, Any, float], Any]


def starts(count: int) -> dict[str, np.ndarray]:
    """Return random poses and velocities."""
    rng = np.random.default_rng(0)
    poses = np.array([nh.SE(2).random(rng) for _ in range(count)])
    return {"configuration": poses, "restricted_velocity": rng.normal(scale=0.5, size=(count, 2))}


def rate(z: Any, f: Any) -> Any:
    """Return the derivative of angle, place, and velocities (turn, along the blade) under torque and thrust."""
    xp, (angle, _, _, turn, along) = z.__array_namespace__(), z
    fast = (f[0] - MASS * A * along * turn) / INERTIA, f[1] / MASS + A * turn**2
    return xp.stack([turn, along * xp.cos(angle), along * xp.sin(angle), *fast])


def runge_kutta(z: Any, f: Any, h: float) -> Any:
    """Return the state after one step of fourth order."""
    k1 = rate(z, f)
    k2 = rate(z + h / 2 * k1, f)
    k3 = rate(z + h / 2 * k2, f)
    return z + h / 6 * (k1 + 2 * k2 + 2 * k3 + rate(z + h * k3, f))


def midpoint(z: Any, f: Any, h: float) -> Any:
    """Return the state after one step of the implicit midpoint; NaN where Newton's method finds none.

    Without the speed along the blade the turn at the middle is a root of a cubic.
    """
    k, turn, along = h / 2, *z[3:]
    cubic = k**2 * MASS * A**2 / INERTIA
    linear, constant = 1 + k * MASS * A / INERTIA * (along + k * f[1] / MASS), turn + k * f[0] / INERTIA

    def corrected(x: Any) -> Any:
        return x - (cubic * x**3 + linear * x - constant) / jax.lax.stop_gradient(3 * cubic * x**2 + linear)

    root = turn
    for _ in range(NEWTON):
        root = jax.lax.stop_gradient(corrected(root))
    last = corrected(root)  # whose derivative is that of the root
    middle = z + k * jnp.stack([last, 0.0, 0.0, 0.0, f[1] / MASS + A * last**2])
    ahead = z + h * rate(middle.at[3].set(last), f)
    return jnp.where(abs(last - root) < 1e-12 * (1 + abs(root)), ahead, jnp.nan)


@functools.partial(jax.jit, static_argnums=0)
def _missed(step: Step, forces: Any, first: Any) -> tuple[Any, Any]:
    def missed(f: Any, z: Any) -> tuple[Any, Any]:
        gap = off_goal(jax.lax.scan(lambda z, f: (step(z, f, DURATION / len(forces[0])), None), z, f)[0])
        return gap, gap

    slopes, values = jax.vmap(jax.jacrev(missed, has_aux=True))(forces, first)
    return values, slopes.reshape(*values.shape, -1)


def off_goal(z: Any) -> Any:
    """Return by what a state misses the origin at rest, as `nh.steer` measures it: log of the pose, velocities."""
    xp, (angle, x, y) = z.__array_namespace__(), z[:3]
    c, s, one = xp.cos(angle), xp.sin(angle), xp.ones_like(x)
    pose = xp.stack([xp.stack([c, -s, x]), xp.stack([s, c, y]), xp.stack([0 * x, 0 * x, one])])
    return xp.concatenate([nh.SE(2).log(pose), z[3:]])


def missed_by(step: Step, first: np.ndarray, steps: int) -> Gaps:
    """Return what forces miss the goal by on orbits of a step, and the derivatives."""

    def missed(forces: np.ndarray, at: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        f, z = forces.reshape(-1, steps, 2), first[at]
        blocks = np.arange(-(-len(f) // BLOCK) * BLOCK).reshape(-1, BLOCK) % len(f)
        parts = [in_double(functools.partial(_missed, step), f[block], z[block]) for block in blocks]
        values, slopes = (np.concatenate(part)[: len(f)] for part in zip(*parts, strict=True))
        return values, slopes

    return missed


def solved(step: Step | None, begin: dict[str, np.ndarray], steps: int) -> tuple[np.ndarray, ...]:
    """Return forces (members, steps, 2), what they miss on their own orbit, and whether they are of least effort."""
    if step is None:
        parked = nh.steer(nh.discretize(SLEIGH, DURATION / steps), begin, GOAL, steps=steps)
        return parked.controls[..., :2], parked.missed, parked.converged
    size = np.tile(np.sqrt(steps) * np.array([INERTIA, MASS]) / DURATION**2, (len(begin["configuration"]), steps))
    free = np.full(2 * steps, np.inf)
    first = states(begin)
    forces, missed, is_least = best(missed_by(step, first, steps), size, (-free, free))
    return forces.reshape(-1, steps, 2), np.abs(missed).max(axis=1), is_least


def states(begin: dict[str, np.ndarray]) -> np.ndarray:
    """Return angles, places and velocities of members."""
    g = begin["configuration"]
    return np.column_stack([np.arctan2(g[:, 1, 0], g[:, 0, 0]), g[:, :2, 2], begin["restricted_velocity"]])


def driven(first: np.ndarray, forces: np.ndarray) -> np.ndarray:
    """Return the last states (members, 5) of continuous sleighs under forces that are constant over each step."""
    z, h = first.T, DURATION / forces.shape[1]
    for f in forces.transpose(1, 2, 0):
        flat = solve_ivp(
            lambda _, y, f=f, z=z: rate(y.reshape(z.shape), f).ravel(),
            (0, h),
            z.ravel(),
            "DOP853",
            rtol=1e-13,
            atol=1e-13,
        )
        z = flat.y[:, -1].reshape(z.shape)
    return z.T


def check() -> None:
    """Refuse equations here that are not those of the library's own flow under a constant force."""
    f, begin = np.array([[[0.7, -0.4]]]), starts(1)
    one = {name: rows[0] for name, rows in begin.items()}
    flow = nh.flow(nh.Forced(SLEIGH, force=lambda *_: (*f[0, 0], 0.0)), **one, times=(0, DURATION))
    end = states({"configuration": flow.configuration[-1:], "restricted_velocity": flow.body_velocity[-1:, :2]})
    far = driven(states(begin), f) - end
    far[:, 0] = np.sin(far[:, 0] / 2)  # an angle up to whole turns
    assert np.abs(far).max() < 1e-11


def compare(count: int) -> None:
    """Print what the controls of each step miss on the continuous sleigh; of long steps for a tenth of the members."""
    check()
    for name, step in {"exact": None, "Runge-Kutta": runge_kutta, "midpoint": midpoint}.items():
        for steps, members in ((STEPS, count), (STEPS // 10, count // 10)):
            begin = starts(members)
            solved(step, {name: rows[:BLOCK] for name, rows in begin.items()}, steps)  # compiles
            busy = time.process_time()
            forces, gap, is_least = solved(step, begin, steps)
            busy = 1e3 * (time.process_time() - busy) / members
            met = gap < 1e-8
            print(f"{name}, {steps} steps: {met.sum()} of {members} meet the goal, {is_least.sum()} at a minimum")
            if not met.any():
                continue
            effort = np.median(DURATION / steps * (forces[met] ** 2).sum(axis=(1, 2)) / 2)
            print(f"  {busy:.1f} ms of the processor a problem; median effort {effort:.3f}")
            off = np.abs([off_goal(z) for z in driven(states(begin)[met], forces[met])])
            for part, values in {"pose": off[:, :3], "velocity": off[:, 3:]}.items():
                low, middle, high = np.quantile(values.max(axis=1), (0.05, 0.5, 0.95))
                print(f"  true {part} misses by {middle:.1e} ({low:.1e} to {high:.1e}, at most {values.max():.1e})")


def speed(count: int, rounds: int) -> None:
    """Print the time of `nh.steer` alone, how many arrive, and with how much effort."""
    sleigh, times, used = nh.discretize(SLEIGH, DURATION / STEPS), [], []
    for _ in range(1 + rounds):
        began, busy = time.perf_counter(), time.process_time()
        parked = nh.steer(sleigh, starts(count), GOAL, steps=STEPS)
        times.append(1e3 * (time.perf_counter() - began) / count)
        used.append(1e3 * (time.process_time() - busy) / count)
    clock, processor = statistics.median(times[1:]), statistics.median(used[1:])
    print(f"{clock:.1f} ms a member ({processor:.1f} ms of the processor), {times[0]:.1f} ms in the first call")
    met = int((parked.missed < 1e-8).sum())
    print(f"{met} of {count} meet pose and velocity to 1e-8, {parked.failures} are not at a minimum")
    print(f"effort: median {np.median(parked.cost):.3f}, largest {parked.cost.max():.1f}")


def among_obstacles(rounds: int) -> None:
    """Print how long IPOPT takes for a robot among discs; its extra is needed for this alone."""
    from _inside import transcription

    wheels, counts = [[2.5, 0.5, 0.0], [-2.5, 0.5, 0.0]], []
    body = nh.LLSystem.from_inertia(1.0, 0.05, (0.05, 0.0), nh.SE(2), constraint_subspace=wheels)
    x, y = (0.2, 1.2, 1.0, 2.2, 2.0, 3.1, 3.2, 4.2, 2.9, 4.3), (1.0, 0.3, 1.6, 1.0, 2.3, 0.2, 1.9, 1.1, 3.0, 2.6)
    radii = 0.2 + np.array([0.3, 0.4, 0.35, 0.4, 0.35, 0.45, 0.4, 0.4, 0.4, 0.3])
    there = {"configuration": [[1, 0, 5], [0, 1, 3], [0, 0, 1]], "restricted_velocity": (0.0, 0.0)}
    solve = transcription.minimize

    def counted(*arguments: Any) -> Any:
        counts.append(-1)  # of the first point, which is no iteration
        return solve(*arguments)

    def is_over() -> bool:
        counts[-1] += 1
        return False

    transcription.minimize, transcription.is_over = counted, is_over
    for steps in small((100, 200, 400, 800), (50,)):
        robot = nh.discretize(body, 10.0 / steps)
        for name, guess in {"straight": None, "path": [(0.0, 0.0), (1.6, 1.6), (3.0, 1.2), (5.0, 3.0)]}.items():
            times = []
            for _ in range(1 + rounds):
                counts.clear()
                began, busy = time.perf_counter(), time.process_time()
                obstacles = np.column_stack([x, y]), radii
                way = nh.steer(robot, {}, there, steps=steps, obstacles=obstacles, bounds=(-1, 1), guess=guess)
                times.append((time.process_time() - busy, time.perf_counter() - began))
            busy, clock = np.median(times[1:], axis=0)
            print(f"{steps} steps, {name} guess: {way.outcome}, {busy:.2f} s of the processor ({clock:.2f} by clock)")
            print(f"  iterations {counts}, effort {way.cost:.4f}, missed {way.missed:.0e}, first {times[0][0]:.1f} s")


def main() -> None:
    """Print all figures."""
    options = command(__doc__)
    options.add_argument("--members", type=int, default=small(1000, 10))
    options.add_argument("--rounds", type=int, default=small(3, 1))
    options.add_argument("--compare", action="store_true")
    options.add_argument("--obstacles", action="store_true")
    chosen = options.parse_args()
    if chosen.obstacles or SMOKE:
        among_obstacles(chosen.rounds)
    if chosen.compare or SMOKE:
        compare(chosen.members)
    if not (chosen.obstacles or chosen.compare):
        speed(chosen.members, chosen.rounds)


if __name__ == "__main__":
    main()
