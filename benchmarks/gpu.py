"""Steps per second of a million bodies on a GPU: the kernels' scalar functions, and `nh.rollout` with its derivatives.

The scalar functions of `nonholo.kernels` are mapped over tops and scanned by JAX.

A step takes a fixed number of Newton corrections from the extrapolated guess; the run counts the members whose last
root has a residual above rounding, and a few members are compared with `simulate`. The speed is set beside two limits
that are measured in the same run: copying memory, and multiply-adds in 64 bits. `--unroll` steps are one device loop
turn: one reads and writes the whole state for each step, more let the compiler keep it in registers.

`jax.vmap` of `nh.rollout` runs a tenth as many tops and sleighs, and derivatives of each last pose by its start; poses
are compared with `simulate`, derivatives with differences.

    python benchmarks/gpu.py [--members 1000000] [--steps 256] [--unroll 1 4 16] [--cpu] [--smoke]

Without a GPU it says so and ends; with `--cpu` or `--smoke` it runs on the processor, to check the script.
"""

import functools
import statistics
import time
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from _command import SMOKE, leave_out, options, small
from _inside import correction, kernels

import nonholo as nh

CORRECTIONS = 3
ROUNDS = small(7, 1)
State = tuple[jax.Array, ...]  # momenta, their compensations, three charts, pose: 14 numbers, as in the compiled loop


def corrected(body: kernels.Body, m1: Any, m2: Any, y1: Any, y2: Any) -> tuple[Any, Any]:
    """Return the root reached from a guess."""
    for _ in range(CORRECTIONS):
        d1, d2 = correction(body, m1, m2, y1, y2)
        y1, y2 = y1 + d1, y2 + d2
    return y1, y2


def compensated(total: Any, lost: Any, term: Any) -> tuple[Any, Any]:
    """Add by Kahan's summation."""
    term = term - lost
    result = total + term
    return result, (result - total) - term


def step(body: kernels.Body, state: State) -> State:
    """Take one step of one member."""
    m1, m2, k1, k2, y1, y2, u1, u2, v1, v2, *pose = state
    d1, d2 = kernels.increment(body, m1, m2, y1, y2)
    (m1, k1), (m2, k2) = compensated(m1, k1, d1), compensated(m2, k2, d2)
    pose = kernels.move(body, y1, y2, *pose)
    w1, w2 = corrected(body, m1, m2, 3 * (y1 - u1) + v1, 3 * (y2 - u2) + v2)
    return m1, m2, k1, k2, w1, w2, y1, y2, u1, u2, *pose


@functools.partial(jax.jit, static_argnames=("body", "steps", "unroll"))
def run(body: kernels.Body, states: State, steps: int, unroll: int) -> State:
    """Run all members."""
    each = jax.vmap(functools.partial(step, body))
    return jax.lax.scan(lambda s, _: (each(s), None), states, None, length=steps, unroll=unroll)[0]


def first_states(body: kernels.Body, momenta: jax.Array) -> State:
    """Return the states of runs at rest in space, with roots corrected from zero in more than enough updates."""
    m1, m2 = momenta
    zero = jnp.zeros_like(m1)
    y1, y2 = zero, zero
    for _ in range(3):
        y1, y2 = corrected(body, m1, m2, y1, y2)
    return m1, m2, zero, zero, y1, y2, y1, y2, y1, y2, zero + 1, zero, zero, zero


def wrong(body: kernels.Body, states: State) -> int:
    """Return how many members are not on a certified root."""
    m1, m2, _, _, y1, y2 = states[:6]
    g1, g2 = jax.vmap(functools.partial(kernels.residual, body))(m1, m2, y1, y2)
    certain = jax.vmap(functools.partial(kernels.is_certain, body))(m1, m2, y1, y2)
    size = jnp.abs(m1) + jnp.abs(m2)
    return int(jnp.sum(~(certain & (jnp.abs(g1) + jnp.abs(g2) < 1e-13 * size))))


def seconds(make: Callable[[], Any], function: Callable[[Any], Any]) -> float:
    """Return the median time of a call, compiled before."""
    jax.block_until_ready(function(make()))
    times = []
    for _ in range(ROUNDS):
        argument = jax.block_until_ready(make())
        begin = time.perf_counter()
        jax.block_until_ready(function(argument))
        times.append(time.perf_counter() - begin)
    return statistics.median(times)


def bandwidth(size: int) -> float:
    """Return bytes per second of reading and writing an array."""
    turns = 20
    copy = jax.jit(lambda x: jax.lax.fori_loop(0, turns, lambda _, x: x + 1.0, x), donate_argnums=0)
    return 16 * size * turns / seconds(lambda: jnp.zeros(size), copy)


def arithmetic(size: int) -> float:
    """Return 64-bit operations per second of chains of multiply-adds, four on each element."""
    turns, chain = 50, 64

    def work(x: State) -> State:
        for _ in range(chain):
            x = tuple(a * 0.999 + 0.001 for a in x)
        return x

    busy = jax.jit(lambda x: jax.lax.fori_loop(0, turns, lambda _, x: work(x), x))
    return 8 * chain * turns * size / seconds(lambda: tuple(jnp.full(size, float(i)) for i in range(4)), busy)


