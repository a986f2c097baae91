"""General systems against special ones: the same bodies by other classes, free bodies, groups of the user's."""

import numpy as np
import pytest
from bodies import GENERAL, mass_tensor
from refusals import refusals

import nonholo as nh


def test_free_motion_in_the_plane_has_equal_differences() -> None:
    """With the center of mass at the reference point, heading and position advance by the same step each time."""
    body = nh.RigidBody(np.diag([0.4, 0.9, 2.0]), nh.SE(2))
    orbit = nh.simulate(nh.discretize(body, 0.5), body_velocity=(0.9, 1.0, -0.7), steps=200)
    assert np.ptp(np.diff(orbit.heading)) <= 1e-13
    assert np.ptp(np.diff(orbit.position, axis=0), axis=0).max() <= 1e-13


@pytest.mark.parametrize("n", [3, 4, 7])
def test_the_free_top_by_the_riccati_equation(n: int) -> None:
    """Each displacement of the Moser-Veselov map is the one that the Riccati equation gives for its momentum."""
    rng = np.random.default_rng(n)
    J = mass_tensor(nh.SO(n), rng)
    discrete = nh.discretize(nh.RigidBody(J), 0.2)
    orbit = nh.simulate(discrete, momentum=2 * rng.normal(size=n * (n - 1) // 2) / n, steps=10)
    for P, W in zip(orbit.momentum, orbit.displacement, strict=True):
        # the Schur form of a Hamiltonian matrix of size 2 n that holds J^2
        assert np.abs(nh.moser_veselov_displacement(J, P, 0.2) - W).max() <= 1e-15 * np.linalg.cond(J) ** 2
    assert np.ptp(orbit.spatial_momentum, axis=0).max() <= 1e-13


def test_the_riccati_equation_ends_with_the_branch() -> None:
    """Along a growing momentum both ways end at the same one, to a thousandth."""
    J, P = np.diag([1.0, 2.0, 3.0]), np.array([1.0, 0.5, -0.4])
    discrete = nh.discretize(nh.RigidBody(J), 1.0)

    def solvable(scale: float) -> tuple[bool, bool]:
        ran = len(nh.simulate(discrete, momentum=scale * P, steps=1, throw=False)) > 0
        try:
            nh.moser_veselov_displacement(J, scale * P, 1.0)
        except ValueError:
            return ran, False
        return ran, True

    low, high = 1.0, 20.0
    assert solvable(low) == (True, True)
    assert solvable(high) == (False, False)
    while high / low > 1.001:
        middle = np.sqrt(low * high)
        low, high = (middle, high) if solvable(middle)[0] else (low, middle)
    assert solvable(0.999 * low)[1]
    assert not solvable(1.001 * high)[1]


_GOOD = {"mass_tensor": np.diag([1.0, 2.0, 3.0]), "momentum": [0.1, 0.2, 0.3], "time_step": 0.1}
# Flat bodies, wrong shapes and time steps.
test_what_the_riccati_equation_cannot_do_is_refused = refusals(
    ({"mass_tensor": np.diag([1.0, 2.0, 0.0])}, "mass_tensor"),
    ({"momentum": [1.0]}, "momentum"),
    ({"time_step": -1.0}, "time_step"),
    ask=lambda bad: nh.moser_veselov_displacement(**_GOOD | bad),
)


@pytest.mark.parametrize("length", [1e-6, 1e4])
@pytest.mark.parametrize("name", ["any d on SE(3)", "right-invariant on SE(3)", "free on SE(3)"])
def test_units_of_length_do_not_matter(name: str, length: float) -> None:
    """The same body in micrometers or in steps of ten kilometers takes the same path, and is as exact."""
    system, velocity = GENERAL[name]
    rescaled = np.diag([length, length, length, 1.0])
    coordinates = np.diag([1.0, 1.0, 1.0, length, length, length])
    J = rescaled @ np.asarray(system.homogeneous_mass_tensor) @ rescaled
    rows = system.constraint_subspace @ coordinates
    other = type(system)(nh.SE(3), J, rows) if name != "free on SE(3)" else nh.RigidBody(J, nh.SE(3))
    start = {"restricted_velocity": velocity if name != "free on SE(3)" else velocity @ coordinates}
    expected = nh.simulate(nh.discretize(system, 0.3), restricted_velocity=velocity, steps=100)
    result = nh.simulate(nh.discretize(other, 0.3), **start, steps=100)
    # rows that mix lengths and angles lose the digits of the ratio
    tolerance = 1e-12 * max(1.0, length)
    assert np.abs(np.linalg.inv(rescaled) @ result.configuration @ rescaled - expected.configuration).max() <= tolerance


@pytest.mark.parametrize("scale", [1e3, 1e6, 1e149])
@pytest.mark.parametrize(
    "name", ["suslov 4", "any d on SE(3)", "free on SO(4)", "veselova 3", "right-invariant on SE(3)"]
)
def test_however_far_beyond_the_fold_there_is_no_branch(name: str, scale: float) -> None:
    """A momentum that no displacement has is distinguished from an iteration that fails, by any factor."""
    system, velocity = GENERAL[name]
    orbit = nh.simulate(nh.discretize(system, 1.0), restricted_velocity=scale * velocity, steps=1, throw=False)
    assert orbit.outcome == nh.Outcome.no_real_branch
