r"""Constraint subspaces: rows that span $\mathfrak{d}$ and rows of its annihilator, and whether it is half of a pair.

Linear algebra alone; the meaning of a subspace is defined by the systems. For a symmetric pair $\exp\mathfrak{d}$ is a
submanifold, the model of Cartan of the symmetric space G/H.
"""

from typing import Any

import numpy as np

from nonholo.base.checks import array, dimension, error, is_traced, within_memory
from nonholo.base.types import Array, Float, read_only
from nonholo.groups import AbstractMatrixGroup
from nonholo.systems._mass import checked_group, refuse_wide

_ROUNDING = 64 * np.finfo(np.float64).eps  # times the larger side of a matrix: singular values below it count as zero


def null_space(rows: Float[np.ndarray, "m dim"], tolerance: float = _ROUNDING) -> Float[np.ndarray, "n dim"]:
    """Return orthonormal rows that span the vectors orthogonal to the given rows.

    Args:
        rows: Any number of rows, dependent ones included.
        tolerance: Singular values below it, times the larger side and the largest singular value, count as zero.
    """
    count, dim = rows.shape
    _refuse_too_wide(dim)
    if count == 0:
        return np.eye(dim)
    _, values, right = np.linalg.svd(np.linalg.qr(rows, mode="r") if count > dim else rows)
    rank = int(np.sum(values > tolerance * max(count, dim) * values[0]))
    return _from_axes(right[rank:])


def complement(rows: Float[np.ndarray, "k dim"]) -> Float[np.ndarray, "s dim"]:
    """Return rows that span the vectors orthogonal to independent rows: coordinate rows for coordinate rows."""
    if np.all(np.count_nonzero(rows, axis=1) == 1):
        _refuse_too_wide(rows.shape[1])
        return np.eye(rows.shape[1])[~rows.any(axis=0)]
    return null_space(rows)


def _refuse_too_wide(dim: int) -> None:
    within_memory(f"The complement of a subspace in {dim} dimensions", 8.0 * dim**2, "Use a smaller group.")


def row_space(rows: Float[np.ndarray, "m dim"], tolerance: float = _ROUNDING) -> Float[np.ndarray, "k dim"]:
    """Return orthonormal rows that span the same space as the given rows."""
    return null_space(null_space(rows, tolerance))


def independent_rows(where: str, value: Any, dim: int) -> Float[np.ndarray, "k dim"]:
    """Return linearly independent rows of width `dim`; none at all is allowed."""
    remedy = f"Pass one row of {dim} coordinates for each dimension, and an array of shape (0, {dim}) for none."
    if is_traced(value):
        raise error(where, "be concrete", "a traced value", "A constraint is structure: differentiate in the masses.")
    empty = isinstance(value, list | tuple) and not value
    rows = array(where, np.empty((0, dim)) if empty else value, (None, dim), remedy)
    if len(rows) == 0:
        return rows
    values = np.linalg.svd(rows, compute_uv=False)
    if len(rows) > dim or values[-1] <= _ROUNDING * dim * values[0]:
        sizes = f"from {values[0]:.3g} (number 1) to {values[-1]:.3g} ({len(values)})"
        got = f"{len(rows)} rows with singular values {sizes}"
        raise error(where, "have linearly independent rows", got, "Leave out the rows that others span.")
    return rows


def subspace_and_annihilator(owner: str, dim: int, subspace: Any, annihilator: Any) -> tuple[Array, Array]:
    """Return both from at least one of them, checked."""
    if subspace is None and annihilator is None:
        remedy = "Pass one of the two; the other is computed."
        raise error(f"{owner}(constraint_subspace=...)", "be given, or annihilator=", "neither", remedy)
    if annihilator is None:
        rows = independent_rows(f"{owner}(constraint_subspace=...)", subspace, dim)
        return rows, read_only(complement(rows))
    covectors = independent_rows(f"{owner}(annihilator=...)", annihilator, dim)
    if subspace is None:
        return read_only(complement(covectors)), covectors
    rows = independent_rows(f"{owner}(constraint_subspace=...)", subspace, dim)
    _refuse_inconsistent(f"{owner}(annihilator=...)", rows, covectors)
    return rows, covectors


def _refuse_inconsistent(where: str, rows: np.ndarray, covectors: np.ndarray) -> None:
    dim, remedy = rows.shape[1], "Leave one of the two out, it is computed from the other."
    if len(rows) + len(covectors) != dim:
        got = f"{len(covectors)} rows beside a constraint subspace of dimension {len(rows)}"
        raise error(where, f"have {dim - len(rows)} rows, the codimension of the constraint subspace", got, remedy)
    scale = np.abs(covectors) @ np.abs(rows).T
    residual = np.max(np.abs(covectors @ rows.T), initial=0.0)
    if residual > _ROUNDING * np.max(scale, initial=0.0):
        raise error(where, "vanish on the constraint subspace", f"a pairing of {residual:.3g}", remedy)


