"""The continuous flow beside heyoka's Taylor method: integration alone, the whole call of `nh.flow`, and errors.

Both are warm, in double precision, one orbit with pose; heyoka's `propagate_until` in its default mode, at the
tolerance of the row, or `propagate_grid` where samples are stored. Ends are checked against a reference of 18 digits
before anything is timed; runs are taken in turns. First come momenta alone beside momenta and poses, and members with
parameters beside members without.

    python benchmarks/flow.py [--rounds 31] [--smoke]
"""

import statistics
from collections.abc import Callable
from typing import Any

import numpy as np
from _command import leave_out, options, small
from _inside import in_one_thread, integration
from peers.problems import PROBLEMS, Problem, error, in_turns, last, median_ratio, reference
from peers.solvers import decoded, heyoka_taylor, missing, rates, start

import nonholo as nh

ENDS, TOLERANCES = small((20.0, 100.0, 1000.0), (20.0,)), small((1e-6, 1e-10, 1e-13, 1e-14), (1e-10, 1e-14))
SAMPLES, MEMBERS, MODERATE = small((1_000_000, 20_000, 100), (1000, 16, 10))


def rows(problem: Problem, end: float, rounds: int) -> list[tuple[str, ...]]:
    """Return times and errors at one end, tolerance by tolerance."""
    problem, times, result = problem._replace(end=end), np.array([0.0, end]), []
    wanted = reference(problem, end)
    for tolerance in TOLERANCES:
        start_of = {"body_velocity": problem.velocity, "times": times, "rtol": tolerance}
        taylor = heyoka_taylor(problem)
        runs: dict[str, Callable[[], Any]] = {
            "heyoka": lambda solve=taylor, tolerance=tolerance: solve(tolerance),
            "integration": integration(problem.system, times, tolerance, body_velocity=problem.velocity),
            "call": lambda arguments=start_of: nh.flow(problem.system, **arguments),
        }
        errors = error(problem, runs["heyoka"](), wanted), error(problem, last(runs["call"]()), wanted)
        assert max(errors) < 1e4 * tolerance + 1e-11, errors
        durations = in_turns(runs, rounds)
        row = [f"{statistics.median(seconds) * 1e6:.1f}" for seconds in durations.values()]
        ratios = [f"{median_ratio(durations[name], durations['heyoka']):.2f}" for name in ("integration", "call")]
        result.append((problem.name, f"{end:g}", f"{tolerance:.0e}", *row, *ratios, *(f"{one:.1e}" for one in errors)))
    return result


def samples(problem: Problem, rounds: int) -> tuple[str, ...]:
    """Return times of a million stored samples."""
    import heyoka

    grid, first = np.linspace(0.0, problem.end, SAMPLES + 1), start(problem)
    z = heyoka.make_vars(*(f"z{i}" for i in range(len(first))))
    equations = list(zip(z, rates(problem, heyoka.cos, heyoka.sin)(z), strict=True))
    integrator = heyoka.taylor_adaptive(equations, first, tol=1e-14)

    def peer() -> Any:
        integrator.time = 0.0
        integrator.state[:] = first
        return decoded(integrator.propagate_grid(grid)[-1][-1])

    runs = {"heyoka": peer, "call": lambda: nh.flow(problem.system, body_velocity=problem.velocity, times=grid)}
    wanted = reference(problem, problem.end)
    assert max(error(problem, runs["heyoka"](), wanted), error(problem, last(runs["call"]()), wanted)) < 1e-11
    durations = in_turns(runs, rounds)
    ns = [f"{statistics.median(seconds) / SAMPLES * 1e9:.0f} ns" for seconds in durations.values()]
    return problem.name, "a sample of a million", *ns, f"{median_ratio(durations['call'], durations['heyoka']):.2f}"


