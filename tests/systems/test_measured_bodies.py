"""Bodies by mass, center of mass and inertia: what an engineer has, and what no body has."""

import warnings
from typing import Any

import numpy as np
import pytest
from refusals import refusals

import nonholo as nh
from nonholo.groups import AbstractMatrixGroup
from nonholo.systems import ChaplyginSleigh, LLSystem, LRSystem, RigidBody, SuslovTop, VeselovaTop

_RNG = np.random.default_rng(7)
GROUPS = [nh.SO(2), nh.SO(3), nh.SE(2), nh.SE(3)]


def _cloud(n: int, flat: bool = False) -> tuple[np.ndarray, np.ndarray]:
    """Return masses and places of the particles of a body; a flat one lies askew in a plane of space."""
    points = _RNG.normal(size=(9, n)) + 0.4
    if flat:
        points[:, -1] = 0.0
        points = points @ nh.SO(n).random(_RNG).T + 0.3
    return _RNG.uniform(0.2, 1.0, size=9), points


def _measured(masses: np.ndarray, points: np.ndarray) -> tuple[float, Any, np.ndarray]:
    """Return mass, inertia about the center of mass and center of mass by their sums over particles."""
    a = masses @ points / masses.sum()
    r = points - a
    if points.shape[1] == 2:
        return masses.sum(), masses @ (r * r).sum(axis=1), a
    each = (r * r).sum(axis=1)[:, None, None] * np.eye(3) - r[:, :, None] * r[:, None, :]
    return masses.sum(), np.einsum("p,pij->ij", masses, each), a


def _by_particles(group: AbstractMatrixGroup, masses: np.ndarray, points: np.ndarray) -> np.ndarray:
    r"""Return the inertia operator by its definition, $\sum_p m_p \langle\hat x r_p, \hat y r_p\rangle$."""
    if group.size > points.shape[1]:
        points = np.column_stack([points, np.ones(len(points))])
    velocities = np.einsum("xij,pj->xpi", group.basis, points)
    return np.einsum("p,xpi,ypi->xy", masses, velocities, velocities)


@pytest.mark.parametrize("group", GROUPS, ids=repr)
@pytest.mark.parametrize("flat", [False, True])
def test_the_energy_is_that_of_the_particles(group: AbstractMatrixGroup, flat: bool) -> None:
    """The inertia operator of a body that was measured is the sum over its particles, about any origin."""
    n = 2 if group.size == 2 or "SE(2)" in repr(group) else 3
    masses, points = _cloud(n, flat and n == 3)
    measured, wanted = _measured(masses, points), _by_particles(group, masses, points)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        bodies = [
            RigidBody.from_inertia(*measured, group),
            LLSystem.from_inertia(*measured, group, constraint_subspace=np.eye(group.dim)[:1]),
            LLSystem.from_inertia(*measured, group, annihilator=np.eye(group.dim)[1:]),
        ]
    for body in bodies:
        assert np.abs(body.inertia_operator - wanted).max() < 1e-13 * np.abs(wanted).max()


def test_a_sleigh_is_a_measured_body() -> None:
    """`ChaplyginSleigh` and the general system from the same numbers have one inertia operator."""
    sleigh = ChaplyginSleigh(1.3, 0.7, 0.5, b=0.3)
    same = LLSystem.from_inertia(1.3, 0.7, [0.5, 0.3], nh.SE(2), sleigh.constraint_subspace)
    assert np.abs(same.inertia_operator - sleigh.inertia_operator).max() < 1e-15
    assert np.abs(np.asarray(same.homogeneous_mass_tensor) - sleigh.homogeneous_mass_tensor).max() < 1e-15


@pytest.mark.parametrize(
    "made",
    [
        lambda inertia: SuslovTop.from_inertia(inertia),
        lambda inertia: SuslovTop.from_inertia(inertia, axis=(0.6, 0.0, 0.8)),
        lambda inertia: RigidBody.from_inertia(1.0, inertia, np.zeros(3), nh.SO(3)),
        lambda inertia: LLSystem.from_inertia(1.0, inertia, np.ones(3), nh.SE(3), np.eye(6)[:2]),
    ],
    ids=["top", "top about another axis", "body", "system"],
)
class TestImpossibleBodies:
    """Inertia tensors that break the triangle inequality."""

    def test_are_warned_of(self, made: Any) -> None:
        """The warning is one of its own, names the eigenvalue and points to the line of the user."""
        with pytest.warns(nh.ImpossibleBodyWarning, match=r"eigenvalue -1\.5\.") as report:
            assert made(np.diag([5.0, 1.0, 1.0])) is not None
        assert len(report) == 1
        assert report[0].filename == __file__

    def test_flat_bodies_are_possible(self, made: Any) -> None:
        """Flat bodies, whose mass tensor has an eigenvalue 0 to rounding, are built in silence."""
        R = nh.SO(3).random(_RNG)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            for moments in ([1.0, 2.0, 3.0], [3.0, 1e-7, 3.0 - 1e-7]):
                made(np.diag(moments))
            askew = R @ np.diag([0.1, 0.7, 0.8]) @ R.T
            made((askew + askew.T) / 2)