def top_rows(group: AbstractMatrixGroup) -> Float[np.ndarray, "k dim"]:
    r"""Return the coordinates of the planes $e_i\wedge e_n$ in which a top on SO(n) may turn."""
    return _plane_rows(group, [(i, group.size - 1) for i in range(group.size - 1)])


def sleigh_rows(group: AbstractMatrixGroup) -> Float[np.ndarray, "n dim"]:
    r"""Return the coordinates of the planes $e_1\wedge e_j$, then of the velocity along $e_1$, of a sleigh on SE(n)."""
    n = group.size - 1
    along = np.zeros((1, group.dim))
    along[0, -n] = 1.0
    return np.concatenate([_plane_rows(group, [(0, j) for j in range(1, n)]), along])


def _plane_rows(group: AbstractMatrixGroup, planes: list) -> Float[np.ndarray, "k dim"]:
    r"""Return the coordinates of $e_i\wedge e_j = e_ie_j^T - e_je_i^T$ for pairs (i, j) counted from 0."""
    refuse_wide(group)
    wedge = np.zeros((len(planes), group.size, group.size))
    for row, (i, j) in enumerate(planes):
        wedge[row, i, j], wedge[row, j, i] = 1.0, -1.0
    return group.vee(wedge) + 0.0


def reference_point_subspace(n: int, plane: Any) -> Float[np.ndarray, "m dim"]:
    r"""Return the subspace of se(n) in which the velocity of the body's reference point stays in a plane of the body.

    $$ \mathfrak{d} = \{(w, v) : w \in so(n),\ v \in \mathrm{span}(\text{plane})\}. $$

    Reference: [fedorov-zenkov-2004], section 3, "Left-invariant constraints on SE(n)".

    Args:
        n: Dimension of the space, 2 or more.
        plane: Rows span the directions, fixed in the body, in which the reference point may move.

    Raises:
        ValueError: n < 2, or dependent rows or rows of the wrong width.

    Example:
        >>> reference_point_subspace(2, [[1.0, 0.0]])
        array([[1., 0., 0.],
               [0., 1., 0.]])
    """
    n = dimension("reference_point_subspace(n=...)", n)
    rows = independent_rows("reference_point_subspace(plane=...)", plane, n)
    turns = n * (n - 1) // 2
    within_memory("reference_point_subspace(n=...)", 16.0 * (turns + n) ** 2, "Pass a smaller n.")
    return np.block([[np.eye(turns), np.zeros((turns, n))], [np.zeros((len(rows), turns)), rows]])


def _from_axes(rows: Float[np.ndarray, "k dim"]) -> Float[np.ndarray, "k dim"]:
    """Return the orthonormal rows that the coordinate axes, projected to the span of orthonormal rows, give in order.

    Unlike singular vectors they do not depend on the library that computes them; coordinate subspaces get coordinate
    rows. The squared residuals of the axes add up to the number of missing rows, so some axis always passes the bound.
    """
    dim = rows.shape[1]
    basis = np.empty((0, dim))
    for projection in rows.T @ rows:
        residual = projection - basis.T @ (basis @ projection)
        if residual @ residual > 1 / (2 * dim):
            residual = residual - basis.T @ (basis @ residual)
            basis = np.concatenate([basis, residual[None, :] / np.linalg.norm(residual)])
    return basis


_RANK = 1e-12  # relative size below which a singular value or a residual counts as zero


def is_symmetric_pair(group: AbstractMatrixGroup, constraint_subspace: Any) -> bool:
    r"""Return whether the algebra has a subalgebra that forms a symmetric pair with the constraint subspace.

    $$ \mathfrak{g} = \mathfrak{h}\oplus\mathfrak{d}, \qquad [\mathfrak{h},\mathfrak{h}]\subset\mathfrak{h}, \quad
       [\mathfrak{h},\mathfrak{d}]\subset\mathfrak{d}, \quad [\mathfrak{d},\mathfrak{d}]\subset\mathfrak{h} $$

    for some $\mathfrak{h}$; `symmetric_complement` returns one. No complement is preferred: the answer does not depend
    on a scalar product, and it is complete up to the rank decisions (relative tolerance 1e-12). It speaks of the
    algebra. That $(W - W^{-1})/2 \in \mathfrak{d}$ for $W \in \exp\mathfrak{d}$ follows where the involution is a
    conjugation by a matrix, as for the tops and sleighs of this library.

    Reference: [fedorov-zenkov-2004], section 2, the condition on (g, h).

    Args:
        group: A matrix group.
        constraint_subspace: Rows span $\mathfrak{d}$.

    Raises:
        ValueError: Dependent rows, or rows of the wrong width.

    Example:
        >>> is_symmetric_pair(nh.SE(2), [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
        True
        >>> is_symmetric_pair(nh.SO(3), [[1.0, 0.0, 0.0]])
        False
    """
    return symmetric_complement(group, constraint_subspace) is not None


