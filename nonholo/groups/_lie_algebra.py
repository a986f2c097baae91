r"""Whether matrices span a Lie algebra, and one that preserves a bilinear form: then $W^{-1} = G^{-1}W^TG$."""

import numpy as np

from nonholo.base.checks import array, error
from nonholo.base.types import Array, Float
from nonholo.groups._coordinates import coordinates_of

_CLOSED = 1e-10  # relative; a basis or a form typed with ten digits is taken as meant


def checked_basis(where: str, basis: Array) -> Float[np.ndarray, "dim N N"]:
    """Return the basis as a read-only array, refused if it does not span a Lie algebra of square matrices."""
    basis = array(where, basis, (None, None, None), "Pass the basis as an array of shape (dim, N, N).")
    if basis.shape[0] == 0 or basis.shape[1] != basis.shape[2]:
        raise error(where, "hold square matrices", f"shape {basis.shape}", "Pass an array of shape (dim, N, N).")
    _independent(where, basis)
    _closed(where, basis)
    return array(where, basis + 0.0, basis.shape)  # without negative zeros: equal bases have equal bytes


def _independent(where: str, basis: np.ndarray) -> None:
    lengths = np.linalg.norm(basis, axis=(1, 2))
    if not np.all(lengths > 0):
        got = f"a zero matrix at index {int(np.argmin(lengths))}"
        raise error(where, "be linearly independent", got, "Leave it out.")
    rows = basis.reshape(len(basis), -1) / lengths[:, None]
    values = np.linalg.svd(rows, compute_uv=False)
    rank = int(np.sum(values > _CLOSED * values[0]))
    if rank < len(basis):
        got = f"{len(basis)} matrices of rank {rank}"
        raise error(where, "be linearly independent", got, "Leave out matrices that the others span.")


def _closed(where: str, basis: np.ndarray) -> None:
    unit = basis / np.linalg.norm(basis, axis=(1, 2), keepdims=True)
    products = unit[:, None] @ unit[None]
    brackets = products - np.swapaxes(products, 0, 1)
    coordinates = coordinates_of(unit)
    gap = np.linalg.norm(brackets - coordinates.matrix(coordinates.vector(brackets)), axis=(2, 3))
    if gap.max() > _CLOSED:
        i, j = (int(k) for k in np.unravel_index(gap.argmax(), gap.shape))
        got = f"the bracket of matrices {i} and {j}, which leaves the span by {gap[i, j]:.3g} (both scaled to length 1)"
        raise error(where, "span a Lie algebra", got, "Add the missing brackets to the basis, or check its entries.")


def checked_form(where: str, basis: Float[np.ndarray, "dim N N"], form: Array) -> Float[np.ndarray, "N N"]:
    r"""Return G as a read-only array, refused unless the energy theorem holds on the group of the basis.

    G must be nondegenerate, $x^TG + Gx = 0$ on the algebra, and $x^3$ must stay in it: then so does
    $(W - W^{-1})/2$, see docs/theory/energy-theorem.md.
    """
    size = basis.shape[-1]
    form = array(where, form, (size, size), f"Pass the ({size}, {size}) matrix G of the form that the group preserves.")
    values = np.linalg.svd(form, compute_uv=False)
    if not values[-1] > _CLOSED * values[0]:
        got = f"singular values from {values[0]:.3g} to {values[-1]:.3g}"
        raise error(where, "be nondegenerate", got, "Leave it out: without it W^-1 is not linear in W.")
    unit = basis / np.linalg.norm(basis, axis=(1, 2), keepdims=True)
    _preserved(where, unit, form / values[0])
    _cubes_stay(where, unit)
    return array(where, form + 0.0, form.shape)


def _preserved(where: str, unit: np.ndarray, form: np.ndarray) -> None:
    residuals = np.abs(np.swapaxes(unit, 1, 2) @ form + form @ unit).max(axis=(1, 2))
    if residuals.max() > _CLOSED:
        worst = int(residuals.argmax())
        got = f"a residual of {residuals[worst]:.3g} at matrix {worst} of the basis (both scaled to length 1)"
        raise error(where, "satisfy x^T G + G x = 0 on the algebra", got, "Pass the form that the group preserves.")


def _cubes_stay(where: str, unit: np.ndarray) -> None:
    """Refuse an algebra that some x^3 leaves; a polynomial identity, tried on random x."""
    coordinates = coordinates_of(unit)
    X = coordinates.matrix(np.random.default_rng(0).normal(size=(4, len(unit))) / np.sqrt(len(unit)))
    cubes = X @ X @ X
    gap = np.abs(cubes - coordinates.matrix(coordinates.vector(cubes))).max()
    if gap > _CLOSED * np.abs(cubes).max():
        requirement = "be that of a group whose algebra contains (W - W^-1)/2"
        got = f"an algebra that a cube leaves by {gap / np.abs(cubes).max():.3g} of its size"
        raise error(where, requirement, got, "Pass the whole algebra of the form: U(p, q), not SU(p, q).")
