"""Equilibria of any left-invariant system against the definition: zeros of the reduced equations, all and no others."""

import numpy as np
import pytest
from bodies import ATTRACTING, mass_tensor, random_rows
from refusals import refusals

import nonholo as nh
from nonholo.groups import AbstractMatrixGroup
from nonholo.systems import AbstractLLSystem, Equilibria, LLSystem, MultidimensionalSleigh, RigidBody, SuslovTop

RNG = np.random.default_rng(2)
_SCALINGS = nh.MatrixGroup([np.diag([1.0, 0.5, 0.0]), np.eye(3, k=2), np.eye(3, k=1) * [0, 0, 1]])


def _drift(system: AbstractLLSystem, velocity: np.ndarray) -> np.ndarray:
    """Return the rates of the momenta along the rows, by the definition."""
    return system.restrict(system.group.coad(velocity, np.asarray(system.inertia_operator) @ velocity))


def _spaces(reference: Equilibria) -> list[Equilibria]:
    return [reference, *reference.others]


def _distance(velocity: np.ndarray, reference: Equilibria) -> float:
    """Return the distance of a velocity of length one from the equilibria."""
    return min(
        float(np.linalg.norm(velocity - velocity @ np.linalg.pinv(space.subspace) @ space.subspace))
        for space in _spaces(reference)
    )


def _positive(dim: int, seed: int) -> np.ndarray:
    factor = np.random.default_rng(seed).normal(size=(dim + 2, dim))
    return factor.T @ factor / dim


def _any(group: AbstractMatrixGroup, k: int, seed: int) -> LLSystem:
    """Draw rows and an inertia operator."""
    rows = random_rows(group, k, np.random.default_rng(seed))
    return LLSystem(group, constraint_subspace=rows, inertia_operator=_positive(group.dim, seed))


_SPECIAL_LINEAR = nh.MatrixGroup([np.diag([1.0, -1.0]), np.eye(2, k=1), np.eye(2, k=-1)])
_GROUPS = {
    "SO(3)": (nh.SO(3), 3),
    "SO(3), a plane": (nh.SO(3), 2),
    "SE(2)": (nh.SE(2), 3),
    "SE(2), a plane": (nh.SE(2), 2),
    "SO(4)": (nh.SO(4), 3),
    "SE(3)": (nh.SE(3), 3),
    "SE(3), a plane": (nh.SE(3), 2),
    "not unimodular": (_SCALINGS, 3),
    "SL(2)": (_SPECIAL_LINEAR, 3),
    "a product": (nh.ProductGroup(nh.SE(2), nh.Translations(1)), 3),
}


@pytest.mark.profile("problems", keep=["*-0"])
@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("name", _GROUPS)
def test_every_zero_is_an_equilibrium(name: str, seed: int) -> None:
    """Newton's method from 100 random starts ends on the spaces, on whose every point the definition vanishes."""
    system = _any(*_GROUPS[name], seed)
    S, reference, scale = system.constraint_subspace, system.equilibria(), np.abs(system.inertia_operator).max()
    for space in _spaces(reference):
        velocity = RNG.normal(size=len(space.subspace)) @ space.subspace
        velocity /= np.linalg.norm(velocity)
        assert np.abs(_drift(system, velocity)).max() < 1e-12 * scale

    zeros = _zeros_by_newton(system, RNG.normal(size=(100, len(S)))) @ S
    assert len(zeros) > 10
    assert max(_distance(velocity, reference) for velocity in zeros) < 1e-5  # a root of rounding, where rates are small


def _zeros_by_newton(system: AbstractLLSystem, x: np.ndarray) -> np.ndarray:
    """Return those iterates of the equations drift = 0, |x| = 1 that have converged; the drift is quadratic."""
    basis, values = system.constraint_subspace, np.empty(0)
    form = system.restrict(system.group.coad(basis, (basis @ system.inertia_operator)[:, None]))
    form = form + form.transpose(1, 0, 2)
    for _ in range(60):
        slopes = np.einsum("abm,na->nmb", form, x)
        values = np.concatenate(
            [np.einsum("nmb,nb->nm", slopes, x) / 2, (x * x).sum(axis=1, keepdims=True) - 1], axis=1
        )
        jacobian = np.concatenate([slopes, 2 * x[:, None, :]], axis=1)
        x = x - 0.7 * (np.linalg.pinv(jacobian, rcond=1e-10) @ values[:, :, None])[:, :, 0]
    return x[np.abs(values).max(axis=1) < 1e-12 * np.abs(form).max()]


