r"""The step for any invariant constraint on SO(n), SE(n) and groups of a form, straight from its matrix equations.

The displacement is $W = I + X = (I - Y)^{-1}(I + Y)$, $Y = \sum_a y_a C_a$. Unknowns are its m Cayley coordinates,
equations

$$ \mathrm{tr}(D_i W J X^T) = \mathrm{tr}(D_i J X^T) = m_i \ (i \le k), \qquad
   \langle A_j, \tfrac12 (W - W^{-1})\rangle = 0, $$

where $\mathrm{tr}(D X J X^T) = 0$ since $XJX^T$ is symmetric and has no homogeneous part. The derivatives of X are
$2GC_aG$, $G = (I - Y)^{-1}$. Here $D_i$ is a basis of $\mathfrak{d}$, momenta are in units of displacements,
$m = h r/(\mu\ell^2)$, all lengths in units of a length $\ell$ and masses of a mass $\mu$ of the body, so that
translations, rotations and momenta are numbers of one size. Where $\exp\mathfrak{d}$ solves the constraint, the $C_a$
are the $D_i$ and there is no second kind; otherwise the $C_a$ span the algebra. With `spatial` the constraint is
right-invariant: the pose carries J to
space, and m is constant. On the group of a form G the transpose is $X^* = G^{-1}X^TG$: the kernel is given $GD_i$ and
$JG^{-1}$, so that $Q_i = GD_iJG^{-1}$ has the same pairings.
"""

from typing import NamedTuple

import numpy as np

from nonholo.base.compiled import njit
from nonholo.kernels._scalar import BORROWING, COMPILED, INLINED
from nonholo.kernels._small import eliminate, multiply, paired, paired_twice, sandwich, transpose

LOST = 1e12  # turning of a displacement of an iteration that runs away


class GeneralBody(NamedTuple):
    """Matrices of a body and its constraint.

    Attributes:
        tensor: Mass tensor, (N, N); J G^-1 with a form.
        directions: D_i, (k, N, N); G D_i with a form.
        places: Index a, row and column of the entries of C_a that are not zero, (E, 3).
        entries: Their values, (E,).
        forbidden: A_j, (m - k, N, N); the pairing is the sum of products of entries.
        pairings: D_i J, (k, N, N).
        remainders: What rounding took off each D_i J and then each A_j, (m, N, N).
        size: n, the size of the rotations.
        spatial: Whether the constraint is right-invariant.
        metric: Inverse of the constrained inertia, (k, k).
        radius: Squared radius of the ball in which a root is certainly principal, in the metric of the energy.
        level: Largest squared norm of scaled momenta for which it is.
        unit: The length l; poses are in the unit of the user's.
        stretch: Factors from the coordinates y of this kernel to those of the caller, (m,).
        form: G, (N, N); (0, 0) on SO(n) and SE(n).
        inverse_form: Its inverse, of the same shape.
    """

    tensor: np.ndarray
    directions: np.ndarray
    places: np.ndarray
    entries: np.ndarray
    forbidden: np.ndarray
    pairings: np.ndarray
    remainders: np.ndarray
    size: int
    spatial: bool
    metric: np.ndarray
    radius: float
    level: float
    unit: float
    stretch: np.ndarray
    form: np.ndarray
    inverse_form: np.ndarray


class Workspace(NamedTuple):
    """Matrices that the functions below write to, made once for a run.

    Attributes:
        G: (I - Y)^{-1}.
        X: W - I.
        V: The inverse of W, or scratch.
        H: (I + Y)^{-1}, or scratch.
        scratch: One more.
        half: Another.
        Q: D_i J, (k, N, N), with the mass tensor that the equations see.
        slope: The Jacobian, (m, m).
        residual: The residual, then the correction, (m, 1).
        slopes: Jacobians along a path, at its point and further on, and their quotient, (3, m, m).
        charts: What is foretold and found there; where the path leads from both, (4, m).
    """

    G: np.ndarray
    X: np.ndarray
    V: np.ndarray
    H: np.ndarray
    scratch: np.ndarray
    half: np.ndarray
    Q: np.ndarray
    slope: np.ndarray
    residual: np.ndarray
    slopes: np.ndarray
    charts: np.ndarray


@njit(**COMPILED)
def workspace(p: GeneralBody) -> Workspace:
    """Return a workspace for a body, with the mass tensor of the body."""
    N, m = len(p.tensor), len(p.stretch)
    many = np.zeros((6, N, N))
    return Workspace(
        many[0],
        many[1],
        many[2],
        many[3],
        many[4],
        many[5],
        p.pairings.copy(),
        np.zeros((m, m)),
        np.zeros((m, 1)),
        np.zeros((3, m, m)),
        np.zeros((4, m)),
    )


@njit(**BORROWING)
def see_tensor(p: GeneralBody, w: Workspace, J: np.ndarray) -> None:
    """Let the equations see a mass tensor."""
    for i in range(len(p.directions)):
        multiply(p.directions[i], J, w.Q[i])


