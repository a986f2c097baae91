"""All values of a step under forces: against its equations, exact elimination, runs, and the energy of every branch."""

from collections.abc import Callable
from typing import Any

import mpmath
import numpy as np
import pytest
from bodies import magnet, weight
from refusals import refusals

import nonholo as nh
from nonholo.discrete import Branches
from nonholo.systems import AbstractSystem

SYSTEMS: dict[str, AbstractSystem] = {
    "top": nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]]),
    "tilted top": nh.SuslovTop.from_inertia(np.diag([2.0, 3.0, 4.0]) + 0.1, axis=(0.36, -0.48, 0.8)),
    "balanced top": nh.SuslovTop(np.diag([1.0, 1.2, 0.7])),
    "sleigh": nh.ChaplyginSleigh(1.0, 0.7, 0.5, 0.3),
    "sleigh at its center": nh.ChaplyginSleigh(1.0, 1.0, 0.0),
    "sleigh on SE(3)": nh.MultidimensionalSleigh(1.3, [0.3, 0.2, -0.1], np.diag([0.5, 0.7, 0.4]) + 0.1),
    "top on SO(4)": nh.SuslovTop(np.diag([1.0, 2.0, 1.5, 0.7]) + 0.1),
}
COUNTS = {  # without forces or with friction or a table, and with a potential
    "top": (4, 7), "tilted top": (4, 7), "balanced top": (2, 5), "sleigh": (3, 4), "sleigh at its center": (2, 3),
    "sleigh on SE(3)": (5, 8), "top on SO(4)": (6, 11),
}  # fmt: skip
MORE = {"sleigh on SE(3)": 1, "top on SO(4)": 2}
"""More values that these have under other linear potentials than under weights at one point."""


def _friction(system: AbstractSystem) -> nh.Friction:
    turning = np.random.default_rng(8).normal(size=(system.group.dim,) * 2)
    return nh.Friction(0.1 * turning @ turning.T + 0.2 * (turning - turning.T))


ACTING: dict[str, Callable[[AbstractSystem], nh.Forced]] = {
    "weight": lambda s: nh.Forced(s, weight(s)),
    "magnet": lambda s: nh.Forced(s, (magnet(s), weight(s))),
    "friction": lambda s: nh.Forced(s, force=_friction(s)),
    "table": lambda s: nh.Forced(s, force=np.random.default_rng(4).normal(size=(9, s.group.dim))),
    "all": lambda s: nh.Forced(
        s, weight(s), (_friction(s), np.random.default_rng(4).normal(size=(9, s.group.dim)))
    ),
}  # fmt: skip
SHORT = ("weight", "magnet", "table")  # of SO(4), where others take long
CASES = [(name, kind) for name in SYSTEMS for kind in ACTING if name != "top on SO(4)" or kind in SHORT]
H = 0.4


def _force(forced: nh.Forced, g: np.ndarray, W: np.ndarray, step: int) -> np.ndarray:
    """Return f from its definition, of complex displacements too."""
    group, X = forced.group, (W - np.linalg.inv(W)) / 2
    A = sum((term.matrix_for(group) for term in forced.terms), np.zeros((group.size,) * 2))
    leaning = g @ W @ np.linalg.inv(np.eye(len(W)) + W) * 2
    f = forced.rows(np.array([step]))[0] - np.array([np.sum(A * (leaning @ x)) for x in group.basis])
    return f if forced.friction is None else f - forced.friction.matrix @ group.vee(X) / H


def _legendre(system: AbstractSystem, W: np.ndarray) -> np.ndarray:
    """Return F(W) by the trace."""
    group, J = system.group, np.asarray(system.homogeneous_mass_tensor)
    X = group.hat(np.asarray(system.constraint_subspace))
    return np.einsum("iab,bc,ac->i", X, J, W - group.identity) / H


def _values(name: str, kind: str) -> tuple[nh.Forced, np.ndarray, np.ndarray, Branches]:
    system = SYSTEMS[name]
    forced, g = ACTING[kind](system), system.group.random(np.random.default_rng(5))
    r = system.restricted_momentum(np.array([0.6, -0.4, 0.3])[: system.rank])
    return forced, g, r, nh.displacements_over(nh.discretize(forced, H), r, configuration=g, step=2)


