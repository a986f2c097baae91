"""Time of one step of the general map on SO(4), dim d = 3, beside naive versions in JAX, in one run, in turns.

The naive version is what one writes first: W = expm(x), the momentum equations, Newton's method with `jax.jacfwd` and
`expm` at each update, started from the last x; it has no certificate and no continuation. It is run twice: with the
Newton update compiled and called from a Python loop, and with the whole run compiled into one program. All three are
checked to end at the same displacement before anything is timed.

    python benchmarks/generic_step.py [--smoke]
"""

import statistics
import time
from collections.abc import Callable

import jax
import jax.numpy as jnp
import numpy as np
from _command import options, small

import nonholo as nh

STEPS, ROUNDS, TIME_STEP = small(5000, 20), small(9, 1), 0.1
CONVERGED = 1e-9  # length of the last Newton update, whose error is its square


def systems() -> dict[str, tuple[nh.LLSystem | nh.SuslovTop, int]]:
    """Return a top, whose exp d is the variety, and a general d, with the number of unknowns of their equations."""
    rng = np.random.default_rng(1)
    points = rng.normal(size=(6, 4))
    rows = np.linalg.qr(rng.normal(size=(6, 3)))[0].T
    J = points.T @ points / 6
    return {"Suslov top": (nh.SuslovTop(J), 3), "general subspace": (nh.LLSystem(nh.SO(4), J, rows), 6)}


class Naive:
    """The naive version for one system."""

    def __init__(self, system: nh.LLSystem | nh.SuslovTop, unknowns: int) -> None:
        self.group, self.exact = system.group, unknowns == 3
        self.basis, self.J = jnp.asarray(system.group.basis), jnp.asarray(system.homogeneous_mass_tensor)
        self.rows, self.forbidden = jnp.asarray(system.constraint_subspace), jnp.asarray(system.annihilator)
        self.chart = jnp.einsum("ai,ijk->ajk", self.rows, self.basis) if self.exact else self.basis
        self.compiled_update, self.compiled_target = jax.jit(self.update), jax.jit(self.target)
        self.compiled_run = jax.jit(self.scan)

    def displaced(self, x: jax.Array) -> jax.Array:
        """Return exp(x)."""
        return jax.scipy.linalg.expm(jnp.einsum("a,ajk->jk", x, self.chart))

    def along(self, momentum: jax.Array) -> jax.Array:
        """Return the components of a momentum along d."""
        return self.rows @ jnp.einsum("iab,ab->i", self.basis, momentum)

    def target(self, x: jax.Array) -> jax.Array:
        """Return the momenta along d that arrive after a displacement."""
        W = self.displaced(x)
        return self.along((self.J @ (W - jnp.eye(4)).T @ W).T)

    def equations(self, x: jax.Array, target: jax.Array) -> jax.Array:
        """Return the residual."""
        W = self.displaced(x)
        missed = self.along((W @ self.J @ (W - jnp.eye(4)).T).T) - target
        skew = self.forbidden @ self.group.vee((W - W.T) / 2)
        return missed if self.exact else jnp.concatenate([missed, skew])

    def update(self, x: jax.Array, target: jax.Array) -> tuple[jax.Array, jax.Array]:
        """Return x after one Newton update, and its length."""
        correction = jnp.linalg.solve(jax.jacfwd(self.equations)(x, target), self.equations(x, target))
        return x - correction, jnp.linalg.norm(correction)

    def loop(self, x: jax.Array) -> jax.Array:
        """Run in a Python loop."""
        for _ in range(STEPS):
            target, size = self.compiled_target(x), 1.0
            while size > CONVERGED:
                x, size = self.compiled_update(x, target)
        return self.displaced(x)

    def scan(self, x: jax.Array) -> jax.Array:
        """Run as one program."""

        def step(x: jax.Array, _: None) -> tuple[jax.Array, None]:
            target = self.target(x)
            start = (x, jnp.ones(()))
            return jax.lax.while_loop(lambda c: c[1] > CONVERGED, lambda c: self.update(c[0], target), start)[0], None

        return self.displaced(jax.lax.scan(step, x, None, length=STEPS)[0])

    def start(self, displacement: np.ndarray) -> jax.Array:
        """Return the x of a displacement."""
        x = self.group.log(displacement)
        return jnp.asarray(np.linalg.pinv(self.rows.T) @ x if self.exact else x)


def seconds(function: Callable[[], object]) -> float:
    """Return the wall time of a call."""
    begin = time.perf_counter()
    jax.block_until_ready(function())
    return time.perf_counter() - begin


def compare(name: str, system: nh.LLSystem | nh.SuslovTop, unknowns: int) -> None:
    """Check, time in turns, print medians."""
    discrete, start = nh.discretize(system, TIME_STEP), {"restricted_velocity": (0.5, -0.4, 0.3)}
    orbit = nh.simulate(discrete, steps=STEPS, **start)
    by_expm = Naive(system, unknowns)
    first = by_expm.start(orbit.displacement[0])
    runs = (
        lambda: nh.simulate(discrete, steps=STEPS, **start),
        lambda: by_expm.compiled_run(first),
        lambda: by_expm.loop(first),
    )
    difference = max(float(np.abs(run() - orbit.displacement[-1]).max()) for run in runs[1:])
    if difference > 1e-9:
        raise SystemExit(f"{name}: the runs differ by {difference:.3g}")
    turns = [[1e6 * seconds(run) / STEPS for run in runs] for _ in range(ROUNDS)]
    ours, program, loop = map(statistics.median, zip(*turns, strict=True))
    ratios = [statistics.median(turn[j] / turn[0] for turn in turns) for j in (1, 2)]
    print(f"{name}: {ours:.1f} us a step; all agree to {difference:.0e}")
    print(f"  naive, Newton updates compiled, Python loop: {loop:.0f} us, ratio {ratios[1]:.0f}")
    print(f"  naive, the whole run one compiled program: {program:.0f} us, ratio {ratios[0]:.0f}")


if __name__ == "__main__":
    options(__doc__).parse_args()
    with jax.enable_x64(True):
        for name, (system, unknowns) in systems().items():
            compare(name, system, unknowns)
