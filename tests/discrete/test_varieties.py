"""Displacement varieties by name and by functions of the user's, their consistency, and what is refused."""

import jax.numpy as jnp
import numpy as np
import pytest
from bodies import OTHERS, mass_tensor, random_rows
from comparisons import assert_near
from refusals import refusals

import nonholo as nh
from nonholo.systems import AbstractLLSystem

SLEIGH = nh.ChaplyginSleigh(1.0, 0.75, 0.5, 0.3)
TILTED = nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]], axis=[0.6, 0.0, 0.8])
IN_SPACE = nh.MultidimensionalSleigh(1.3, [0.3, 0.2, -0.1], np.diag([0.5, 0.7, 0.4]) + 0.1)
TOP = nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]])


def _rotation_vector(W: jnp.ndarray) -> jnp.ndarray:
    """The vector of (W - W^T)/2, a sine times the axis."""
    return jnp.array([W[2, 1] - W[1, 2], W[0, 2] - W[2, 0], W[1, 0] - W[0, 1]]) / 2


FUNCTIONS = {
    "top": (TOP, lambda W: jnp.sin(_rotation_vector(W)[2])),
    "tilted top": (TILTED, lambda W: _rotation_vector(W) @ np.array([0.6, 0.0, 0.8])),
    "sleigh": (SLEIGH, lambda W: W[1, 2] - jnp.tan(jnp.arctan2(W[1, 0], W[0, 0]) / 2) * W[0, 2]),
}


@pytest.mark.profile("routes", keep=["sleigh"])
@pytest.mark.parametrize("name", FUNCTIONS)
def test_functions_of_the_same_variety_give_the_same_orbit(name: str) -> None:
    """Equations f(W) = 0 of exp d in the user's frame reproduce the default, by another chart and more unknowns."""
    system, function = FUNCTIONS[name]
    start = {"restricted_velocity": (0.4, 0.9), "steps": 60}
    result = nh.simulate(nh.discretize(system, 0.1, constraint=function), **start)
    expected = nh.simulate(nh.discretize(system, 0.1), **start)
    assert_near(result, expected, 1e-12, "configuration", "momentum")
    assert nh.invariants(result).constraint_residual <= 1e-14


@pytest.mark.parametrize(
    "system",
    [TOP, TILTED, SLEIGH, nh.SuslovTop(np.diag([1.0, 2.0, 3.0, 4.0]))],
    ids=["top", "tilted top", "sleigh", "top on SO(4)"],
)
def test_angles_of_displacements_are_those_of_their_logarithms(system: nh.SuslovTop | nh.ChaplyginSleigh) -> None:
    """At rest, near it, at any angle and near half-turns."""
    variety, group = nh.discretize(system, 0.1).variety, system.group
    directions = np.random.default_rng(3).normal(size=(60, len(variety.chart)))
    y = directions * np.repeat([0.0, 1e-200, 1e-9, 0.3, 4.0, 1e4], 10)[:, None]
    assert np.abs(variety.angle(y) - group.angle(group.log(variety.displaced(y)))).max() <= 1e-14


@pytest.mark.parametrize("tilt", [6e-17, 1e-9, 1e-6])
@pytest.mark.parametrize("name", ["SO(3)", "SO(4)", "SE(3)"])
def test_rows_in_axes_next_to_those_of_the_body(name: str, tilt: float) -> None:
    """Their small entries have few digits or none: the chart, and what is read of it, are those of the named class."""
    body = {"SO(3)": TOP, "SO(4)": nh.SuslovTop(np.diag([1.0, 2.0, 3.0, 4.0]) + 0.1), "SE(3)": IN_SPACE}[name]
    group, velocity = body.group, np.linspace(0.3, 0.5, body.rank) @ body.constraint_subspace
    g = group.exp(tilt * np.cos(np.arange(group.dim)))
    forbidden = body.annihilator @ group.adjoint(group.inverse(g))
    same = nh.LLSystem(group, g @ body.homogeneous_mass_tensor @ g.T, annihilator=forbidden)
    expected = nh.simulate(nh.discretize(body, 0.1), body_velocity=velocity, steps=9)
    moved = nh.simulate(nh.discretize(same, 0.1), body_velocity=group.adjoint(g) @ velocity, steps=9)
    assert np.abs(moved.displacement - g @ expected.displacement @ group.inverse(g)).max() < 1e-14
    assert np.abs(moved.momentum @ group.adjoint(g) - expected.momentum).max() < 1e-13


@pytest.mark.profile("routes", instead="test_functions_of_the_same_variety_give_the_same_orbit")
def test_the_naive_constraint_spirals() -> None:
    """With W - I in d the balanced sleigh turns by a constant angle D and its steps shrink by cos D: a spiral."""
    sleigh = nh.ChaplyginSleigh(1.0, 1.0, 0.0)
    start = {"body_velocity": (0.8, 0.5, 0.0), "steps": 100}
    naive = nh.simulate(nh.discretize(sleigh, 0.2, constraint="naive"), **start)
    W = naive.displacement
    turn, advance = np.arctan2(W[:, 1, 0], W[:, 0, 0]), W[:, 0, 2]
    assert np.ptp(turn) <= 1e-13
    assert np.abs(advance[1:] / advance[:-1] - np.cos(turn[0])).max() <= 1e-12
    assert nh.invariants(naive).energy_drift > 0.2
    assert nh.invariants(nh.simulate(nh.discretize(sleigh, 0.2), **start)).energy_drift <= 1e-13