@pytest.mark.profile("problems", cases=["top on SO(4)-weight"])
@pytest.mark.parametrize(("name", "kind"), CASES)
def test_every_value_is_a_step_and_keeps_its_energy(name: str, kind: str) -> None:
    """F(W) = r + h/2 f on the variety, as often as there are values; T' - T = <f, X>, on complex branches too."""
    forced, g, r, values = _values(name, kind)
    system, group = forced.system, forced.group
    more = MORE.get(name, 0) if kind == "magnet" else 0
    assert values.multiplicity.sum() == COUNTS[name][bool(forced.terms)] + more
    S, B = np.asarray(system.constraint_subspace), np.asarray(system.constrained_inertia)
    for W in values.displacement:
        f, X, size = _force(forced, g, W, 2), group.vee((W - np.linalg.inv(W)) / 2), np.abs(W).max() ** 2
        along = H / 2 * S @ f
        size *= 1 + np.abs(along).max()
        np.testing.assert_allclose(_legendre(system, W), r + along, atol=2e-12 * size)
        np.testing.assert_allclose(np.asarray(system.annihilator) @ X, 0, atol=1e-12 * size)
        after = -_legendre(system, np.linalg.inv(W)) + along
        T, ahead = (x @ np.linalg.solve(B, x) / 2 for x in (r, after))
        assert abs(ahead - T - f @ X) < 1e-11 * size**2
    apart = np.linalg.norm(values.displacement[:, None] - values.displacement, axis=(2, 3))
    assert (apart + np.eye(len(values))).min() > 1e-4
    assert values.principal == 0


@pytest.mark.profile("routes", keep=["*-all"])
@pytest.mark.parametrize(("name", "kind"), CASES)
def test_the_principal_one_is_the_step_of_a_run(name: str, kind: str) -> None:
    """From a momentum, and from each displacement of an orbit, the next one is the principal value."""
    system = SYSTEMS[name]
    discrete = nh.discretize(ACTING[kind](system), 0.2)
    g, r = system.group.random(np.random.default_rng(6)), np.array([0.5, -0.3, 0.2])[: system.rank]
    orbit = nh.simulate(discrete, momentum=r, configuration=g, steps=4)
    first = nh.branches(discrete, momentum=r, configuration=g)
    np.testing.assert_allclose(first.displacement[first.principal], orbit.displacement[1], atol=1e-12)
    for k in range(3):
        here = {"configuration": orbit.configuration[k], "step": k}
        values = nh.branches(discrete, displacement=orbit.displacement[k], **here)
        np.testing.assert_allclose(values.displacement[values.principal], orbit.displacement[k + 1], atol=1e-12)


def _equations(forced: nh.Forced, g: Any, r: Any) -> Callable[[Any, Any], list[Any]]:
    """Return the equations of a step in Cayley coordinates, free of fractions, by their definition."""
    system, group, one = forced.system, forced.group, mpmath.eye(forced.group.size)
    rows = [mpmath.matrix(group.hat(row).tolist()) for row in np.asarray(system.constraint_subspace)]
    J, A = (
        mpmath.matrix(np.asarray(x).tolist())
        for x in (system.homogeneous_mass_tensor, forced.terms[0].matrix_for(group))
    )
    g, h = mpmath.matrix(g.tolist()), mpmath.mpf(H)

    def equations(a: Any, b: Any) -> list[Any]:
        Y = a * rows[0] + b * rows[1]
        W, w = mpmath.inverse(one - Y) * (one + Y), mpmath.det(one - Y)
        pairs = ((x * J * (W - one).T / h, h / 2 * A.T * g * (one + Y) * x) for x in rows)
        return [
            w * (sum(F[i, i] + G[i, i] for i in range(len(one))) - own) for (F, G), own in zip(pairs, r, strict=True)
        ]

    return equations


def _interpolated(values: Callable[[Any], list[Any]], degree: int) -> list[list[Any]]:
    """Return the coefficients of polynomials, from the highest on."""
    points = [mpmath.mpf(3 * k - 2) / (degree + 1) for k in range(degree + 1)]
    vandermonde = mpmath.matrix([[x ** (degree - j) for j in range(degree + 1)] for x in points])
    rows = [values(x) for x in points]
    return [list(mpmath.lu_solve(vandermonde, mpmath.matrix(column))) for column in zip(*rows, strict=True)]


def _resultant(equations: Callable[[Any, Any], list[Any]], d: int) -> list[Any]:
    """Return the resultant of two polynomials of degree d in the second coordinate."""

    def value(a: Any) -> list[Any]:
        first, second = _interpolated(lambda b: equations(a, b), d)
        sylvester = mpmath.zeros(2 * d)
        for i in range(d):
            for j in range(d + 1):
                sylvester[i, i + j], sylvester[d + i, i + j] = first[j], second[j]
        return [mpmath.det(sylvester)]

    (coefficients,) = _interpolated(value, 9)
    largest = max(map(abs, coefficients))
    while abs(coefficients[0]) < mpmath.mpf(10) ** -30 * largest:
        coefficients.pop(0)
    return coefficients