def _free_nilpotent() -> nh.MatrixGroup:
    """Return the group of words of three letters, at most two long: brackets of its letters are independent."""
    letters = np.zeros((3, 13, 13))
    for i in range(3):
        letters[i, 1 + i, 0] = 1.0
        for j in range(3):
            letters[i, 4 + 3 * i + j, 1 + j] = 1.0
    brackets = [letters[i - 2] @ letters[i - 1] - letters[i - 1] @ letters[i - 2] for i in range(3)]
    return nh.MatrixGroup([*letters, *brackets])


_FREE = _free_nilpotent()


def _with_matrix(matrix: np.ndarray, along: np.ndarray) -> LLSystem:
    """Return the system whose equilibria are the real eigenspaces of a matrix, with this inertia along its letters."""
    inertia = np.block([[along, matrix.T], [matrix, np.eye(3)]])
    return LLSystem(_FREE, constraint_subspace=np.eye(6)[:3], inertia_operator=inertia)


_JORDAN = {
    "three lines": (np.diag([1.0, 2.0, 4.0]), [1, 1, 1]),
    "one line": (np.array([[1.0, -2.0, 0], [2.0, 1.0, 0], [0, 0, 3.0]]), [1]),
    "a plane and a line": (np.diag([2.0, 2.0, -1.0]), [1, 2]),
    "two lines": (np.array([[2.0, 1.0, 0], [0, 2.0, 0], [0, 0, 5.0]]), [1, 1]),
    "two lines, zero": (np.array([[0.0, 1.0, 0], [0, 0.0, 0], [0, 0, 5.0]]), [1, 1]),
    "one line, thrice": (np.array([[2.0, 1.0, 0], [0, 2.0, 1.0], [0, 0, 2.0]]), [1]),
    "a plane": (np.array([[2.0, 1.0, 0], [0, 2.0, 0.0], [0, 0, 2.0]]), [2]),
    "all": (3 * np.eye(3), [3]),
    "all, no coupling": (np.zeros((3, 3)), [3]),
    "almost equal": (np.diag([1.0, 1 + 1e-7, 1 - 1e-7]), [1, 1, 1]),
    "equal to rounding": (np.diag([1.0, 1 + 1e-15, 3.0]), [1, 2]),
}


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("name", _JORDAN)
def test_every_normal_form_of_the_matrix(name: str, seed: int) -> None:
    """Multiple and defective eigenvalues in random rows give the spaces of the exact matrix, no chance ones."""
    (matrix, sizes), rng = _JORDAN[name], np.random.default_rng(seed)
    rows = np.linalg.qr(rng.normal(size=(3, 3)))[0] @ np.diag(rng.uniform(0.5, 2.0, 3))
    system = _with_matrix(rows @ matrix @ np.linalg.inv(rows), _positive(3, seed))
    spaces = _spaces(system.equilibria())
    assert sorted(len(space.subspace) for space in spaces) == sizes
    scale = np.abs(system.inertia_operator).max()
    for space in spaces:
        velocity = rng.normal(size=len(space.subspace)) @ space.subspace
        assert np.abs(_drift(system, velocity / np.linalg.norm(velocity))).max() < 1e-11 * scale


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("name", ["three lines", "one line", "a plane and a line", "two lines", "a plane"])
def test_rates_and_attraction(name: str, seed: int) -> None:
    """Rates are those of differences of the vector field; the attracting half is where all of them are negative."""
    rows = np.random.default_rng(seed).normal(size=(3, 3))
    system = _with_matrix(rows @ _JORDAN[name][0] @ np.linalg.inv(rows), _positive(3, seed))
    S, B = system.constraint_subspace, np.asarray(system.constrained_inertia)
    for space in _spaces(system.equilibria()):
        lines = space.subspace if space.attracting is None else np.vstack([space.subspace, space.attracting])
        rates = [system.transverse_rates(velocity, space.subspace) for velocity in lines]
        for velocity, result in zip(lines, rates, strict=True):
            x = velocity @ S.T
            columns = [(_drift(system, (x + d) @ S) - _drift(system, (x - d) @ S)) / 2 for d in np.eye(3)]
            expected = np.linalg.eigvals(np.linalg.solve(B, np.transpose(columns)))
            gap = np.poly(expected) - np.poly(np.append(result, np.zeros(len(space.subspace))))
            assert np.abs(gap / max(1.0, np.abs(expected).max()) ** np.arange(4)).max() < 1e-9
        if space.attracting is not None:
            assert rates[-1].real.max() < 0
        elif len(space.subspace) == 1:
            assert rates[0].real.min() < 1e-9
            assert rates[0].real.max() > -1e-9


