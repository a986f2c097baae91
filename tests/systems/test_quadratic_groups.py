"""Bodies on groups of a form: which mass tensors are taken, and the inertia that they define."""

import numpy as np
import pytest
from forms import FORMS
from refusals import refusals

import nonholo as nh

_GROUP = FORMS["SO(2,1)"]


_J = np.array([[1.0, 0.0, 0.5], [0.0, 2.0, 0.0], [0.5, 0.0, 3.0]])  # symmetric, but J* has the entries -0.5


def test_tensors_fit_the_form() -> None:
    """A tensor that is its own adjoint is taken."""
    assert nh.LLSystem(_GROUP, _J @ _GROUP.form, np.eye(3)[:2]).mass_tensor[0, 2] == -0.5


# A tensor that is not its own adjoint, with its residual; systems that need SO(n) or SE(n).
test_tensors_and_systems_that_do_not_fit_are_refused = refusals(
    (
        lambda: nh.LLSystem(_GROUP, _J, np.eye(3)[:2]),
        r"LLSystem\(mass_tensor=.*J\* = G\^-1 J\^T G = J.*residual of 1\. If G is",
    ),
    (lambda: nh.LLSystem(_GROUP, np.eye(4), np.eye(3)[:2]), r"shape \(3, 3\).*shape \(4, 4\)"),
    (lambda: nh.RigidBody(_GROUP.form, _GROUP), r"RigidBody.*be used on SO\(n\) or SE\(n\).*LLSystem"),
    (lambda: nh.LRSystem(_GROUP, _GROUP.form, np.eye(3)[:2]), r"LRSystem.*be used on SO\(n\) or SE\(n\)"),
)


def test_the_inertia_along_d_may_be_indefinite_but_not_singular() -> None:
    """On a cone of the Killing form two vectors have no energy: one line is refused, the plane through both is not."""
    form = np.einsum("iab,jba->ij", _GROUP.basis, _GROUP.basis)
    values, axes = np.linalg.eigh(form)
    null = axes[:, 0] / np.sqrt(-values[0]) + axes[:, 2] / np.sqrt(values[2])
    with pytest.raises(ValueError, match=r"inertia along the constraint invertible.*eigenvalues"):
        nh.LLSystem(_GROUP, np.eye(3), [null])
    with pytest.raises(ValueError, match=r"inertia along the constraint invertible.*eigenvalues \[0"):
        nh.LLSystem(_GROUP, np.zeros((3, 3)), np.eye(3)[:2])
    assert np.linalg.det(nh.LLSystem(_GROUP, np.eye(3), [null, axes[:, 0]]).constrained_inertia) < 0


def test_the_flow_knows_the_inertia_alone() -> None:
    """A mass tensor and its inertia operator on the group without form give one continuous motion."""
    J = np.diag([1.0, 2.0, 4.0]) @ _GROUP.form
    rows = np.array([[1.0, 0.2, 0.0], [0.0, 0.3, 1.0]])
    one = nh.LLSystem(_GROUP, J, rows)
    if np.linalg.eigvalsh(one.constrained_inertia)[0] < 0:
        pytest.fail("choose rows with a definite inertia")
    other = nh.LLSystem(nh.MatrixGroup(_GROUP.basis), inertia_operator=one.inertia_operator, constraint_subspace=rows)
    first, second = (nh.flow(s, restricted_velocity=[0.4, 0.3], times=[0.0, 1.0, 3.0]) for s in (one, other))
    assert np.abs(first.configuration - second.configuration).max() < 1e-9
    assert np.ptp(first.energy) < 1e-9