@pytest.mark.parametrize("name", ["top", "tilted top", "balanced top", "sleigh", "sleigh at its center"])
def test_no_value_is_missing(name: str) -> None:
    """The values are all roots of the resultant of the equations from their definition, to 40 digits."""
    system = SYSTEMS[name]
    forced, r, is_top = ACTING["weight"](system), [0.375, -0.5], system.group == nh.SO(3)
    g = system.group.cayley(np.array([0.5, -0.25, 0.75]))
    with mpmath.workdps(80):
        resultant = _resultant(_equations(forced, g, r), 3 if is_top else 1)[::-1]
        roots = [complex(x) for x in mpmath.polyroots(resultant, 400, extraprec=600, asc=True)]
    values = nh.displacements_over(nh.discretize(forced, H), r, configuration=g)
    W, one = values.displacement, np.eye(len(g))
    Y = (W - one) @ np.linalg.inv(W + one)
    own = (system.group.vee(Y) @ np.linalg.pinv(np.asarray(system.constraint_subspace)))[:, 0]
    there = [x for x in roots if is_top or abs(1 + x * x) > 1e-9]
    assert len(there) == len(values) == COUNTS[name][1]
    for x in there:
        assert np.abs(own - x).min() < 1e-10 * (1 + abs(x)) ** 2


def test_folds_are_those_of_the_step() -> None:
    """The fold distance is that of a weaker and weaker weight, in the limit the free one, and zero where roots meet."""
    top = SYSTEMS["top"]
    W = nh.SO(3).exp(0.4 * np.asarray(top.constraint_subspace)[0])
    free, r = nh.discretize(top, H), top.restrict(nh.discrete_legendre(nh.discretize(top, H), W))
    weak = nh.discretize(nh.Forced(top, nh.Gravity([0.0, 1e-9, 1e-9], [0.1, 0.2, 0.3])), H)
    values = nh.displacements_over(weak, r)
    assert values.fold_distance[0] == pytest.approx(nh.fold_distance(free, W), rel=1e-6)
    heavy = nh.discretize(ACTING["weight"](top), H)
    low, high = 0.0, 20.0
    counts = [nh.displacements_over(heavy, s * r).is_real.sum() for s in (low, high)]
    for _ in range(40):
        middle = (low + high) / 2
        same = nh.displacements_over(heavy, middle * r).is_real.sum() == counts[0]
        low, high = (middle, high) if same else (low, middle)
    distances = nh.displacements_over(heavy, low * r).fold_distance
    assert counts[0] != counts[1]
    assert distances.min() < 1e-5


_TOP, _SLEIGH = SYSTEMS["top"], SYSTEMS["sleigh"]
_FREE, _HEAVY = nh.RigidBody(np.diag([1.0, 2.0, 3.0])), nh.discretize(nh.Forced(_SLEIGH, weight(_SLEIGH)), 0.1)
_WITHOUT_VALUES = (
    (nh.Forced(_TOP, weight(_TOP), scheme="variational"), "kick at the nodes"),
    (nh.Forced(_SLEIGH, force=nh.Slip([[0.0, 0.0, 1.0]], 0.5)), "hold or slide"),
    (nh.Forced(_SLEIGH, nh.Spring([0.1, 0.2], [1.0, 0.0], 2.0, 0.3)), "rational"),
    (nh.Forced(_SLEIGH, force=lambda *state: -abs(state[2]) * state[2]), "rational"),
    (nh.Forced(_FREE, weight(_FREE), None, "energy"), "top or a sleigh"),
)


# Where not all values are known, or a step is no single equation, the error says why; bad arguments are named.
test_what_has_no_values_is_refused = refusals(
    *((lambda x=x: nh.displacements_over(nh.discretize(x, 0.1), np.zeros(x.rank)), why) for x, why in _WITHOUT_VALUES),
    *((lambda x=x: nh.branches(nh.discretize(x, 0.1), momentum=np.zeros(x.rank)), why) for x, why in _WITHOUT_VALUES),
    (lambda: nh.displacements_over(_HEAVY, [0, 0], configuration=2 * np.eye(3)), r"n=\.\.\.\)` must lie in"),
    (lambda: nh.displacements_over(_HEAVY, [0, 0], step=-1), r"step=\.\.\.\)` must be a natural number"),
    (lambda: nh.displacements_over(_HEAVY, [0, 0], certify=True), "must be left out under forces"),
    (lambda: nh.branches(_HEAVY, momentum=[0.1, 0.2, 0.3]), "Pass the 2 components"),
)
