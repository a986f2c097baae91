"""The discrete map in any unit of mass, length and time: the same displacements, outcomes and values."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import pytest
from unit_changes import UNITS, WIDE, J, in_space

import nonholo as nh
from nonholo.base.results import Outcome
from nonholo.discrete import Branches
from nonholo.discrete.branching._equations import follow, frame_of
from nonholo.kernels import suslov_body

ROWS = np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
ARROWHEAD = np.arange(1.0, 6.0), np.full(4, 0.2)
FORM, UNEVEN = np.diag([1.0, 1.0, -1.0]), np.diag([1.0, 2.0, 0.5])
LORENTZ = nh.MatrixGroup(FORM @ nh.SO(3).basis, form=FORM)


def _sleigh(inertia: np.ndarray) -> Callable[[float, float], nh.MultidimensionalSleigh]:
    """Return a sleigh in space in any unit of mass and length."""
    center = np.array([0.3, 0.2, -0.1])
    return lambda mass, length: nh.MultidimensionalSleigh(1.3 * mass, center * length, inertia * mass * length**2)


SYSTEMS: dict[str, Callable[[float, float], Any]] = {
    "top": lambda mass, length: nh.SuslovTop(J * mass * length**2),
    "top about a tilted axis": lambda mass, length: nh.SuslovTop(J * mass * length**2, axis=(0.6, 0.0, 0.8)),
    "top 4": lambda mass, length: nh.SuslovTop(WIDE * mass * length**2),
    "arrowhead top": lambda mass, length: nh.SuslovTop.arrowhead(*(mass * length**2 * part for part in ARROWHEAD)),
    "sleigh": lambda mass, length: nh.ChaplyginSleigh(mass, 1.2 * mass * length**2, 0.5 * length, 0.3 * length),
    "sleigh in space": _sleigh(np.eye(3)),
    "long sleigh in space": _sleigh(np.diag([1.0, 2.0, 3.0])),
    "LL on SO(3)": lambda mass, length: nh.LLSystem(nh.SO(3), J * mass * length**2, ROWS),
    "LL on SE(3)": lambda mass, length: nh.LLSystem(nh.SE(3), *in_space(mass, length)),
    "LL with a form": lambda mass, length: nh.LLSystem(LORENTZ, UNEVEN * mass * length**2, np.eye(3)[:2]),
    "LR on SO(3)": lambda mass, length: nh.LRSystem(nh.SO(3), J * mass * length**2, ROWS),
    "LR on SE(3)": lambda mass, length: nh.LRSystem(nh.SE(3), *in_space(mass, length)),
    "free body": lambda mass, length: nh.RigidBody(J * mass * length**2),
    "free body in space": lambda mass, length: nh.RigidBody(in_space(mass, length)[0], nh.SE(3)),
    "Veselova top": lambda mass, length: nh.VeselovaTop(J * mass * length**2),
}
FACTORS = [2.0**exponent for exponent in (-490, -245, 245, 490)]
SPEEDS = (0.3, 3.0, 30.0)  # the last ones beyond folds


def _run(name: str, speed: float, mass: float = 1.0, time: float = 1.0, order: int = 2) -> nh.Orbit:
    system = SYSTEMS[name](mass, 1.0)
    velocity = speed * np.linspace(0.5, 1.0, system.rank)
    discrete = nh.discretize(system, 0.5 * time, order=order)
    return nh.simulate(discrete, restricted_velocity=velocity / time, steps=20, throw=False)


@pytest.mark.profile("problems", keep=["LL on SE(3)*", "LR on SO(3)*", "free body-*"])
@pytest.mark.parametrize("unit", FACTORS)
@pytest.mark.parametrize("name", SYSTEMS)
def test_units_of_mass_and_time_do_not_matter(name: str, unit: float) -> None:
    """Neither outcome nor displacement changes; nothing over- or underflows on the way."""
    for speed in SPEEDS:
        expected = _run(name, speed)
        for result in (_run(name, speed, mass=unit), _run(name, speed, time=unit)):
            assert (result.outcome, len(result)) == (expected.outcome, len(expected))
            np.testing.assert_allclose(result.displacement, expected.displacement, rtol=0, atol=1e-13)


@pytest.mark.parametrize("far", [1e-151, 1e151])
@pytest.mark.parametrize("name", SYSTEMS)
def test_units_beyond_are_refused(name: str, far: float) -> None:
    """Masses and time steps whose squares over- or underflow are refused by name before any work."""
    requirement = "not lie below 1e-150" if far < 1 else r"no number beyond 1e\+150"
    with pytest.raises(ValueError, match=f"(mass|diagonal).*{requirement}"):
        SYSTEMS[name](1e-4 * far if far < 1 else 1e4 * far, 1.0)
    with pytest.raises(ValueError, match=f"time_step.*{requirement}"):
        nh.discretize(SYSTEMS[name](1.0, 1.0), far)


def test_the_disc_of_the_certificate_does_not_depend_on_the_unit_of_mass() -> None:
    """Products of the coupling underflow without a unit, and the disc would reach beyond folds."""
    B, c = J[:2, :2] + 0.9 * np.eye(2), J[:2, 2]
    radius = suslov_body(B, c).certain
    for mass in FACTORS:
        assert suslov_body(mass * B, mass * c).certain == radius


class Values(NamedTuple):
    """Values of the map in the first units, and the restricted momentum that they have in the others."""

    branches: Branches
    displacement: np.ndarray
    momentum: np.ndarray
    discrete: nh.Discretization
    restricted: np.ndarray


def _values(name: str, speed: float, mass: float = 1.0, length: float = 1.0, time: float = 1.0) -> Values:
    """Return all values over the momentum of a velocity along the constraint."""
    system = SYSTEMS[name](mass, length)
    n, rows = system.group.point_size, system.constraint_subspace
    slides = ~np.any(system.group.basis[:, :n, :n], axis=(1, 2))
    velocity = speed * np.linspace(0.5, 1.0, system.rank) / time
    restricted = system.constrained_inertia @ np.where(np.any(rows[:, ~slides], axis=1), velocity, length * velocity)
    discrete = nh.discretize(system, 0.3 * time)
    branches = nh.displacements_over(discrete, restricted)
    W, P = branches.displacement.copy(), branches.momentum / (mass * length * length / time)
    W[:, :n, n:] /= length
    return Values(branches, W, np.where(slides, length * P, P), discrete, restricted)


KNOWN = [name for name in SYSTEMS if not name.startswith(("LR", "free", "Ves"))]  # all their values


@pytest.mark.profile("problems", keep=["top 4-*", "sleigh-*", "long sleigh*"])
@pytest.mark.parametrize("unit", UNITS)
@pytest.mark.parametrize("name", KNOWN)
def test_units_do_not_matter_to_the_values_of_the_map(name: str, unit: str) -> None:
    """Powers of two change no bit of any value, powers of ten round; none is lost, and they keep their order."""
    for speed in SPEEDS:
        expected = _values(name, speed)
        for factor in (2.0**-17, 2.0**17, 1e-5, 1e5):
            scaled = _values(name, speed, **{unit: factor})
            error = 0.0 if factor in (2.0**-17, 2.0**17) else 1e-11  # far above rounding, next to no root is a fold
            for array, other in ((scaled.displacement, expected.displacement), (scaled.momentum, expected.momentum)):
                np.testing.assert_allclose(array, other, rtol=0, atol=error * np.abs(other).max())
            here, there = scaled.branches, expected.branches
            np.testing.assert_allclose(here.fold_distance, there.fold_distance, rtol=100 * error, atol=0)
            assert (here.principal, here.missing) == (there.principal, there.missing)
            for field in ("is_real", "multiplicity", "region"):
                np.testing.assert_array_equal(getattr(here, field), getattr(there, field))


@pytest.mark.parametrize("name", ["top", "top 4", "arrowhead top", "sleigh", "sleigh in space", "long sleigh in space"])
def test_no_value_is_lost_at_large_momenta(name: str) -> None:
    """A root far away because the momentum asks for it is a value, at 1e10 times the usual momenta too."""
    few = _values(name, 3.0).branches
    for speed in (1e4, 1e8, 1e10):
        values = _values(name, speed)
        system, branches = values.discrete.system, values.branches
        assert (len(branches), branches.missing) == (len(few), few.missing)
        X = branches.displacement - system.group.identity
        rows = system.group.hat(system.constraint_subspace)
        reached = np.einsum("iab,vab->vi", rows, X @ system.homogeneous_mass_tensor)  # linear: without cancellation
        demanded = values.discrete.time_step * values.restricted
        np.testing.assert_allclose(reached, np.tile(demanded, (len(X), 1)), rtol=0, atol=1e-10 * np.abs(demanded).max())


def test_lost_values_are_counted() -> None:
    """Where boosts are too large for doubles no value is left, and the number of those that are missing says so."""
    near, far, beyond = (_values("LL with a form", speed).branches for speed in (0.3, 3e4, 3e9))
    assert (near.real_count, far.real_count, beyond.real_count) == (2, 2, 0)
    assert (near.missing, far.missing, beyond.missing) == (2, 2, 4)
    assert "4 missing" in repr(beyond)


@pytest.mark.parametrize("name", ["long sleigh in space", "top"])
def test_a_fold_is_met_at_the_same_place_on_the_way_to_any_momentum(name: str) -> None:
    """The outcome of a path is the fold on it, however far beyond it the path leads."""
    folds = []
    for speed in (30.0, 1e6, 1e10):
        _, _, _, discrete, restricted = _values(name, speed)
        frame, end = frame_of("test", discrete), discrete.time_step * discrete.system.to_canonical(restricted)
        start = frame.equations(0 * end)
        code, fold = follow(start, frame.equations(end), frame.point(discrete.system.group.identity))
        assert code == Outcome.no_real_branch
        folds.append(fold)
    np.testing.assert_allclose(folds, np.tile(folds[0], (3, 1)), rtol=0, atol=1e-4)  # the root of the shortest step


OBLIQUE = np.array([[1.24, 0.01, 0.96], [0.01, 1.07, 0.26], [0.96, 0.26, 1.84]])
TILTED = np.array([[1.26, -0.28, -0.46], [-0.28, 1.33, -0.59], [-0.46, -0.59, 1.13]])
BRANCHES: dict[str, Any] = {
    "smallest": (0.85, [0.05, 1.65, 0.22], OBLIQUE, [-0.93, -1.11, 0.56]),
    "largest": (1.18, [-0.09, 0.2, -0.44], TILTED, [-0.4, -0.78, 1.06]),
}


@pytest.mark.parametrize("branch", BRANCHES)
def test_the_smallest_momentum_does_not_depend_on_the_unit_of_length(branch: str) -> None:
    """Angular and linear momenta are compared in the unit of the body, so that a rule takes the same values."""
    (mass, center, inertia, velocity), turns = BRANCHES[branch], []
    for length in (1.0, 1e-3, 1e3):
        sleigh = nh.MultidimensionalSleigh(mass, np.array(center) * length, inertia * length**2)
        start = np.array(velocity) * [1.0, 1.0, length]
        orbit = nh.simulate(nh.discretize(sleigh, 0.5), restricted_velocity=start, steps=3, branch=branch)
        turns.append(orbit.displacement[:, :3, :3])
    np.testing.assert_allclose(turns, np.tile(turns[0], (3, 1, 1, 1)), rtol=0, atol=1e-12)
