r"""The continuous motion in matrices under a constraint fixed in space: rates of pose and, in the plane, heading.

With matrices of the group's algebra and the pairing $\langle P, X\rangle = \sum_{ab} P_{ab}X_{ab}$ the momenta r along
the $D_i$ are constant,

$$ \sum_j \mathrm{tr}(D_i\,g\mathbb{J}g^T D_j^*)\,w_j = r_i, \qquad g' = X g, \quad X = \sum_j w_j D_j . $$
"""

from typing import NamedTuple

import numpy as np

from nonholo.base.compiled import njit
from nonholo.kernels._dop853 import RATES
from nonholo.kernels._scalar import COMPILED
from nonholo.kernels._small import eliminate, multiply, paired, transpose


class SpaceFlow(NamedTuple):
    """A constraint fixed in space; the state is (g row by row, heading if planar).

    Attributes:
        momentum: r, (k,).
        rows: D_i, (k, N, N).
        duals: The transposes of D_i^*, (k, N, N).
        tensor: J, (N, N).
        planar: Whether the state ends with a heading.
    """

    momentum: np.ndarray
    rows: np.ndarray
    duals: np.ndarray
    tensor: np.ndarray
    planar: bool


@njit(**COMPILED)
def space_rate(p: SpaceFlow, time: float, state: np.ndarray, out: np.ndarray) -> None:
    """Write the rate of a motion with a constraint fixed in space."""
    k, N = len(p.rows), p.rows.shape[1]
    g = state[: N * N].copy().reshape(N, N)
    seen, across, half = np.empty((N, N)), np.empty((N, N)), np.empty((N, N))
    transpose(g, across)
    multiply(g, p.tensor, half)
    multiply(half, across, seen)
    inertia, w = np.empty((k, k)), p.momentum.copy().reshape(k, 1)
    for i in range(k):
        multiply(p.rows[i], seen, half)
        for j in range(k):
            inertia[i, j] = paired(half, p.duals[j])
    eliminate(inertia, w)
    X = np.zeros((N, N))
    add_combination(p.rows, w[:, 0].copy(), X)
    multiply(X, g, out[: N * N].reshape(N, N))
    if p.planar:
        out[N * N] = X[1, 0]


@njit()
def add_combination(matrices: np.ndarray, weights: np.ndarray, total: np.ndarray) -> None:
    """Add matrices times the first of some weights."""
    for k in range(len(matrices)):
        for i in range(total.shape[0]):
            for j in range(total.shape[1]):
                total[i, j] += weights[k] * matrices[k, i, j]


RATES[SpaceFlow] = space_rate
