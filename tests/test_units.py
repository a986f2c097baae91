"""The discrete map in any unit of mass and of time: the same displacements, the same outcomes, from 1e-147 to 1e147."""

from collections.abc import Callable

import numpy as np
import pytest

import nonholo as nh
from nonholo.kernels import suslov_body

J = np.array([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]])
ROWS = np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
MIXED = np.random.default_rng(5).normal(size=(3, 6))
WIDE = np.cov(np.random.default_rng(0).normal(size=(4, 9)))
FORM = np.diag([1.0, 1.0, -1.0])
LORENTZ = nh.MatrixGroup(FORM @ nh.SO(3).basis, form=FORM)
SYSTEMS: dict[str, Callable[[float], nh.SuslovTop]] = {
    "top": lambda mass: nh.SuslovTop(J * mass),
    "top about a tilted axis": lambda mass: nh.SuslovTop(J * mass, axis=(0.6, 0.0, 0.8)),
    "top 4": lambda mass: nh.SuslovTop(WIDE * mass),
    "arrowhead top": lambda mass: nh.SuslovTop.arrowhead(mass * np.arange(1.0, 6.0), mass * np.full(4, 0.2)),
    "sleigh": lambda mass: nh.ChaplyginSleigh(mass, 1.2 * mass, 0.5, 0.3),
    "sleigh in space": lambda mass: nh.MultidimensionalSleigh(1.3 * mass, [0.3, 0.2, -0.1], np.eye(3) * mass),
    "LL on SO(3)": lambda mass: nh.LLSystem(nh.SO(3), J * mass, ROWS),
    "LL on SE(3)": lambda mass: nh.LLSystem(nh.SE(3), WIDE * mass, MIXED),
    "LL with a form": lambda mass: nh.LLSystem(LORENTZ, np.diag([1.0, 2.0, 0.5]) * mass, np.eye(3)[:2]),
    "LR on SO(3)": lambda mass: nh.LRSystem(nh.SO(3), J * mass, ROWS),
    "LR on SE(3)": lambda mass: nh.LRSystem(nh.SE(3), WIDE * mass, MIXED),
    "free body": lambda mass: nh.RigidBody(J * mass),
    "free body in space": lambda mass: nh.RigidBody(WIDE * mass, nh.SE(3)),
    "Veselova top": lambda mass: nh.VeselovaTop(J * mass),
}
UNITS = [2.0**exponent for exponent in (-490, -245, 245, 490)]
SPEEDS = (0.3, 3.0, 30.0)  # the last ones beyond folds


def _run(name: str, speed: float, mass: float = 1.0, time: float = 1.0, order: int = 2) -> nh.Orbit:
    system = SYSTEMS[name](mass)
    velocity = speed * np.linspace(0.5, 1.0, system.rank)
    discrete = nh.discretize(system, 0.5 * time, order=order)
    return nh.simulate(discrete, restricted_velocity=velocity / time, steps=20, throw=False)


@pytest.mark.profile("problems", keep=["LL on SE(3)*", "LR on SO(3)*", "free body-*"])
@pytest.mark.parametrize("unit", UNITS)
@pytest.mark.parametrize("name", SYSTEMS)
def test_units_of_mass_and_time_do_not_matter(name: str, unit: float) -> None:
    """Neither outcome nor displacement changes; nothing over- or underflows on the way."""
    for speed in SPEEDS:
        expected = _run(name, speed)
        for found in (_run(name, speed, mass=unit), _run(name, speed, time=unit)):
            assert (found.outcome, len(found)) == (expected.outcome, len(expected))
            np.testing.assert_allclose(found.displacement, expected.displacement, rtol=0, atol=1e-13)


@pytest.mark.parametrize("far", [1e-151, 1e151])
@pytest.mark.parametrize("name", SYSTEMS)
def test_units_beyond_are_refused(name: str, far: float) -> None:
    """Masses and time steps whose squares over- or underflow are refused by name before any work."""
    requirement = "not lie below 1e-150" if far < 1 else r"no number beyond 1e\+150"
    with pytest.raises(ValueError, match=f"(mass|diagonal).*{requirement}"):
        SYSTEMS[name](1e-4 * far if far < 1 else 1e4 * far)
    with pytest.raises(ValueError, match=f"time_step.*{requirement}"):
        nh.discretize(SYSTEMS[name](1.0), far)


def test_the_disc_of_the_certificate_does_not_depend_on_the_unit_of_mass() -> None:
    """Products of the coupling underflow without a unit, and the disc would reach beyond folds."""
    B, c = J[:2, :2] + 0.9 * np.eye(2), J[:2, 2]
    radius = suslov_body(B, c).certain
    for mass in UNITS:
        assert suslov_body(mass * B, mass * c).certain == radius