@njit(**INLINED)
def displaced(p: GeneralBody, w: Workspace, y: np.ndarray) -> float:
    """Compute X = 2 (I - Y)^{-1} Y and G = I + X / 2; return how far it turns, the sum of tan^2(angle / 2).

    Beyond `LOST`, where I - Y may be singular to rounding, they are not computed; nor where its determinant is not
    positive, beyond the edge of the chart on groups with boosts.
    """
    return _displaced(p.places, p.entries, p.size, y, w.X, w.G, w.scratch)


@njit(**BORROWING)
def _displaced(
    places: np.ndarray, entries: np.ndarray, n: int, y: np.ndarray, X: np.ndarray, G: np.ndarray, scratch: np.ndarray
) -> float:
    X[:] = 0.0
    for e in range(len(entries)):
        X[places[e, 1], places[e, 2]] += 2 * y[places[e, 0]] * entries[e]
    turning = 0.0
    for i in range(len(X)):
        for j in range(len(X)):
            if i < n and j < n:
                turning += X[i, j] ** 2 / 8
            scratch[i, j] = -X[i, j] / 2
        scratch[i, i] += 1.0
    if not (turning < LOST):
        return turning
    if not eliminate(scratch, X) > 0:
        return LOST
    for i in range(len(X)):
        for j in range(len(X)):
            G[i, j] = X[i, j] / 2
        G[i, i] += 1.0
    return turning


@njit(**INLINED)
def _adjoint(p: GeneralBody, X: np.ndarray, half: np.ndarray, out: np.ndarray) -> None:
    """Write X* = G^{-1} X^T G, the transpose where there is no form."""
    transpose(X, out)
    if len(p.form) > 0:
        multiply(p.inverse_form, out, half)
        multiply(half, p.form, out)


@njit(**INLINED)
def _invert(p: GeneralBody, X: np.ndarray, half: np.ndarray, V: np.ndarray) -> None:
    """Write the inverse of the group element I + X."""
    n = p.size
    _adjoint(p, X, half, V)
    for i in range(len(X)):
        V[i, i] += 1.0
    if n < len(X):
        for i in range(n):
            V[n, i] = 0.0
            V[i, n] = -X[i, n]
            for j in range(n):
                V[i, n] -= X[j, i] * X[j, n]


@njit(**INLINED)
def skew_part(p: GeneralBody, w: Workspace) -> None:
    """Write K = (W - W^{-1})/2 to the scratch matrix, and W^{-1} to V."""
    X, V, K = w.X, w.V, w.scratch
    _invert(p, X, w.half, V)
    for i in range(len(X)):
        for j in range(len(X)):
            K[i, j] = (X[i, j] - V[i, j]) / 2
        K[i, i] += 0.5


@njit(**INLINED)
def _pair_with_chart(S: np.ndarray, factor: float, places: np.ndarray, entries: np.ndarray, row: np.ndarray) -> None:
    """Add the pairings of a matrix with each C_a, times a factor, to a row."""
    for e in range(len(entries)):
        row[places[e, 0]] += factor * S[places[e, 1], places[e, 2]] * entries[e]


@njit(**INLINED)
def equations(p: GeneralBody, w: Workspace, s: float, m: np.ndarray) -> None:
    """Compute the residual for momenta s m and its Jacobian at the displacement in the workspace.

    The pairing of Q with G C_a G is that of G^T Q G^T with C_a.
    """
    k, unknowns, places, entries = len(p.directions), len(p.stretch), p.places, p.entries
    G, X, Q, half, scratch, slope, residual = w.G, w.X, w.Q, w.half, w.scratch, w.slope, w.residual
    slope[:] = 0.0
    if unknowns > k:
        H, A = w.H, p.forbidden
        skew_part(p, w)
        for j in range(k, unknowns):
            residual[j, 0] = paired_twice(A[j - k], p.remainders[j], scratch, 0.0)
        multiply(G, w.V, H)
        for j in range(k, unknowns):
            sandwich(G, A[j - k], half, scratch)
            _pair_with_chart(scratch, 1.0, places, entries, slope[j])
            sandwich(H, A[j - k], half, scratch)
            _pair_with_chart(scratch, 1.0, places, entries, slope[j])
    for i in range(k):
        residual[i, 0] = paired_twice(Q[i], p.remainders[i], X, s * m[i])
        sandwich(G, Q[i], half, scratch)
        _pair_with_chart(scratch, 2.0, places, entries, slope[i])


@njit(**INLINED)
def increments(p: GeneralBody, w: Workspace, term: np.ndarray) -> None:
    r"""Compute the change of the scaled momenta in one step, $\mathrm{tr}(X D_i J X^*) = \langle Q_i, X^*X\rangle$.

    Where boosts make X large, $X^*X = -(X + X^*)$ cancels less than the product.
    """
    X, transposed, square, Q = w.X, w.V, w.scratch, w.Q
    _adjoint(p, X, w.half, transposed)
    if len(p.form) > 0 and paired(X, X) > 1.0:
        for i in range(len(X)):
            for j in range(len(X)):
                square[i, j] = -(X[i, j] + transposed[i, j])
    else:
        multiply(transposed, X, square)
    for i in range(len(Q)):
        term[i] = paired_twice(Q[i], p.remainders[i], square, 0.0)
