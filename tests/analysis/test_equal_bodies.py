"""One body as a top or a sleigh, as an arrowhead, and as an `LLSystem` in its own or in other axes: equal answers."""

from typing import Any

import numpy as np
import pytest

import nonholo as nh
from nonholo.analysis import deltoid

TENSOR = np.array([[1.4, 0.0, 0.5], [0.0, 1.0, -0.3], [0.5, -0.3, 0.9]])
WIDE = np.diag([1.0, 2.0, 3.0, 4.0]) + 0.2 * (np.eye(4)[-1:] * [[1.0], [0.5], [-1.0], [0.0]])
WIDE = (WIDE + WIDE.T) / 2
TURN = nh.SO(3).exp(np.array([0.4, -0.9, 0.3]))
MOVE = nh.SE(2).exp(np.array([0.7, 0.4, -0.3]))
NAMED = {
    "top": nh.SuslovTop(TENSOR),
    "sleigh": nh.ChaplyginSleigh(1.2, 0.75, 0.5, 0.2),
    "top 4": nh.SuslovTop(WIDE),
    "sleigh SE(3)": nh.MultidimensionalSleigh(2.0, [0.3, 0.1, -0.2], TENSOR),
}


def _general(body: Any, g: np.ndarray | None = None) -> nh.LLSystem:
    g = body.group.identity if g is None else g
    rows = body.constraint_subspace @ body.group.adjoint(g).T
    return nh.LLSystem(body.group, g @ body.homogeneous_mass_tensor @ g.T, rows)


CASES: dict[str, tuple[Any, Any, np.ndarray]] = {
    "arrowhead top": (NAMED["top"], nh.SuslovTop.arrowhead(np.diag(TENSOR), TENSOR[-1, :-1]), np.eye(3)),
    "arrowhead top 4": (NAMED["top 4"], nh.SuslovTop.arrowhead(np.diag(WIDE), WIDE[-1, :-1]), np.eye(4)),
    **{f"general {name}": (body, _general(body), body.group.identity) for name, body in NAMED.items()},
    "turned top": (NAMED["top"], _general(NAMED["top"], TURN), TURN),
    "moved sleigh": (NAMED["sleigh"], _general(NAMED["sleigh"], MOVE), MOVE),
}
PLANAR = {name: case for name, case in CASES.items() if len(case[0].constraint_subspace) == 2}
equal = pytest.mark.parametrize(("body", "same", "axes"), CASES.values(), ids=CASES)
planar = pytest.mark.parametrize(("body", "same", "axes"), PLANAR.values(), ids=PLANAR)


def _seen(body: Any, axes: np.ndarray, vector: Any) -> Any:
    """Return a velocity of the body in the axes of the other one."""
    return None if vector is None else body.group.adjoint(axes) @ vector


@equal
def test_equilibria_and_limits(body: Any, same: Any, axes: np.ndarray) -> None:
    """Equilibria, their spectra for flow and map, limits and witnesses are those of the named class."""
    reference, other = nh.equilibria(nh.discretize(body, 0.3), 0.4), nh.equilibria(nh.discretize(same, 0.3), 0.4)
    assert np.allclose(_seen(body, axes, reference.velocity), other.velocity, atol=1e-13)
    for name in ("rates", "multipliers"):
        assert np.allclose(getattr(reference, name), getattr(other, name), rtol=1e-12)
    assert np.isclose(nh.invariant_measure(body).witness, nh.invariant_measure(same).witness, rtol=1e-12)
    limits, others = nh.asymptotics(body), nh.asymptotics(same)
    axis = None if limits.axis_after is None else axes @ limits.axis_after
    for one, two in (
        (reference.highest_energy, other.highest_energy),
        (limits.heading_turn, others.heading_turn),
        (limits.motion_turn, others.motion_turn),
        (axis, others.axis_after),
    ):
        assert (one is None) == (two is None)
        assert one is None or np.allclose(one, two, rtol=1e-12, atol=1e-13)


