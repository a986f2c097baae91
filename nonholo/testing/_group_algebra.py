"""Measurements of what is linear in a group: basis, bracket, conjugation and their transposes."""

import numpy as np
import scipy.linalg

from nonholo.testing._group_samples import GroupSamples
from nonholo.testing._measures import gap, largest
from nonholo.testing._report import Check, need

_OFF = 1e-3  # how far matrices are moved off the group
_BLIND = 1e3  # a residual is sound if it sees at least this part of the distance


def _sizes(s: GroupSamples) -> float:
    group = s.group
    expected = [
        (group.basis, (group.dim, group.size, group.size)),
        (group.identity, (group.size, group.size)),
        (group.exp(s.x), (len(s.x), group.size, group.size)),
        (group.pose_from_matrix(group.identity), (group.pose_size,)),
    ]
    return sum(np.shape(array) != shape or np.asarray(array).dtype != np.float64 for array, shape in expected)


def _basis(s: GroupSamples) -> float:
    flat = s.group.basis.reshape(s.group.dim, -1)
    return s.group.dim - np.linalg.matrix_rank(flat / np.linalg.norm(flat, axis=1)[:, None])


def _closure(s: GroupSamples) -> float:
    rows = s.group.basis.reshape(s.group.dim, -1)
    unit = np.diag(1 / np.linalg.norm(rows, axis=1))
    brackets = s.commutator(unit[:, None, :], unit[None, :, :])
    return largest(brackets - s.matrix(s.coordinates(brackets)))


def _bracket(s: GroupSamples) -> float:
    return gap(s.matrix(s.group.bracket(s.x, s.y)), s.commutator(s.x, s.y))


def _jacobi(s: GroupSamples) -> float:
    bracket, x, y, z = s.group.bracket, s.x, s.y, s.x[::-1]
    terms = np.stack([bracket(x, bracket(y, z)), bracket(y, bracket(z, x)), bracket(z, bracket(x, y))])
    return largest(terms.sum(axis=0)) / (1 + largest(terms))


def _hash(s: GroupSamples) -> float:
    return float(hash(s.group) != hash(s.group))


def _ad(s: GroupSamples) -> float:
    return gap((s.group.ad(s.x) @ s.y[:, :, None])[:, :, 0], s.coordinates(s.commutator(s.x, s.y)))


def _coad(s: GroupSamples) -> float:
    found = np.sum(s.group.coad(s.x, s.p) * s.y, axis=-1)
    return gap(found, np.sum(s.p * s.coordinates(s.commutator(s.x, s.y)), axis=-1))


def _adjoint(s: GroupSamples) -> float:
    return gap((s.group.adjoint(s.g) @ s.y[:, :, None])[:, :, 0], s.conjugated(s.g, s.y))


def _adjoint_of_products(s: GroupSamples) -> float:
    adjoint, h = s.group.adjoint, s.g[::-1]
    return gap(adjoint(s.g @ h), adjoint(s.g) @ adjoint(h))


def _adjoint_of_exp(s: GroupSamples) -> float:
    return gap(s.group.adjoint(s.group.exp(s.x)), scipy.linalg.expm(s.group.ad(s.x)))


def _coadjoint(s: GroupSamples) -> float:
    found = np.sum(s.group.coadjoint(s.g, s.p) * s.y, axis=-1)
    return gap(found, np.sum(s.p * s.conjugated(s.g, s.y), axis=-1))


def _inverse(s: GroupSamples) -> float:
    return gap(s.group.inverse(s.g) @ s.g, np.broadcast_to(s.group.identity, s.g.shape))


def _products(s: GroupSamples) -> float:
    """Multiply elements so near the identity that their product has a logarithm."""
    return largest(s.group.residual(s.element(s.x / 4) @ s.element(s.y / 4)))


def _blindness(s: GroupSamples) -> float:
    """Return the part of a distance from the group that the residual does not see, as distance over residual."""
    normal = scipy.linalg.null_space(s.group.basis.reshape(s.group.dim, -1))
    need(normal.shape[1], "every invertible matrix near the group lies in it")
    away = normal.T.reshape(-1, s.group.size, s.group.size)
    seen = s.group.residual(s.g[0] @ (s.group.identity + _OFF * away))
    return float(np.max(_OFF / np.maximum(seen, np.finfo(float).tiny)))


ALGEBRA = (
    Check("sizes", "basis, identity, exp and poses are float64 arrays of the sizes stated", 0.0, _sizes),
    Check("hash", "the group can be a fixed argument of compiled functions", 0.0, _hash),
    Check("basis", "the basis is linearly independent", 0.0, _basis),
    Check("closure", "brackets of basis matrices lie in their span", 1e-10, _closure),
    Check("hat", "hat(x) = sum x_i E_i", 1e-13, lambda s: gap(s.group.hat(s.x), s.matrix(s.x))),
    Check("vee", "vee(sum x_i E_i) = x", 1e-12, lambda s: gap(s.group.vee(s.matrix(s.x)), s.x)),
    Check("bracket", "hat(bracket(x, y)) = X Y - Y X", 1e-12, _bracket),
    Check("Jacobi", "[x, [y, z]] + [y, [z, x]] + [z, [x, y]] = 0", 1e-12, _jacobi),
    Check("ad", "ad(x) y = [x, y]", 1e-12, _ad),
    Check("coad", "<coad(x, p), y> = <p, [x, y]>", 1e-12, _coad),
    Check("inverse", "inverse(g) g = I", 1e-12, _inverse),
    Check("adjoint", "hat(adjoint(g) x) = g X g^-1", 1e-11, _adjoint),
    Check("adjoint of products", "adjoint(g h) = adjoint(g) adjoint(h)", 1e-11, _adjoint_of_products),
    Check("adjoint of exp", "adjoint(exp(x)) = expm(ad(x))", 1e-11, _adjoint_of_exp),
    Check("coadjoint", "<coadjoint(g, p), x> = <p, adjoint(g) x>", 1e-11, _coadjoint),
    Check("random", "residual(random(rng)) = 0", 1e-11, lambda s: largest(s.group.residual(s.drawn))),
    Check("products", "residual(g h) = 0", 1e-11, _products),
    Check("residual", "distance / residual of matrices off the group is bounded", _BLIND, _blindness),
)
"""In the order of the report; tolerances leave room for a few hundred rounding errors at norms of a few units."""