def symmetric_complement(group: AbstractMatrixGroup, constraint_subspace: Any) -> Float[np.ndarray, "s dim"] | None:
    r"""Return rows that span an $\mathfrak{h}$ of a symmetric pair with the constraint subspace, or None.

    Every such $\mathfrak{h}$ lies in the normalizer $\mathfrak{n} = \{x : [x, \mathfrak{d}]\subset\mathfrak{d}\}$,
    contains $[\mathfrak{d}, \mathfrak{d}]$ and complements $\mathfrak{e} = \mathfrak{n}\cap\mathfrak{d}$, which must
    commute with $\mathfrak{d}$ and is then an abelian ideal of $\mathfrak{n}$. So $\mathfrak{h}$ is the graph of a map
    $\varphi$ from any complement $\mathfrak{h}_0 \supset [\mathfrak{d},\mathfrak{d}]$ to $\mathfrak{e}$; that it is a
    subalgebra is a linear condition on $\varphi$, because $\mathfrak{e}$ is abelian:

    $$ \varphi([x, y]_0) = [x, y]_\mathfrak{e} + [x, \varphi(y)] - [y, \varphi(x)], \qquad
       \varphi|_{[\mathfrak{d},\mathfrak{d}]} = 0. $$

    Raises:
        ValueError: Dependent rows, or rows of the wrong width.

    Example:
        >>> symmetric_complement(nh.SE(2), [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
        array([[0., 0., 1.]])
    """
    checked_group("is_symmetric_pair(group=...)", group)
    within_memory("is_symmetric_pair(group=...)", 8.0 * group.dim**3, "Use a smaller group.")
    d = row_space(independent_rows("is_symmetric_pair(constraint_subspace=...)", constraint_subspace, group.dim))
    everything = np.eye(group.dim)
    constants = group.bracket(everything[:, None, :], everything[None, :, :])
    constants = constants / max(np.abs(constants).max(initial=0.0), np.finfo(np.float64).tiny)  # a factor is free
    escape = _significant(_brackets(constants, everything, d) @ null_space(d).T)
    normalizer = null_space(escape.reshape(group.dim, escape[0].size).T, _RANK)
    commutators = row_space(_significant(_brackets(constants, d, d)).reshape(-1, group.dim), _RANK)
    overlap = _intersection(normalizer, d)
    fits = (
        len(normalizer) + len(d) - len(overlap) == group.dim
        and len(row_space(np.concatenate([normalizer, commutators]), _RANK)) == len(normalizer)
        and len(_intersection(commutators, d)) == 0
        and not _significant(_brackets(constants, overlap, d)).any()
    )
    return _subalgebra(constants, normalizer, overlap, commutators) if fits else None


def _subalgebra(
    constants: np.ndarray, normalizer: np.ndarray, overlap: np.ndarray, commutators: np.ndarray
) -> np.ndarray | None:
    """Solve for the graph of phi over a complement of `overlap` in `normalizer`; None if there is none."""
    rest = _intersection(normalizer, null_space(np.concatenate([commutators, overlap])))
    start = np.concatenate([commutators, rest])
    if len(overlap) == 0:
        return start
    coordinates = np.linalg.pinv(np.concatenate([start, overlap]))
    parts = _significant(_brackets(constants, start, start) @ coordinates)
    along, omega = parts[..., : len(start)], parts[..., len(start) :]
    action = _significant(_brackets(constants, start, overlap) @ coordinates)[..., len(start) :]  # [x_i, e_a] in e

    unit_h, unit_e = np.eye(len(start)), np.eye(len(overlap))  # phi has h rows and e columns, which are flattened
    system = np.einsum("ijl,ac->ijcla", along, unit_e)
    system = system - np.einsum("jl,iac->ijcla", unit_h, action) + np.einsum("il,jac->ijcla", unit_h, action)
    zero = np.einsum("fl,ac->fcla", unit_h[: len(commutators)], unit_e)
    matrix = np.concatenate([each.reshape(-1, len(start) * len(overlap)) for each in (system, zero)])
    target = np.concatenate([omega.ravel(), np.zeros(len(commutators) * len(overlap))])
    phi = np.linalg.lstsq(matrix, target, rcond=_RANK)[0]
    residual = np.abs(matrix @ phi - target).max(initial=0.0)
    graph = start + phi.reshape(len(start), len(overlap)) @ overlap
    return graph if residual <= 1e3 * _RANK * (1 + np.abs(phi).max(initial=0.0)) else None


def _brackets(constants: np.ndarray, x: np.ndarray, y: np.ndarray) -> Float[np.ndarray, "i j dim"]:
    return np.einsum("jb,ibc->ijc", y, np.einsum("ia,abc->ibc", x, constants))


def _significant(values: np.ndarray) -> np.ndarray:
    """Set rounding errors in brackets of unit rows to zero: ranks are relative to the largest entry."""
    return np.where(np.abs(values) > _RANK * values.shape[0], values, 0.0)


def _intersection(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    return null_space(np.concatenate([null_space(first), null_space(second)]), _RANK)
