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
from nonholo.kernels._small import assign, eliminate, multiply, pair, transpose
from nonholo.kernels.general._rows import add_slopes, pair_twice, put
from nonholo.kernels.lanes import EIGHT

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
        rows: D_i J, with the mass tensor that the equations see, then A_j, side by side, (N^2, R).
        rests: Their remainders, (N^2, R).
        kinds: Ones for rows that pair with X, ones for those that pair with K; factors of slopes with G, (3, R).
        others: Ones but on the diagonal, (8, 8).
        halves: Eight rows, halfway, (N^2, 8).
        slope: The Jacobian, a row for each unknown, (m, R).
        sums: The residual, (1, R).
        terms: The change of the momenta, (1, K).
        order: The equation that is solved for each unknown, (m,).
        inverses: One over its pivot, (m,).
        correction: The last correction, (m,).
        slopes: Jacobians along a path, at its point and further on, and their quotient, (3, m, R).
        charts: What is foretold and found there; where the path leads from both, (4, m).
    """

    G: np.ndarray
    X: np.ndarray
    V: np.ndarray
    H: np.ndarray
    scratch: np.ndarray
    half: np.ndarray
    rows: np.ndarray
    rests: np.ndarray
    kinds: np.ndarray
    others: np.ndarray
    halves: np.ndarray
    slope: np.ndarray
    sums: np.ndarray
    terms: np.ndarray
    order: np.ndarray
    inverses: np.ndarray
    correction: np.ndarray
    slopes: np.ndarray
    charts: np.ndarray


@njit(**COMPILED)
def workspace(p: GeneralBody) -> Workspace:
    """Return a workspace for a body, with the mass tensor of the body."""
    N, m, k, L = len(p.tensor), len(p.stretch), len(p.directions), len(EIGHT)
    R, K = (m + L - 1) // L * L, (k + L - 1) // L * L
    many, rows, kinds = np.zeros((6, N, N)), np.zeros((2, N * N, R)), np.zeros((3, R))
    for i in range(m):
        put(p.pairings[i] if i < k else p.forbidden[i - k], i, rows[0])
        put(p.remainders[i], i, rows[1])
        kinds[0 if i < k else 1, i] = 1.0
        kinds[2, i] = 2.0 if i < k or _turns(p) else 1.0
    others = np.zeros((L, L))
    for i in range(L):
        for j in range(L):
            others[i, j] = i != j
    slopes, charts, halves, order = np.zeros((4, m, R)), np.zeros((6, m)), np.zeros((N * N, L)), np.zeros(m, np.int64)
    matrices = many[0], many[1], many[2], many[3], many[4], many[5], rows[0], rows[1], kinds, others, halves, slopes[3]
    return Workspace(*matrices, np.zeros((1, R)), np.zeros((1, K)), order, charts[4], charts[5], slopes[:3], charts[:4])


@njit(inline="always", **BORROWING)
def _turns(p: GeneralBody) -> bool:
    """Return whether the group has rotations alone, where G^T = (I + Y)^{-1}."""
    return p.size == len(p.tensor) and len(p.form) == 0


@njit(**BORROWING)
def see_tensor(p: GeneralBody, w: Workspace, J: np.ndarray) -> None:
    """Let the equations see a mass tensor."""
    for r in range(len(p.directions)):
        multiply(p.directions[r], J, w.half)
        put(w.half, r, w.rows)


@njit(**INLINED)
def displace(p: GeneralBody, w: Workspace, y: np.ndarray) -> float:
    """Compute X = 2 (I - Y)^{-1} Y and G = I + X / 2; return its turn, the sum of tan^2(angle / 2).

    Beyond `LOST`, where I - Y may be singular to rounding, they are not computed; nor where its determinant is not
    positive, beyond the edge of the chart on groups with boosts.
    """
    small = p.size <= 4 and len(p.form) == 0
    return _displace(p.places, p.entries, p.size, small, y, w.X, w.G, w.scratch)


@njit(**BORROWING)
def _displace(
    places: np.ndarray,
    entries: np.ndarray,
    n: int,
    small: bool,
    y: np.ndarray,
    X: np.ndarray,
    G: np.ndarray,
    Y: np.ndarray,
) -> float:
    Y[:] = 0.0
    for e in range(len(entries)):
        Y[places[e, 1], places[e, 2]] += y[places[e, 0]] * entries[e]
    turning = 0.0
    for i in range(n):
        for j in range(n):
            turning += Y[i, j] ** 2 / 2
    if not (turning < LOST):
        return turning
    if small:
        displace_by_squares(Y, n, turning, X)
    elif not displace_by_elimination(Y, X) > 0:
        return LOST
    for i in range(len(X)):
        for j in range(len(X)):
            G[i, j] = X[i, j] / 2
        G[i, i] += 1.0
    return turning


@njit(**BORROWING)
def displace_by_elimination(Y: np.ndarray, X: np.ndarray) -> float:
    """Write X; return the determinant of I - Y, which takes the place of Y."""
    for i in range(len(X)):
        for j in range(len(X)):
            X[i, j] = 2 * Y[i, j]
            Y[i, j] = -Y[i, j]
        Y[i, i] += 1.0
    return eliminate(Y, X)


@njit(**BORROWING)
def displace_by_squares(Y: np.ndarray, n: int, turning: float, X: np.ndarray) -> None:
    r"""Write X for rotations and motions in up to four dimensions, in closed form.

    With $s = \tfrac12\sum Y_{ij}^2$ and the Pfaffian $-q$ one has $Y^4 + sY^2 + q^2I = 0$ and
    $X = 2(Y + q\tilde Y + Y^2 - q^2I)/(1 + s + q^2)$, where $Y\tilde Y = -qI$; q = 0 in up to three dimensions. The
    translation is 2 v + X v.
    """
    q = Y[2, 1] * Y[0, 3] + Y[0, 2] * Y[1, 3] + Y[1, 0] * Y[2, 3] if n == 4 else 0.0
    factor = 2 / (1 + turning + q * q)
    for i in range(n):
        for j in range(i + 1):
            square = 0.0
            for k in range(n):
                square += Y[i, k] * Y[j, k]
            X[i, j], X[j, i] = factor * (Y[i, j] - square), factor * (Y[j, i] - square)
        X[i, i] -= factor * q * q
    if n == 4:
        for i, j, k in ((2, 1, 0), (0, 2, 1), (1, 0, 2)):
            there, here = factor * q * Y[k, 3], factor * q * Y[i, j]
            X[i, j], X[j, i], X[k, 3], X[3, k] = X[i, j] + there, X[j, i] - there, X[k, 3] + here, X[3, k] - here
    for j in range(n, len(X)):
        for i in range(n):
            total = 2 * Y[i, j]
            for k in range(n):
                total += X[i, k] * Y[k, j]
            X[i, j] = total


@njit(inline="always", **BORROWING)
def _adjoint(p: GeneralBody, X: np.ndarray, half: np.ndarray, out: np.ndarray) -> None:
    """Write X* = G^{-1} X^T G, the transpose where there is no form."""
    transpose(X, out)
    if len(p.form) > 0:
        multiply(p.inverse_form, out, half)
        multiply(half, p.form, out)


@njit(inline="always", **BORROWING)
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


@njit(inline="always", **BORROWING)
def residual(p: GeneralBody, w: Workspace, s: float, m: np.ndarray) -> None:
    """Compute the residual for momenta s m at the displacement in the workspace."""
    k, K = len(p.directions), w.X
    if len(p.stretch) > k:
        skew_part(p, w)
        K = w.scratch
    w.sums[:] = 0.0
    for i in range(k):
        w.sums[0, i] = -s * m[i]
    pair_twice(w.rows, w.rests, w.kinds, p.size, w.X, K, w.sums)


@njit(inline="always", **BORROWING)
def jacobian(p: GeneralBody, w: Workspace) -> None:
    """Compute the Jacobian at the displacement in the workspace, right after its residual.

    The pairing of Q with G C_a G is that of G^T Q G^T with C_a.
    """
    w.slope[:] = 0.0
    add_slopes(w.rows, w.kinds, 2, p.size, w.G, p.places, p.entries, w.halves, w.slope)
    if len(p.stretch) > len(p.directions) and not _turns(p):
        multiply(w.G, w.V, w.H)
        add_slopes(w.rows, w.kinds, 1, p.size, w.H, p.places, p.entries, w.halves, w.slope)


@njit(**INLINED)
def increments(p: GeneralBody, w: Workspace, term: np.ndarray) -> None:
    r"""Compute the change of the scaled momenta in one step, $\mathrm{tr}(X D_i J X^*) = \langle Q_i, X^*X\rangle$.

    Where boosts make X large, $X^*X = -(X + X^*)$ cancels less than the product.
    """
    X, adjoint, square = w.X, w.V, w.scratch
    _adjoint(p, X, w.half, adjoint)
    if len(p.form) > 0 and pair(X, X) > 1.0:
        for i in range(len(X)):
            for j in range(len(X)):
                square[i, j] = -(X[i, j] + adjoint[i, j])
    else:
        multiply(adjoint, X, square)
    w.terms[:] = 0.0
    pair_twice(w.rows, w.rests, w.kinds, p.size, square, square, w.terms)
    assign(term, w.terms[0, : len(term)])