@equal
def test_values_of_the_map(body: Any, same: Any, axes: np.ndarray) -> None:
    """All displacements over a momentum, their momenta and distances from folds are those of the named class."""
    one, two = nh.discretize(body, 0.8), nh.discretize(same, 0.8)
    back = body.group.inverse(axes)
    p = body.inertia_operator @ (np.linspace(0.9, 0.4, len(body.constraint_subspace)) @ body.constraint_subspace)
    momentum = body.group.adjoint(back).T @ p
    reference, other = nh.displacements_over(one, body.restrict(p)), nh.displacements_over(two, same.restrict(momentum))
    assert len(reference) == len(other)
    assert np.isclose(reference.energy, other.energy, rtol=1e-12)
    assert reference.principal == other.principal
    real = reference.is_real
    assert np.allclose(axes @ reference.displacement[real] @ back, other.displacement[other.is_real], atol=1e-10)
    assert np.allclose(reference.fold_distance, other.fold_distance, rtol=1e-6, atol=1e-9)


@planar
def test_planar_geometry(body: Any, same: Any, axes: np.ndarray) -> None:
    """Level curves, momentum locus, half-planes and critical energies are those of the named class."""
    one, two = nh.discretize(body, 0.5), nh.discretize(same, 0.5)
    back = body.group.inverse(axes)
    curve, other = nh.invariant_curve(one, 0.3, 40), nh.invariant_curve(two, 0.3, 40)
    assert len(curve.components) == len(other.components)
    assert np.allclose(same.constrained_energy(same.restrict(other.momentum[0])), 0.3, rtol=1e-11)
    p = nh.momentum_locus(one, 8).momentum
    size = np.abs(nh.momentum_locus(one, 8).implicit(2 * p)).max()
    assert np.abs(nh.momentum_locus(two, 8).implicit(p @ body.group.adjoint(back))).max() < 1e-11 * size
    W = curve.displacement[0]
    sides, others = nh.half_planes(one, displacement=W), nh.half_planes(two, displacement=axes @ W @ back)
    assert np.allclose(sides.side * np.sign(sides.side[3]), others.side * np.sign(others.side[3]), atol=1e-12)
    assert np.allclose(sides.forward, others.forward, atol=1e-12)
    if not body.normal_form.is_sleigh:
        for name in ("saddle", "center", "equatorial_saddle", "fold", "line"):
            values = getattr(nh.critical_energies(one), name), getattr(nh.critical_energies(two), name)
            assert np.isclose(*values, rtol=1e-12)
    else:
        reference, result = nh.single_valued_region(one), nh.single_valued_region(two)
        assert np.allclose(
            [reference.energy, reference.principal_energy], [result.energy, result.principal_energy], rtol=1e-12
        )
        inside = (result.cusps + result.cusps.mean(axis=0)) / 2
        assert deltoid(two).real_branches(inside).tolist() == [3, 3, 3]


@planar
def test_orbits_between_the_equilibria(body: Any, same: Any, axes: np.ndarray) -> None:
    """The orbit half way between the equilibria is that of the named class, seen from the other axes."""
    reference = nh.heteroclinic(nh.discretize(body, 0.5), energy=0.3)
    other = nh.heteroclinic(nh.discretize(same, 0.5), energy=0.3, side=1)
    expected = reference.orbit.body_velocity[[0, -1]] @ body.group.adjoint(axes).T
    assert np.allclose(expected, other.orbit.body_velocity[[0, -1]], atol=1e-10)


def _exact(system: Any, **start: Any) -> nh.Orbit:
    """Return a flow in closed form, which is that of the adaptive solver."""
    exact, solved = (nh.flow(system, **start, method=how, rtol=1e-12, atol=1e-14) for how in ("closed_form", None))
    assert np.allclose(exact.momentum, solved.momentum, rtol=1e-9, atol=1e-9)
    assert np.allclose(exact.configuration, solved.configuration, atol=1e-9)
    assert system.group != nh.SE(2) or np.allclose(exact.heading, solved.heading, atol=1e-9)
    return exact


