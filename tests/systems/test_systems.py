"""Inertia operators, frames, energy and equilibria of the systems, and what they refuse."""

import numpy as np
import pytest
from refusals import refusals

import nonholo as nh
from nonholo.systems import AbstractLLSystem, inertia_from_mass_tensor, inertia_tensor, mass_tensor_from_inertia

J = np.array([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]])
INERTIA = np.array([[3.0, 0.1, 0.2], [0.1, 2.0, 0.3], [0.2, 0.3, 2.5]])
SYSTEMS = [
    nh.SuslovTop(J),
    nh.SuslovTop.from_inertia(INERTIA, axis=np.array([1, 2, 2]) / 3),
    nh.SuslovTop.from_inertia(INERTIA, axis=(0, 0, -1)),
    nh.ChaplyginSleigh(mass=2.0, inertia=1.0, a=0.5, b=0.3),
    nh.ChaplyginSleigh(mass=0.7, inertia=2.0, a=-0.4),
]


def test_inertia_operators_against_their_definitions() -> None:
    """The top's is its inertia tensor, the sleigh's the quadratic form of the kinetic energy of a moving body."""
    assert np.allclose(SYSTEMS[0].inertia_operator, inertia_from_mass_tensor(nh.SO(3), J), rtol=0, atol=1e-15)
    m, inertia, a, b = 2.0, 1.0, 0.5, 0.3
    omega, v1, v2 = velocity = np.array([0.7, -0.4, 0.9])
    center = np.array([v1 - omega * b, v2 + omega * a])
    kinetic = (inertia * omega**2 + m * center @ center) / 2
    assert velocity @ SYSTEMS[3].inertia_operator @ velocity / 2 == pytest.approx(kinetic, rel=1e-15)


def test_mass_and_inertia_tensors_convert_both_ways() -> None:
    """tr(J) Id - J and its inverse."""
    assert np.allclose(mass_tensor_from_inertia(inertia_tensor(J)), J, rtol=0, atol=1e-15)


@pytest.mark.parametrize("system", SYSTEMS, ids=lambda s: type(s).__name__)
def test_frames_carry_the_constraint_to_itself(system: AbstractLLSystem) -> None:
    """The canonical frame maps subspace to subspace, inertia to inertia, and r_canonical = C r."""
    group, frame, canonical = system.group, system.frame, system.canonical
    Ad = group.adjoint(frame)
    assert np.allclose(system.annihilator @ Ad @ canonical.constraint_subspace.T, 0, atol=1e-15)
    assert np.allclose(Ad.T @ system.inertia_operator @ Ad, canonical.inertia_operator, atol=1e-14)
    p = np.random.default_rng(0).normal(size=3)
    assert np.allclose(canonical.restrict(group.coadjoint(frame, p)), system.frame_map @ system.restrict(p), atol=1e-14)
    assert np.allclose(system.annihilator @ system.constraint_subspace.T, 0, atol=1e-15)


def test_from_inertia_keeps_the_documented_rows() -> None:
    """Rows are S(0,1,0), S(-1,0,0) with S the shortest rotation taking e3 to the axis."""
    axis = np.array([2.0, -1.0, 2.0]) / 3
    top = nh.SuslovTop.from_inertia(INERTIA, axis)
    S = nh.SO(3).exp(np.arccos(axis[2]) * np.cross([0, 0, 1.0], axis) / np.linalg.norm(np.cross([0, 0, 1.0], axis)))
    assert np.allclose(top.constraint_subspace, np.array([[0, 1, 0], [-1, 0, 0]]) @ S.T, atol=1e-15)
    assert np.array_equal(nh.SuslovTop.from_inertia(INERTIA, (0, 0, -1)).frame, np.diag([1.0, -1.0, -1.0]))
    assert np.allclose(top.inertia_operator, INERTIA, atol=1e-15)


# Each error names the owner, the requirement, what was got and the remedy.
test_bad_input_is_refused = refusals(
    (lambda: nh.SuslovTop([[1, 0.1, 0], [0.3, 1, 0], [0, 0, 1]]), r"symmetric.*entries 0.1 and 0.3 at \(0, 1\)"),
    (lambda: nh.SuslovTop(np.eye(2)), r"shape \(n, n\) with n >= 3. Got shape \(2, 2\)"),
    (lambda: nh.SuslovTop(np.full((3, 3), np.nan)), r"finite. Got nan at index \(0, 0\)"),
    (lambda: nh.SuslovTop(1j * np.eye(3)), "be real"),
    (lambda: nh.SuslovTop(np.diag([-2.0, 1.0, 1.0])), "positive definite. Got an eigenvalue -1"),
    (lambda: nh.SuslovTop(np.eye(3), axis=(0, 0, 2)), "unit vector. Got length 2"),
    (lambda: nh.SuslovTop.from_inertia(np.eye(3) + np.eye(3, k=1)), r"from_inertia.*symmetric"),
    (lambda: nh.ChaplyginSleigh(-1.0, 1.0, 0.5), r"mass=\.\.\.\)` must be positive. Got -1.0"),
    (lambda: nh.ChaplyginSleigh(1.0, 0.0, 0.5), r"inertia=\.\.\.\)` must be positive. Got 0.0.*center of mass"),
    (lambda: nh.ChaplyginSleigh(1.0, 1.0, np.inf), r"a=\.\.\.\)` must be finite"),
    (lambda: nh.ChaplyginSleigh(1.0, 1.0, "x"), "real numbers. Got 'x'"),
)


def test_flat_bodies_are_allowed() -> None:
    """A flat and a rod-like body have a singular mass tensor but a positive constrained inertia."""
    nh.SuslovTop(np.diag([1.0, 2.0, 0.0]))
    rod = np.outer([1.0, 0.5, 1.0], [1.0, 0.5, 1.0])
    assert np.linalg.matrix_rank(nh.SuslovTop(rod).mass_tensor) == 1
