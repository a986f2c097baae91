"""Whether matrices are a basis of a Lie algebra."""

import numpy as np

from nonholo.base.checks import array, error
from nonholo.base.types import Array, Float
from nonholo.groups._coordinates import coordinates_of

_CLOSED = 1e-10  # relative; a basis typed with ten digits is taken as meant


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