@planar
def test_flows_in_closed_form(body: Any, same: Any, axes: np.ndarray) -> None:
    """Momenta, poses and headings are those of the adaptive solver, and those of the named class in its axes."""
    v = np.zeros(body.group.dim)
    v[:2] = 0.4, -0.9
    times = np.linspace(0.0, 30.0, 7)
    exact = _exact(same, body_velocity=_seen(body, axes, v), times=times)
    named = nh.flow(body, body_velocity=v, times=times, method="closed_form", rtol=1e-12, atol=1e-14)
    moved = axes @ named.configuration @ np.linalg.inv(axes)
    assert np.allclose(exact.configuration, moved, atol=1e-9)
    assert body.group != nh.SE(2) or np.ptp(exact.heading) > np.pi / 4


@pytest.mark.parametrize("group", [nh.SO(3), nh.SO(4), nh.SE(3)], ids=str)
def test_two_directions_have_a_closed_form(group: Any) -> None:
    """Whatever the body and the two directions: momenta by hyperbolic functions, poses by a quadrature."""
    rng = np.random.default_rng(group.dim)
    points = rng.normal(size=(group.size + 3, group.size))
    points[:, -1] = 1.0
    system = nh.LLSystem(group, points.T @ points, rng.normal(size=(2, group.dim)))
    _exact(system, restricted_velocity=(0.4, -0.9), times=np.linspace(0.0, 3.0, 5))


ARROWHEADS = {
    "top": nh.SuslovTop.arrowhead(np.diag(WIDE), WIDE[-1, :-1]),
    "sleigh": nh.MultidimensionalSleigh.arrowhead(1.3, [0.4, 0.1, -0.2], np.diag(TENSOR), TENSOR[0, 1:]),
}


def _forced(map_: nh.Discretization) -> nh.Forced:
    pull = np.linspace(0.1, 0.3, map_.system.group.size**2).reshape(map_.system.group.identity.shape)
    return nh.Forced(map_.system, nh.Linear(pull), nh.Friction(np.full(map_.system.group.dim, 0.1)))


def _short_run(map_: nh.Discretization, w: np.ndarray, **how: Any) -> nh.Orbit:
    return nh.simulate(map_, restricted_velocity=w, steps=5, **how)


def _turning(map_: nh.Discretization, times: np.ndarray, w: np.ndarray) -> np.ndarray:
    return map_.system.group.exp(np.outer(times, w @ map_.system.constraint_subspace))


ANSWERS = {
    "run": lambda one, w: _short_run(one, w).chart,
    "multipliers": lambda one, w: _short_run(one, w).multipliers,
    "step": lambda one, w: nh.step(one, one.system.restricted_momentum(w)).momentum,
    "definition": lambda one, w: _short_run(one, w, backend="jax").momentum,
    "rollout": lambda one, w: nh.rollout(one, restricted_velocity=w, steps=5).configuration,
    "forces": lambda one, w: (
        nh.simulate(nh.discretize(_forced(one), one.time_step), restricted_velocity=w, steps=20).configuration
    ),
    "flow under forces": lambda one, w: nh.flow(_forced(one), restricted_velocity=w, times=(0.0, 1.0)).momentum,
    "poses": lambda one, w: (
        nh.Orbit.from_poses(one.system, np.arange(4.0), _turning(one, 0.1 * np.arange(4), w)).restricted_momentum
    ),
    "angle of a composition": lambda one, w: np.array(
        nh.invariants(_short_run(nh.discretize(one.system, 0.3, order=4), w)).largest_step_angle
    ),
    "linearization": lambda one, _: nh.linearize(one.system).matrix,
}


@pytest.mark.profile("routes", cases=["sleigh-rollout", "sleigh-step", "sleigh-definition", "top-linearization"])
@pytest.mark.parametrize("answer", ANSWERS.values(), ids=ANSWERS)
@pytest.mark.parametrize("body", ARROWHEADS.values(), ids=ARROWHEADS)
def test_arrowheads_with_matrices(body: Any, answer: Any) -> None:
    """What takes matrices treats an arrowhead as the same body with its mass tensor as a matrix."""
    w = np.linspace(0.9, 0.4, body.rank)
    one, two = (answer(nh.discretize(system, 0.1), w) for system in (body, body.dense))
    assert np.allclose(one, two, rtol=0, atol=1e-13 * np.abs(two).max())
