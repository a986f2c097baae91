"""The flow of twelve bodies beside heyoka's Taylor method and diffrax's Dopri8: integration alone and whole calls.

All integrate momenta and poses in double precision, one orbit, warm: heyoka's `propagate_until` in its default mode,
with quaternions on SO(3) and matrices elsewhere; diffrax's `diffeqsolve`, compiled, rtol = atol = 1e-10. The equations
of the peers are those of `peers/bodies.py`. Ends agree to 1e-12 of their size (those of Dopri8 to 1e-6) before
anything is timed; runs are taken in turns, ratios are medians of those of pairs.

    python benchmarks/flow_bodies.py [--rounds 31] [--tolerances 2.2e-16 1e-14] [--only NAME ...] [--ends 20 100]
    python benchmarks/flow_bodies.py --smoke
"""

import statistics
from collections.abc import Callable
from typing import Any

import numpy as np
from _command import leave_out, options, small
from _inside import integration
from peers.bodies import Body, bodies, first_of, rates_of, state_of
from peers.problems import State, in_turns, last, median_ratio
from peers.solvers import missing

import nonholo as nh

Solve = Callable[[float], Any]


def heyoka_taylor(body: Body, tolerance: float) -> Solve:
    """Return heyoka's compiled Taylor method: a function of the end that returns the last numbers."""
    import heyoka

    first = first_of(body, body.is_rotation)
    z = heyoka.make_vars(*(f"z{i}" for i in range(len(first))))
    equations = list(zip(z, rates_of(body, turned=body.is_rotation)(z), strict=True))
    integrator = heyoka.taylor_adaptive(equations, first, tol=tolerance)

    def solve(end: float) -> np.ndarray:
        integrator.time = 0.0
        integrator.state[:] = first
        integrator.propagate_until(end)
        return integrator.state

    return solve


def diffrax_dopri8(body: Body) -> Solve:
    """Return diffrax's Runge-Kutta method of order 8, compiled, in 64 bits."""
    import diffrax
    import jax
    import jax.numpy as jnp

    rate, first = rates_of(body, turned=body.is_rotation), first_of(body, body.is_rotation)

    @jax.jit
    def solution(z: jax.Array, end: jax.Array) -> jax.Array:
        return diffrax.diffeqsolve(
            diffrax.ODETerm(lambda _t, z, _args: jnp.stack(rate(z))), diffrax.Dopri8(), 0.0, end, None, z,
            stepsize_controller=diffrax.PIDController(rtol=1e-10, atol=1e-10), saveat=diffrax.SaveAt(t1=True),
            max_steps=1_000_000,
        ).ys[-1]  # fmt: skip

    def solve(end: float) -> np.ndarray:
        with jax.enable_x64(True):
            return np.asarray(solution(jnp.asarray(first), jnp.asarray(end)))

    return solve


def refuse_unless_equal(result: State, wanted: State, tolerance: float) -> None:
    """Refuse what integrates another motion."""
    for one, other in zip(result, wanted, strict=True):
        missed = np.abs(one - other).max() / max(1.0, np.abs(other).max())
        assert missed < tolerance, missed


def rows(body: Body, end: float, tolerances: list[float], dopri: Solve | None, rounds: int) -> list[str]:
    """Return times in microseconds and ratios at one end."""
    taylor = {tolerance: heyoka_taylor(body, tolerance) for tolerance in tolerances}
    call = {"restricted_velocity": body.velocity, "times": (0.0, end)}
    wanted = last(nh.flow(body.system, **call))
    for solve in taylor.values():
        refuse_unless_equal(state_of(body, solve(end), body.is_rotation), wanted, 1e-12)
    runs: dict[str, Callable[[], Any]] = {f"heyoka {tol:g}": lambda s=solve: s(end) for tol, solve in taylor.items()}
    runs |= {
        "integration": integration(body.system, np.array([0.0, end]), 1e-14, restricted_velocity=body.velocity),
        "call": lambda: nh.flow(body.system, **call),
    }
    durations = in_turns(runs, rounds)
    result = [f"{statistics.median(seconds) * 1e6:.0f}" for seconds in durations.values()]
    for ours in ("integration", "call"):
        result += [f"{median_ratio(durations[ours], durations[f'heyoka {tol:g}']):.2f}" for tol in tolerances]
    if dopri is not None:
        refuse_unless_equal(state_of(body, dopri(end), body.is_rotation), wanted, 1e-6)
        durations = in_turns({"dopri": lambda: dopri(end), "call": runs["call"]}, 5)
        result += [
            f"{statistics.median(durations['dopri']) * 1e3:.1f} ms",
            f"{median_ratio(durations['dopri'], durations['call']):.0f}",
        ]
    return [body.name, f"{end:g}", *result]


def main() -> None:
    """Print the table."""
    parser = options(__doc__)
    parser.add_argument("--rounds", type=int, default=small(31, 1))
    parser.add_argument("--tolerances", type=float, nargs="+", default=[2.2e-16, 1e-14])
    parser.add_argument("--ends", type=float, nargs="+", default=small([20.0, 100.0], [20.0]))
    parser.add_argument("--only", nargs="+", default=list(bodies())[: small(None, 2)])
    arguments = parser.parse_args()
    if reason := missing("heyoka"):
        leave_out(reason)
    tolerances, has_diffrax = arguments.tolerances, not missing("diffrax")
    head = ["body", "T", *(f"heyoka {tol:g}" for tol in tolerances), "integration us", "call us"]
    head += [f"{ours} / heyoka {tol:g}" for ours in ("integration", "call") for tol in tolerances]
    head += ["Dopri8", "Dopri8 / call"] if has_diffrax else []
    print("|", " | ".join(head), "|\n|", " | ".join(["---", *["---:"] * (len(head) - 1)]), "|", flush=True)
    for name in arguments.only:
        dopri = diffrax_dopri8(bodies()[name]) if has_diffrax else None
        for end in arguments.ends:
            print("|", " | ".join(rows(bodies()[name], end, tolerances, dopri, arguments.rounds)), "|", flush=True)


if __name__ == "__main__":
    main()
