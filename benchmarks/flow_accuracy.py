"""Not speed but answers: errors of the flow of twelve bodies beside heyoka's, and what long flows keep.

The reference has 60 digits: Taylor series of order 72 in whole multiples of 2^-220, of the equations in
`peers/bodies.py`, so independent of the library. Errors are the largest of body velocity and pose at T = 20, relative
to their size where that is above one. heyoka runs at tolerance 2.2e-16, with quaternions on SO(3).

The second table has flows to T = 1e5, looked at 20,000 times: the change of energy, what the constraint wants to be
zero, and how far poses are from their group where the steps of the series begin, before anything normalizes them. Its
last column is the power of time with which the energy error grows: 1/2 is a random walk, 1 a drift.

    python benchmarks/flow_accuracy.py [--end 1e5] [--only NAME ...]
"""

import operator
from collections.abc import Callable
from fractions import Fraction
from typing import Any

import numpy as np
from _command import leave_out, options, small
from flow_bodies import heyoka_taylor
from peers.bodies import Body, bodies, first_of, rates_of, state_of
from peers.problems import State, last
from peers.solvers import missing

import nonholo as nh

BITS, ORDER, LONG_STEP = 220, 72, 2  # digits, terms, and the step 2^-2
END, LOOKS = 20, small(20_000, 200)


class Series:
    """A series whose terms are made one by one, in units of 2^-BITS, for time in units of the step."""

    nodes: list["Series"] = []  # noqa: RUF012

    def __init__(self, term: Callable[[int], int]) -> None:
        self.term, self.terms = term, list[int]()
        self.nodes.append(self)

    def __add__(self, other: "Series") -> "Series":
        return Series(lambda j: self.terms[j] + other.terms[j])

    def __sub__(self, other: "Series") -> "Series":
        return Series(lambda j: self.terms[j] - other.terms[j])

    def __neg__(self) -> "Series":
        return Series(lambda j: -self.terms[j])

    def __mul__(self, other: "Series") -> "Series":
        return Series(lambda _: sum(map(operator.mul, self.terms, reversed(other.terms))) >> BITS)

    def __rmul__(self, c: Fraction) -> "Series":
        return Series(lambda j: self.terms[j] * c.numerator // c.denominator)

    def __truediv__(self, other: "Series") -> "Series":
        series = Series(lambda _: 0)
        series.term = lambda j: (
            ((self.terms[j] << BITS) - sum(map(operator.mul, series.terms, reversed(other.terms[1:]))))
            // other.terms[0]
        )
        return series


def reference(body: Body) -> State:
    """Return the state at the end, rounded to extended precision."""
    Series.nodes.clear()
    numbers = [int(Fraction(x) * 2**BITS) for x in first_of(body).tolist()]
    z = [Series(lambda _: 0) for _ in numbers]
    slopes = rates_of(body, number=lambda c: c)(z)
    nodes = Series.nodes[len(z) :]
    for _ in range(END << LONG_STEP):
        for variable, number in zip(z, numbers, strict=True):
            variable.terms = [number]
        for node in nodes:
            node.terms = []
        for j in range(ORDER):
            for node in nodes:
                node.terms.append(node.term(j))
            for variable, slope in zip(z, slopes, strict=True):
                variable.terms.append((slope.terms[j] >> LONG_STEP) // (j + 1))
        assert max(abs(x.terms[-1]) / max(1 << BITS, abs(x.terms[0])) for x in z) < 1e-40
        numbers = [sum(x.terms) for x in z]
    rounded = [(high := float(Fraction(x, 2**BITS)), float(Fraction(x, 2**BITS) - Fraction(high))) for x in numbers]
    return state_of(body, np.array([np.longdouble(high) + np.longdouble(low) for high, low in rounded]))


def error(result: State, wanted: State) -> float:
    """Return the largest error of velocity and pose, relative where they are large."""
    pairs = zip(result, wanted, strict=True)
    return float(max(np.abs(one - other).max() / max(1.0, np.abs(other).max()) for one, other in pairs))


def errors(body: Body) -> list[str]:
    """Return heyoka's error, ours and their ratio; where both are below rounding ratios say nothing."""
    wanted = reference(body)
    ours = error(last(nh.flow(body.system, restricted_velocity=body.velocity, times=(0.0, END))), wanted)
    theirs = error(state_of(body, heyoka_taylor(body, 2.2e-16)(END), body.is_rotation), wanted)
    return [body.name, f"{theirs:.1e}", f"{ours:.1e}", f"{ours / theirs:.2f}"]


def raw_residual(orbit: Any) -> float:
    """Return the largest distance from the group of poses as the series carry them, relative to their size."""
    series, group = orbit.motion.solution, orbit.system.group
    rows = np.empty_like(series.nodes[:, 0, :-1])
    rows[:, series.equations.order] = series.nodes[:, 0, :-1]
    if not series.compact:
        g = rows[:, : group.size**2].reshape(-1, group.size, group.size)
    elif group in (nh.SO(3), nh.SE(2)):
        turned = rows[:, : 4 if group == nh.SO(3) else 2]
        return float(np.abs((turned * turned).sum(axis=1) - 1).max())
    else:
        g = group.matrix_from_pose(rows[:, : group.pose_size])
    return float((group.residual(g) / np.maximum(1.0, np.abs(g).max(axis=(1, 2)))).max())


def kept(body: Body, end: float) -> list[str]:
    """Return what a long flow keeps, or why it cannot be so long."""
    times = np.linspace(0.0, end, LOOKS + 1)
    try:
        orbit = nh.flow(body.system, restricted_velocity=body.velocity, times=times)
    except nh.OutcomeError as failed:
        return [body.name, f"{failed.outcome}: {failed}".split(".")[0], "", "", ""]
    energy = np.abs(orbit.energy / orbit.energy[0] - 1)
    constraint = np.abs(orbit.motion.constraint_residual(orbit)).max(initial=0.0)
    spread = [np.sqrt(np.mean(energy[: LOOKS // share] ** 2)) for share in (100, 1)]
    power = np.log(spread[1] / spread[0]) / np.log(100) if min(spread) > 1e-16 else np.nan
    return [body.name, f"{energy.max():.1e}", f"{constraint:.1e}", f"{raw_residual(orbit):.1e}", f"{power:.2f}"]


def main() -> None:
    """Print both tables."""
    parser = options(__doc__)
    parser.add_argument("--end", type=float, default=small(1e5, 100.0))
    parser.add_argument("--only", nargs="+", default=list(bodies())[: small(None, 1)])
    arguments = parser.parse_args()
    if reason := missing("heyoka"):
        leave_out(reason)
    print("| body | error of heyoka | error | ratio |\n| --- | ---: | ---: | ---: |", flush=True)
    for name in arguments.only:
        print("|", " | ".join(errors(bodies()[name])), "|", flush=True)
    print("\n| body | energy | constraint | group | power |\n| --- | ---: | ---: | ---: | ---: |", flush=True)
    for name in arguments.only:
        print("|", " | ".join(kept(bodies()[name], arguments.end)), "|", flush=True)


if __name__ == "__main__":
    main()