def test_two_lines_may_attract() -> None:
    """Of three lines one is a saddle; the two others attract on one half each, and stand first."""
    system = _with_matrix(np.diag([1.0, 2.0, 4.0]) + 0.4 * (np.eye(3, k=1) - np.eye(3, k=-1)), np.diag([1.0, 3.0, 9.0]))
    spaces = _spaces(system.equilibria())
    assert [space.attracting is None for space in spaces] == [False, False, True]
    for sign, space in [(1, spaces[0]), (1, spaces[1]), (-1, spaces[0]), (-1, spaces[1])]:
        start = sign * np.asarray(space.attracting) + np.array([1e-3, -1e-3, 1e-3, 0, 0, 0])
        end = nh.flow(system, body_velocity=start, times=[0.0, 400.0]).body_velocity[-1, :3]
        ends = [np.asarray(each.attracting)[:3] for each in spaces[:2]]
        angles = [end @ x / np.linalg.norm(end) / np.linalg.norm(x) for x in ends]
        assert max(angles) == pytest.approx(1.0, abs=1e-6)  # leaves the repelling half, stays at the attracting one


_SOLVED = ("top 3", "top 3, tilted", "top 4", "sleigh 2", "sleigh 2, backward", "sleigh 3", "turning sleigh 3")
_NAMED = {name: ATTRACTING[name] for name in _SOLVED} | {
    "top 3, flat": SuslovTop(np.diag([1.0, 2.0, 0.0]) + 0.0),
    "top 3, flat and coupled": SuslovTop(np.outer([1.0, 0.5, 0.3], [1.0, 0.5, 0.3]) + np.diag([0.0, 1.0, 0.0])),
    "top 3, c an axis of B": SuslovTop([[1.0, 0.0, 0.4], [0.0, 2.0, 0.0], [0.4, 0.0, 3.0]]),
    "top 3, balanced": SuslovTop(np.diag([1.0, 2.0, 3.0])),
    "top 4, balanced": SuslovTop(np.diag([1.0, 2.0, 3.0, 4.0])),
    "sleigh 2, balanced": nh.ChaplyginSleigh(1.3, 0.7, 0.0, 0.3),
    "sleigh 3, balanced": MultidimensionalSleigh(1.3, [0.0, 0.2, -0.1], np.diag([0.5, 0.7, 0.4])),
}


def _without_form(system: AbstractLLSystem, change: np.ndarray) -> LLSystem:
    """Return the same system by its inertia operator, in other rows: it has no normal form."""
    rows = change @ system.constraint_subspace
    return LLSystem(system.group, constraint_subspace=rows, inertia_operator=np.asarray(system.inertia_operator))


@pytest.mark.parametrize("name", _NAMED)
def test_tops_and_sleighs_by_both_routes(name: str) -> None:
    """The normal form and the reduced equations have one space, one attracting direction and the same rates."""
    named = _NAMED[name]
    k = len(named.constraint_subspace)
    other = _without_form(named, np.random.default_rng(k).normal(size=(k, k)))
    assert other.normal_form is None
    closed, solved = named.equilibria(), other.equilibria()
    assert solved.others == ()
    projections = [np.linalg.pinv(each.subspace) @ each.subspace for each in (closed, solved)]
    assert np.abs(projections[0] - projections[1]).max() < 1e-12
    assert (closed.attracting is None) == (solved.attracting is None)
    if closed.attracting is not None and solved.attracting is not None:
        ratio = np.linalg.norm(closed.attracting) / np.linalg.norm(solved.attracting)
        assert np.abs(closed.attracting - ratio * solved.attracting).max() < 1e-12 * np.linalg.norm(closed.attracting)
    spectra = [nh.equilibria(each, 0.4) for each in (named, other)]
    assert np.allclose(spectra[0].rates, spectra[1].rates, rtol=1e-11, atol=0)


def test_axes_of_a_free_body() -> None:
    """Of Euler's top the three principal axes in any body frame: saddle in the middle, centers beside it."""
    turn = nh.SO(3).exp(np.array([0.3, -0.7, 0.4]))
    body = RigidBody(turn @ np.diag([1.0, 2.0, 4.0]) @ turn.T)
    axes = {int(np.abs(space.subspace @ turn).argmax()): space for space in _spaces(body.equilibria())}
    for i, space in axes.items():
        assert np.allclose(np.abs(space.subspace @ turn / np.linalg.norm(space.subspace)), np.eye(3)[i], atol=1e-13)
    spectrum = nh.equilibria(body, energy=2.0)
    moments = np.array([6.0, 5.0, 3.0])
    for result in (spectrum, *spectrum.others):
        i = int(np.abs(result.subspace @ turn).argmax())
        one, two = (i + 1) % 3, (i + 2) % 3
        square = 4.0 / moments[i] * (moments[i] - moments[one]) * (moments[two] - moments[i])
        assert np.allclose(result.rates**2, square / (moments[one] * moments[two]), rtol=1e-12)
    assert sorted(axes) == [0, 1, 2]