def check(discrete: nh.Discretization, body: kernels.Body, momenta: np.ndarray, scale: float, steps: int) -> None:
    """Refuse to time what does not agree with `simulate` in momentum and pose."""
    few = momenta[:, :4]
    end = run(body, first_states(body, jnp.asarray(few)), steps, 1)
    for j in range(few.shape[1]):
        orbit = nh.simulate(discrete, momentum=few[:, j] / scale, steps=steps, save_every=steps)
        assert np.allclose(orbit.reduced_momentum[-1] * scale, [end[0][j], end[1][j]], rtol=0, atol=1e-12)
        assert np.allclose(orbit.pose[-1], [float(q[j]) for q in end[10:]], rtol=0, atol=1e-11)


def main() -> None:
    """Print the figures."""
    parser = options(__doc__)
    parser.add_argument("--members", type=int, default=small(1_000_000, 64))
    parser.add_argument("--steps", type=int, default=small(256, 8))
    parser.add_argument("--unroll", type=int, nargs="+", default=small([1, 4, 16], [1, 2]))
    parser.add_argument("--cpu", action="store_true")
    arguments = parser.parse_args()
    device = jax.devices()[0]
    if device.platform == "cpu" and not (arguments.cpu or SMOKE):
        leave_out("no GPU here. With --cpu or --smoke it runs on the processor.")
    top = nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]])
    discrete = nh.discretize(top, 0.05)
    closed = discrete.route
    assert closed.is_scalar
    velocities = np.random.default_rng(0).uniform(-1, 1, (arguments.members, 2))
    momenta = float(closed.scale) * (velocities @ top.constrained_inertia).T
    check(discrete, closed.body, momenta, float(closed.scale), arguments.steps)
    memory, flops = bandwidth(16 * arguments.members), arithmetic(arguments.members)
    print(f"{device.device_kind}: {memory / 1e9:.0f} GB/s copying, {flops / 1e12:.2f} Tflop/s in 64 bits")

    def make() -> State:
        return first_states(closed.body, jnp.asarray(momenta))

    one = jax.jit(jax.vmap(functools.partial(step, closed.body))).lower(make()).compile().cost_analysis()
    each = one["flops"] / arguments.members
    print(f"a step: {each:.0f} operations, {2 * 8 * len(make())} bytes read and written")
    for unroll in arguments.unroll:
        print(line(closed.body, make, arguments.members, arguments.steps, unroll, memory, flops / each))
    few = velocities[: arguments.members // 10]
    sleigh = nh.discretize(nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.5), 0.1)
    for name, body in (("top", discrete), ("sleigh", sleigh)):
        print(f"rollouts, {name}: {rollouts(functools.partial(started, body), few, arguments.steps)}")
    for name, number in (("snakeboard", "mass"), ("rattleback", "gravity")):
        example = getattr(nh.examples, name)()
        values = example.system.parameters[number] * (1 + 0.1 * few[:, :1])
        print(f"rollouts, {name}, by its {number}: {rollouts(functools.partial(varied, example, number), values, 64)}")


def started(discrete: nh.Discretization, numbers: Any) -> tuple[nh.Discretization, dict[str, Any]]:
    """Return the body and the start with these velocities."""
    return discrete, {"restricted_velocity": numbers}


def varied(example: Any, name: str, numbers: Any) -> tuple[Any, dict[str, Any]]:
    """Return the robot with another number, and its own start."""
    system = example.system.with_parameters(**{name: numbers[0]})
    start = {"configuration": example.configuration, "body_velocity": example.body_velocity}
    return nh.discretize(system, example.time_step), start


def rollouts(member: Callable[[Any], tuple[Any, dict[str, Any]]], numbers: np.ndarray, steps: int) -> str:
    """Return the speed of rollouts and of their derivatives, compared with `simulate` and differences."""

    def last(run: Callable[..., Any], own: Any) -> Any:
        discrete, start = member(own)
        return run(discrete, **start, steps=steps, save_every=steps).configuration[-1]

    ends = jax.jit(jax.vmap(functools.partial(last, nh.rollout)))
    slopes = jax.jit(jax.vmap(jax.jacrev(lambda own: last(nh.rollout, own).sum())))
    poses, derivatives = ends(numbers), slopes(numbers)
    for j in range(0, len(numbers), max(len(numbers) // 16, 1)):
        assert np.allclose(poses[j], last(nh.simulate, numbers[j]), rtol=0, atol=1e-12)
    step = 1e-6 * np.eye(numbers.shape[1])
    sums = np.asarray(ends(np.concatenate([numbers[0] + step, numbers[0] - step])))
    sums = sums.reshape(2, len(step), -1).sum(-1)
    assert np.allclose(derivatives[0], (sums[0] - sums[1]) / np.float64(2e-6), rtol=1e-6, atol=1e-6)
    work = len(numbers) * steps
    rate, slope_rate = (work / seconds(lambda: jnp.asarray(numbers), f) for f in (ends, slopes))
    return f"{rate:.3g} steps/s, with derivatives {slope_rate:.3g}"


def line(
    body: kernels.Body, make: Callable[[], State], members: int, steps: int, unroll: int, memory: float, most: float
) -> str:
    """Return speed and limits for one length of the loop body."""
    lost = wrong(body, run(body, make(), steps, unroll))
    rate = members * steps / seconds(make, lambda states: run(body, states, steps, unroll))
    bound = memory / (2 * 8 * len(make()) / unroll)
    return (
        f"{unroll:3} steps a turn: {rate:.3g} steps/s, {rate / bound:.0%} of the memory limit {bound:.2g}, "
        f"{rate / most:.0%} of the arithmetic limit {most:.2g}; {lost} members not certified"
    )


if __name__ == "__main__":
    with jax.enable_x64(True):
        main()
