r"""Whether a constraint subspace belongs to a symmetric pair, decided by linear algebra in the algebra.

For a symmetric pair $\exp\mathfrak{d}$ is a submanifold, the model of Cartan of the symmetric space G/H.
"""

from typing import Any

import numpy as np

from nonholo.base.limits import within_memory
from nonholo.base.types import Float
from nonholo.groups import AbstractMatrixGroup
from nonholo.systems._mass import checked_group
from nonholo.systems._subspace import independent_rows, null_space, spanned

_RANK = 1e-12  # relative size below which a singular value or a residual counts as zero


def is_symmetric_pair(group: AbstractMatrixGroup, constraint_subspace: Any) -> bool:
    r"""Tell whether the algebra has a subalgebra that forms a symmetric pair with the constraint subspace.

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
    where = "is_symmetric_pair(constraint_subspace=...)"
    d = spanned(independent_rows(where, constraint_subspace, group.dim))
    constants, everything = _structure_constants(group), np.eye(group.dim)
    escape = _significant(_brackets(constants, everything, d) @ null_space(d).T)
    normalizer = null_space(escape.reshape(group.dim, escape[0].size).T, _RANK)
    derived = spanned(_significant(_brackets(constants, d, d)).reshape(-1, group.dim), _RANK)
    shared = _intersection(normalizer, d)
    fits = (
        len(normalizer) + len(d) - len(shared) == group.dim
        and len(spanned(np.concatenate([normalizer, derived]), _RANK)) == len(normalizer)
        and len(_intersection(derived, d)) == 0
        and not _significant(_brackets(constants, shared, d)).any()
    )
    return _subalgebra(constants, normalizer, shared, derived) if fits else None


def _subalgebra(
    constants: np.ndarray, normalizer: np.ndarray, shared: np.ndarray, derived: np.ndarray
) -> np.ndarray | None:
    """Solve for the graph of phi over a complement of `shared` in `normalizer`; None if there is none."""
    rest = _intersection(normalizer, null_space(np.concatenate([derived, shared])))
    start = np.concatenate([derived, rest])
    if len(shared) == 0:
        return start
    coordinates = np.linalg.pinv(np.concatenate([start, shared]))
    parts = _significant(_brackets(constants, start, start) @ coordinates)
    along, omega = parts[..., : len(start)], parts[..., len(start) :]
    action = _significant(_brackets(constants, start, shared) @ coordinates)[..., len(start) :]  # [x_i, e_a] in e
    matrix, target = _conditions(along, omega, action, len(derived))
    phi = np.linalg.lstsq(matrix, target, rcond=_RANK)[0]
    residual = np.abs(matrix @ phi - target).max(initial=0.0)
    graph = start + phi.reshape(len(start), len(shared)) @ shared
    return graph if residual <= 1e3 * _RANK * (1 + np.abs(phi).max(initial=0.0)) else None


def _conditions(along: np.ndarray, omega: np.ndarray, action: np.ndarray, fixed: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the linear system of phi (h rows, e columns, flattened) and its right-hand side."""
    h, e = action.shape[:2]
    unit_h, unit_e = np.eye(h), np.eye(e)
    system = np.einsum("ijl,ac->ijcla", along, unit_e)
    system = system - np.einsum("jl,iac->ijcla", unit_h, action) + np.einsum("il,jac->ijcla", unit_h, action)
    zero = np.einsum("fl,ac->fcla", unit_h[:fixed], unit_e)
    matrix = np.concatenate([system.reshape(-1, h * e), zero.reshape(-1, h * e)])
    return matrix, np.concatenate([omega.ravel(), np.zeros(fixed * e)])


def _structure_constants(group: AbstractMatrixGroup) -> Float[np.ndarray, "dim dim dim"]:
    """Return the brackets of the basis; a common factor does not matter here, so the largest is made 1."""
    basis = np.eye(group.dim)
    constants = group.bracket(basis[:, None, :], basis[None, :, :])
    return constants / max(np.abs(constants).max(initial=0.0), np.finfo(np.float64).tiny)


def _brackets(constants: np.ndarray, x: np.ndarray, y: np.ndarray) -> Float[np.ndarray, "i j dim"]:
    return np.einsum("jb,ibc->ijc", y, np.einsum("ia,abc->ibc", x, constants))


def _significant(values: np.ndarray) -> np.ndarray:
    """Set rounding errors in brackets of unit rows to zero: ranks are relative to the largest entry."""
    return np.where(np.abs(values) > _RANK * values.shape[0], values, 0.0)


def _intersection(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    return null_space(np.concatenate([null_space(first), null_space(second)]), _RANK)