@pytest.mark.parametrize(("moments", "sizes"), [((1, 1, 2), [1, 2]), ((2, 2, 2), [3]), ((1, 2, 0), [1, 1, 1])])
def test_symmetric_and_flat_bodies(moments: tuple[float, ...], sizes: list[int]) -> None:
    """A body of revolution turns steadily about its axis and any across it, a ball about all, a plate about three."""
    turn = nh.SO(3).exp(np.array([0.3, -0.7, 0.4]))
    reference = RigidBody(turn @ np.diag(moments) @ turn.T).equilibria()
    assert sorted(len(space.subspace) for space in _spaces(reference)) == sizes
    assert all(space.attracting is None for space in _spaces(reference))


@pytest.mark.parametrize("length", [1e-9, 1.0, 1e9])
def test_equilibria_in_any_unit(length: float) -> None:
    """A body on SE(2), free or with a skate given in skew rows, has the same equilibria in any unit of length."""
    units = np.array([1.0, length, length])
    inertia = _positive(3, 1) / np.outer(units, units)
    unit = LLSystem(nh.SE(2), constraint_subspace=np.eye(3), inertia_operator=_positive(3, 1)).equilibria()
    reference = LLSystem(nh.SE(2), constraint_subspace=np.eye(3), inertia_operator=inertia).equilibria()
    assert len(reference.others) == len(unit.others)
    for space, expected in zip(_spaces(reference), _spaces(unit), strict=True):
        assert np.allclose(space.subspace / units, expected.subspace, rtol=1e-9, atol=1e-12)
        assert (space.attracting is None) == (expected.attracting is None)


def _torus() -> LLSystem:
    """Return a system whose rows commute, but for rounding: they are mixed and turned."""
    turned = np.eye(6)[[0, 5]] @ nh.SO(4).adjoint(nh.SO(4).exp(RNG.normal(size=6))).T
    rows = RNG.normal(size=(2, 2)) @ turned
    return LLSystem(nh.SO(4), constraint_subspace=rows, inertia_operator=_positive(6, 3))


_STEADY = {
    "no direction": _any(nh.SE(3), 0, 0),
    "one direction": _any(nh.SE(3), 1, 0),
    "commuting rows": _torus(),
    "translations": LLSystem(nh.SE(3), mass_tensor(nh.SE(3), RNG), np.eye(6)[3:]),
    "round body": RigidBody(np.eye(4)),
}


@pytest.mark.parametrize("name", _STEADY)
def test_bodies_of_which_all_velocities_stay(name: str) -> None:
    """All admissible velocities are equilibria, and none attracts."""
    reference, k = _STEADY[name].equilibria(), _STEADY[name].rank
    assert (reference.subspace.shape, reference.attracting, reference.others) == ((k, 6), None, ())


def test_energies_of_either_sign() -> None:
    """On SO(2, 1) the free body has axes of negative energy, whose rates the system gives, for no positive energy."""
    G = np.diag([1.0, 1.0, -1.0])
    lorentz = nh.MatrixGroup(G @ nh.SO(3).basis, form=G)
    body = LLSystem(lorentz, np.diag([1.0, 4.0, -2.0]) @ G, np.eye(3))
    spaces = _spaces(body.equilibria())
    assert [len(space.subspace) for space in spaces] == [1, 1, 1]
    energies = [float(body.constrained_energy(body.inertia_operator @ space.subspace[0])) for space in spaces]
    assert min(energies) < 0 < max(energies)
    for space in spaces:
        assert np.abs(_drift(body, space.subspace[0])).max() < 1e-13
        assert body.transverse_rates(space.subspace[0], space.subspace).shape == (2,)
    with pytest.raises(ValueError, match=r"equilibria\(energy=\.\.\.\)` must be an energy of the equilibria\. Got 1"):
        nh.equilibria(body)


_FREE_BODY = RigidBody(np.diag([1.0, 2.0, 3.0]))
test_other_systems_are_refused = refusals(
    (lambda: nh.equilibria(nh.discretize(_FREE_BODY, 0.1)), "be a top or a sleigh to have known multipliers. Got Rigi"),
    (lambda: nh.lyapunov_function(nh.discretize(_FREE_BODY, 0.1)), r"be a top or a sleigh. Got RigidBody"),
    (lambda: nh.lyapunov_function(_FREE_BODY), r"lyapunov_function\(system=\.\.\.\)` must be a top or a sleigh. Got R"),
)