def ensembles(problem: Problem, rounds: int) -> tuple[str, ...]:
    """Return times of many live starts, in one thread on both sides; heyoka's batch mode at its recommended size."""
    import heyoka

    z = heyoka.make_vars(*(f"z{i}" for i in range(len(start(problem)))))
    equations = list(zip(z, rates(problem, heyoka.cos, heyoka.sin)(z), strict=True))
    lanes = heyoka.recommended_simd_size()
    integrator = heyoka.taylor_adaptive_batch(equations, np.tile(start(problem)[:, None], lanes), tol=1e-16)
    velocities = np.random.default_rng(0).normal(size=(MEMBERS, 2)) * 0.5
    firsts = np.tile(start(problem)[:, None], MEMBERS)
    firsts[:2] = velocities.T
    ends = np.empty_like(firsts)

    def peer() -> np.ndarray:
        for begin in range(0, MEMBERS, lanes):
            part = slice(begin, begin + lanes)
            integrator.set_time(0.0)
            integrator.state[:] = firsts[:, part]
            integrator.propagate_until(np.full(lanes, problem.end))
            ends[:, part] = integrator.state
        return ends

    full = np.pad(velocities, ((0, 0), (0, 1)))
    with in_one_thread():
        runs = {
            "heyoka": peer,
            "call": lambda: nh.ensemble(problem.system, body_velocity=full, times=(0.0, problem.end)),
        }
        batch = runs["call"]()
        result = batch.body_velocity[:, -1, :2] - runs["heyoka"]()[:2].T
        assert np.abs(result).max() < 1e-11, np.abs(result).max()
        durations = in_turns(runs, rounds)
    us = [f"{statistics.median(seconds) / MEMBERS * 1e6:.1f} us" for seconds in durations.values()]
    return problem.name, f"a member of {MEMBERS:,}", *us, f"{median_ratio(durations['call'], durations['heyoka']):.2f}"


def momenta(n: int, rounds: int) -> tuple[str, ...]:
    """Return times of a top on SO(n) over ten units of time, with poses where they are moderate, and momenta alone."""
    rng = np.random.default_rng(n)
    top = nh.SuslovTop.arrowhead(rng.uniform(1, 2, n), rng.normal(size=n - 1) / np.sqrt(n))
    arguments = {"restricted_velocity": rng.normal(size=n - 1) / np.sqrt(n), "times": (0.0, 10.0)}
    kinds = (True, False) if n <= MODERATE else (False,)
    runs = {str(poses): lambda poses=poses: nh.flow(top, **arguments, reconstruct=poses) for poses in kinds}
    durations = in_turns(runs, rounds)
    ms = [f"{statistics.median(seconds) * 1e3:.3g} ms" for seconds in durations.values()]
    ratio = f"{median_ratio(durations['True'], durations['False']):.0f}" if n <= MODERATE else ""
    return f"top on SO({n:,})", *ms, ratio


def parameters(system: nh.SuslovTop | nh.ChaplyginSleigh, name: str, rounds: int) -> tuple[str, ...]:
    """Return times a member without and with parameters, in one thread."""
    rng = np.random.default_rng(0)
    scale = rng.uniform(1, 2, MEMBERS).reshape(-1, *(1,) * np.ndim(getattr(system, name)))
    arguments = {"restricted_velocity": rng.normal(size=(MEMBERS, 2)) * 0.5, "times": (0.0, 1.0)}
    with in_one_thread():
        runs = {
            "same": lambda: nh.ensemble(system, **arguments),
            "own": lambda: nh.ensemble(system, **arguments, parameters={name: scale * getattr(system, name)}),
        }
        durations = in_turns(runs, rounds)
    us = [f"{statistics.median(seconds) / MEMBERS * 1e6:.1f} us" for seconds in durations.values()]
    return type(system).__name__, f"a member of {MEMBERS:,}, T = 1, each with its {name}", *us


def main() -> None:
    """Print the tables."""
    parser = options(__doc__)
    parser.add_argument("--rounds", type=int, default=small(31, 1))
    rounds = parser.parse_args().rounds
    for n in small((10, 30, MODERATE, 1000, 100_000), (10, 30)):
        print("|", " | ".join(momenta(n, max(small(3, 1), rounds // 10))), "|", flush=True)
    for body, name in (
        (nh.SuslovTop(np.diag([1.0, 2.0, 3.0])), "mass_tensor"),
        (nh.ChaplyginSleigh(1, 1, 0.5), "mass"),
    ):
        print("|", " | ".join(parameters(body, name, max(small(3, 1), rounds // 10))), "|", flush=True)
    if reason := missing("heyoka"):
        leave_out(reason)
    print("| body | T | rtol | heyoka us | integration us | call us | ratio | ratio of call | error heyoka | error |")
    for problem in PROBLEMS:
        for end in ENDS if problem.system.group == nh.SO(3) else ENDS[:1]:
            for row in rows(problem, end, rounds):
                print("|", " | ".join(row), "|", flush=True)
    for problem in PROBLEMS:
        print("|", " | ".join(samples(problem, max(small(3, 1), rounds // 10))), "|", flush=True)
        print("|", " | ".join(ensembles(problem, max(small(3, 1), rounds // 10))), "|", flush=True)


if __name__ == "__main__":
    main()