def test_runs_of_an_impossible_body_do_not_warn_again() -> None:
    """The warning comes where the body is made: not in runs, ensembles and rebuilt members."""
    with pytest.warns(nh.ImpossibleBodyWarning):
        top = SuslovTop.from_inertia(np.diag([5.0, 3.0, 1.5]), axis=(0, 1, 0))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        discrete = nh.discretize(top, 0.1)
        nh.simulate(discrete, restricted_velocity=(0.1, 0.2), steps=3)
        tensors = np.asarray(top.mass_tensor) * np.array([1.0, 1.1])[:, None, None]
        nh.ensemble(discrete, restricted_velocity=(0.1, 0.2), parameters={"mass_tensor": tensors}, steps=3).orbit(1)


_WRONG = (
    (1.0, 1.0, [0.0] * 4, nh.SO(4), r"must be SO\(2\), SO\(3\), SE\(2\) or SE\(3\).*J_C \+ m a a\^T"),
    (1.0, 1.0, [0.0] * 4, nh.SE(4), r"Got SE\(4\)"),
    (1.0, 1.0, [0.0], nh.Translations(2), "where inertia tensors are"),
    (1.0, 1.0, [0.0], "SE(2)", "must be a matrix group"),
    (-1.0, 1.0, [0.0, 0.0], nh.SE(2), r"from_inertia\(mass=...\)` must be positive"),
    (1.0, np.eye(3), [0.0, 0.0], nh.SE(2), r"inertia=...\)` must have shape \(\)"),
    (1.0, 1.0, [0.0, 0.0, 0.0], nh.SO(3), r"inertia=...\)` must have shape \(3, 3\)"),
    (1.0, np.eye(3), [0.0, 0.0], nh.SO(3), r"center_of_mass=...\)` must have shape \(3,\).*fixed point"),
    (1.0, 0.0, [0.0, 0.0], nh.SE(2), r"inertia=...\)` must be positive"),
)
# What is no measurement of a body in the plane or in space is refused in the words of the door.
test_wrong_measurements_of_a_free_body_are_refused = refusals(*_WRONG, ask=RigidBody.from_inertia)
test_wrong_measurements_of_a_system_are_refused = refusals(
    *_WRONG, ask=lambda *measured: LLSystem.from_inertia(*measured, annihilator=np.eye(3)[:1])
)


def test_an_inertia_in_place_of_a_mass_tensor_is_told_the_door() -> None:
    """On SE(n) the shapes differ, and the message names the constructors that take an inertia."""
    with pytest.raises(ValueError, match=r"have shape \(4, 4\).*`LLSystem.from_inertia` and `RigidBody.from_inertia`"):
        LLSystem(nh.SE(3), np.eye(3), annihilator=np.eye(6)[3:])


_J, _ROWS, _IN_PLANE = np.diag([1.0, 2.0, 4.5]), np.eye(3)[:2], np.diag([1.0, 2.0, 2.0])
_BOTH = ("mass tensor J = [[1.", "inertia tensor tr(J) I - J = [[6.5")
_OF_PLANE = (
    "homogeneous mass tensor J = [[1.",
    "mass = 2.",
    "center of mass = [0. 0.]",
    "about the center of mass = 3.",
)
_OF_SPACE = ("mass = 2.", "center of mass = [0.5 0.  0. ]", "inertia about the center of mass = [[3.")
_SHOWN = [
    *((made(_J), _BOTH) for made in (SuslovTop, RigidBody, VeselovaTop)),
    *((made(nh.SO(3), _J, _ROWS), _BOTH) for made in (LLSystem, LRSystem)),
    (LLSystem(nh.SE(2), _IN_PLANE, _ROWS), _OF_PLANE),
    (RigidBody.from_inertia(2.0, np.diag([3.0, 2.0, 1.5]), [0.5, 0.0, 0.0], nh.SE(3)), _OF_SPACE),
]


@pytest.mark.parametrize(("system", "words"), _SHOWN)
def test_both_tensors_are_shown(system: Any, words: tuple[str, ...]) -> None:
    """`repr` shows the mass tensor and the inertia tensor, so that one is not given for the other."""
    assert not [each for each in words if each not in repr(system)]
    assert "inertia" not in repr(RigidBody(np.diag([1.0, 2.0, 3.0, 4.0])))
