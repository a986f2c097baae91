"""Mass tensors, inertia tensors and the inertia operator of a mass distribution moved by a matrix group."""

from typing import Any

import numpy as np

from nonholo.base.checks import array, check_scale, error, instance, is_traced, symmetric
from nonholo.base.types import Array, Float
from nonholo.groups import AbstractMatrixGroup
from nonholo.systems._wide import narrow

_MADE = "Of a mass, an inertia and a center of mass `LLSystem.from_inertia` and `RigidBody.from_inertia` make it."


def inertia_tensor(mass_tensor: Float[Array, "... 3 3"]) -> Float[Array, "... 3 3"]:
    r"""Return $\mathrm{tr}(J)\,\mathrm{Id} - J$, the inertia tensor of a body with mass tensor $J = \int r r^T dm$.

    Example:
        >>> inertia_tensor(np.diag([1.0, 2.0, 3.0])).diagonal()
        array([5., 4., 3.])
    """
    xp = mass_tensor.__array_namespace__()
    return xp.linalg.trace(mass_tensor)[..., None, None] * xp.eye(3) - mass_tensor


def mass_tensor_from_inertia(inertia: Float[Array, "3 3"]) -> Float[Array, "3 3"]:
    r"""Return the mass tensor $J = \tfrac12\mathrm{tr}(I)\,\mathrm{Id} - I$ of a body with inertia tensor $I$.

    Raises:
        ValueError: `inertia` is not a finite symmetric (3, 3) matrix.

    Example:
        >>> mass_tensor_from_inertia(np.diag([5.0, 4.0, 3.0])).diagonal()
        array([1., 2., 3.])
    """
    where = "mass_tensor_from_inertia(inertia=...)"
    tensor = symmetric(where, array(where, inertia, (3, 3)), "Pass the inertia tensor about the fixed point.")
    xp = tensor.__array_namespace__()
    return xp.trace(tensor) / 2 * xp.eye(3) - tensor


def inertia_form(
    group: AbstractMatrixGroup, matrices: Float[Array, "k N N"], mass_tensor: Float[Array, "... N N"]
) -> Float[Array, "... k k"]:
    r"""Return $\bigl(\mathrm{tr}(D_i\mathbb{J}D_j^*)\bigr)_{ij}$ for velocities $D_i$ and a (homogeneous) mass tensor.

    A body that moves with the velocity $\xi$, a matrix, has kinetic energy $\tfrac12\mathrm{tr}(\xi\mathbb{J}\xi^*)$;
    the star is the transpose but for a group with a form (`AbstractMatrixGroup.form_adjoint`).
    """
    xp = mass_tensor.__array_namespace__()
    matrices = xp.asarray(matrices)
    duals = xp.swapaxes(group.form_adjoint(matrices), -1, -2)
    size = matrices.shape[-1]
    momenta = matrices @ mass_tensor[..., None, :, :]
    flat = xp.reshape(momenta, (*momenta.shape[:-2], size * size))
    return flat @ xp.reshape(duals, (-1, size * size)).T


def inertia_from_mass_tensor(
    group: AbstractMatrixGroup, mass_tensor: Float[Array, "... N N"]
) -> Float[Array, "... dim dim"]:
    r"""Return the inertia operator $\mathbb{I}_{ij} = \mathrm{tr}(E_i\mathbb{J}E_j^*)$ in the basis $E_i$.

    Example:
        >>> inertia_from_mass_tensor(SO(3), np.diag([1.0, 2.0, 3.0])).diagonal()
        array([5., 4., 3.])
    """
    narrow(f"The inertia operator on {group}", group.dim)
    return inertia_form(group, group.basis, mass_tensor)


def body_tensor(where: str, value: Array, remedy: str) -> Array:
    """Return a symmetric (n, n) mass tensor, n >= 3."""
    tensor = array(where, value, (None, None), remedy)
    rows, columns = tensor.shape
    if rows != columns or rows < 3:
        raise error(where, "have shape (n, n) with n >= 3", f"shape {tensor.shape}", remedy)
    return symmetric(where, tensor, remedy)


def checked_group(where: str, group: Any) -> AbstractMatrixGroup:
    """Refuse what is not a matrix group."""
    remedy = "Pass SO(n), SE(n), or MatrixGroup(basis)."
    return instance(where, group, AbstractMatrixGroup, "be a matrix group", remedy)


def group_mass_tensor(where: str, group: AbstractMatrixGroup, value: Array, instead: str) -> Array:
    """Return a symmetric mass tensor on which the matrices of SO(n) or SE(n) act; refuse it on other groups."""
    if not group.is_rigid:
        reason = f"the group {group!r}, which does not move the points of a rigid body"
        raise error(where, "be used on SO(n) or SE(n)", reason, instead)
    size = group.identity.shape[0]
    remedy = f"On {group!r} the mass tensor is ({size}, {size}): J on SO(n), homogeneous on SE(n). {_MADE}"
    return symmetric(where, array(where, value, (size, size), remedy), remedy)


def form_mass_tensor(where: str, group: AbstractMatrixGroup, value: Array) -> Array:
    r"""Return a mass tensor of a group with a form, refused unless $J^* = G^{-1}J^TG = J$."""
    size = group.identity.shape[0]
    remedy = "If G is symmetric or antisymmetric pass (J + J*)/2, which has the same kinetic energy."
    tensor = array(where, value, (size, size), f"On {group!r} the mass tensor is ({size}, {size}).")
    if is_traced(tensor):
        return tensor
    check_scale(where, tensor)
    gap, G = np.abs(group.form_adjoint(tensor) - tensor).max(), np.asarray(group.form)
    sizes = np.abs(np.linalg.inv(G)) @ np.abs(tensor).T @ np.abs(G)
    if gap > 64 * np.finfo(np.float64).eps * sizes.max():
        raise error(where, "satisfy J* = G^-1 J^T G = J", f"a residual of {gap:.3g}", remedy)
    return tensor


def rotation_to(axis: np.ndarray) -> np.ndarray:
    """Return the shortest rotation taking e3 to the unit vector `axis`; diag(1, -1, -1) for -e3."""
    x, y, z = axis
    if z < 0 and x == 0 and y == 0:
        return np.diag([1.0, -1.0, -1.0])
    scale = 1 / (1 + z) if z > -0.5 else (1 - z) / (x * x + y * y)
    return np.array([[1 - scale * x * x, -scale * x * y, x], [-scale * x * y, 1 - scale * y * y, y], [-x, -y, z]])