def _general(group: object) -> AbstractLLSystem:
    rng = np.random.default_rng(8)
    return nh.LLSystem(group, mass_tensor(group, rng), random_rows(group, 3, rng))


@pytest.mark.profile("routes", keep=["system2-skew-matrix-False"])
@pytest.mark.parametrize(
    ("system", "constraint", "difference", "consistent"),
    [
        (SLEIGH, "naive", "matrix", True),
        (SLEIGH, "skew", "logarithmic", True),
        (SLEIGH, "skew", "matrix", False),
        (TILTED, "skew", "matrix", True),
        (_general(nh.SO(4)), "exponential", "logarithmic", True),
        (_general(nh.SO(4)), "skew", "logarithmic", False),
        (_general(nh.SE(3)), "naive", "matrix", True),
    ],
)
def test_consistency(system: AbstractLLSystem, constraint: str, difference: str, consistent: bool) -> None:
    """A variety is consistent with the map that projects W - I, or with log W, and with nothing else of the names."""
    defect = nh.consistency_defect(nh.discretize(system, 0.1, difference, constraint))
    assert defect <= 1e-12 if consistent else defect >= 1e-3


@pytest.mark.profile("routes", instead="test_consistency")
def test_consistency_with_a_map_of_the_users() -> None:
    """The skew constraint is consistent with the map that takes W to (W - W^-1)/2; a callable l_d needs its map."""
    group = SLEIGH.group
    discrete = nh.discretize(SLEIGH, 0.1, difference=lambda W: jnp.trace((W - jnp.eye(3)) @ (W - jnp.eye(3)).T))
    assert nh.consistency_defect(discrete, lambda W: group.vee(W - group.inverse(W)) / 2) <= 1e-14
    with pytest.raises(ValueError, match=r"discretization_map=...\)` must be given"):
        nh.consistency_defect(discrete)
    with pytest.raises(ValueError, match="must return 3 finite coordinates"):
        nh.consistency_defect(discrete, lambda W: W)


def test_whether_a_discrete_lagrangian_is_even() -> None:
    """Odd terms are found; both named differences are even."""
    J = np.asarray(TOP.mass_tensor)

    def even(W: jnp.ndarray) -> jnp.ndarray:
        return jnp.trace((W - jnp.eye(3)) @ J @ (W - jnp.eye(3)).T) / 0.2

    assert nh.discretize(TOP, 0.1, even).is_self_adjoint
    assert not nh.discretize(TOP, 0.1, lambda W: even(W) + 0.1 * _rotation_vector(W)[0] ** 3).is_self_adjoint
    assert nh.discretize(TOP, 0.1, "logarithmic").is_self_adjoint


ON_HEISENBERG = {"system": OTHERS["Heisenberg"]}
# Each with what it must be, before any work; on the Heisenberg group with what would define it.
test_bad_choices_are_refused = refusals(
    ({"constraint": "skewed"}, "must be one of"),
    ({"constraint": lambda W: W[0, 2]}, "tangent to d"),
    ({"constraint": lambda W: W[1, 0] - W[0, 1] + 0.1}, "vanish at the identity"),
    ({"constraint": [lambda W: W[1, 0] - W[0, 1]] * 2}, "be 1 functions"),
    ({"constraint": lambda W: (W[1, 0] - W[0, 1]) ** 2}, "independent"),
    ({"constraint": lambda W: W}, "real scalar functions"),
    ({"constraint": lambda W: jnp.sqrt(W[1, 0] - W[0, 1])}, "differentiable"),
    ({"constraint": lambda W: float(W[1, 0])}, "real scalar functions"),
    ({"constraint": [3]}, "real scalar functions"),
    ({"difference": "matrices"}, "must be one of"),
    ({"difference": lambda W: W}, "real scalar function"),
    ({"difference": lambda W: jnp.sqrt(jnp.sum((W - jnp.eye(3)) ** 2))}, "differentiable"),
    ({"difference": lambda W, h: jnp.trace(W) / h}, "real scalar function"),
    (ON_HEISENBERG | {"difference": "matrix"}, r"difference=.*be defined for the system.*MatrixGroup\(form="),
    (ON_HEISENBERG | {"constraint": "skew"}, r"constraint=.*be defined on the group.*MatrixGroup\(basis, form=G\)"),
    ask=lambda option: nh.discretize(**{"system": TOP, "time_step": 0.1} | option),
)


def test_defaults_on_a_group_without_a_form() -> None:
    """They are logarithmic and exponential, and do not keep the energy."""
    discrete = nh.discretize(**ON_HEISENBERG, time_step=0.1)
    assert (discrete.difference, discrete.constraint) == ("logarithmic", "exponential")
    assert not discrete.conserves_energy
