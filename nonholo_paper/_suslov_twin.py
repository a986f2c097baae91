"""Bodies, displacements and exact steps on which section 6 is evaluated: products of matrices, no formula of the paper.

A displacement of the top of three dimensions is given by a unit vector (q0, q1, q2): the axis is (q1, q2, 0).
"""

import functools
from collections.abc import Callable, Iterator, Sequence

import numpy as np

import nonholo as nh
from nonholo.groups import SO
from nonholo_paper import _twin as twin
from nonholo_paper._twin import Matrix, Number, Vector, ctx

BODIES = {
    "generic": [[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]],
    "four branches": [[1.25, 0, -0.5], [0, 1, -0.75], [-0.5, -0.75, 1.25]],
    "flat": [[0.7, -0.31, 0.01], [-0.31, 1.9, 0.015], [0.01, 0.015, 0.001]],
    "aligned": [[1.4, 0, 0.5], [0, 1, 0], [0.5, 0, 0.9]],
    "tilted rod": [[1.2, 0.4, 0.7], [0.4, 0.18, 0.28], [0.7, 0.28, 0.51]],
    "tilted": [[0.8305, -0.7915, 1.0399], [-0.7915, 0.7589, -0.9956], [1.0399, -0.9956, 1.3066]],
    "balanced": [[1.5, 0.25, 0], [0.25, 0.75, 0], [0, 0, 2]],
    "J1 = J2": [[1.25, 0, 0], [0, 1.25, 0], [0, 0, 0.5]],
}
REGULAR = ("generic", "four branches")
MASSES = [[1.3, 0.4, 2.1], [0.5, 1.75, 0.25], [3, 1, 0]]


def body(name: str) -> Matrix:
    """Return a mass tensor."""
    return ctx.matrix(BODIES[name])


def bodies() -> list[Matrix]:
    """Return all mass tensors."""
    return [body(name) for name in BODIES]


def random_body(seed: int, n: int) -> Matrix:
    """Return a random positive definite mass tensor."""
    X = ctx.matrix(n)
    for k, x in enumerate(twin.numbers(seed, n * n)):
        X[k // n, k % n] = x
    return X * X.T


def array(X: Matrix) -> np.ndarray:
    """Return an exact real matrix in double precision."""
    return np.array(X.tolist(), dtype=np.float64)


def discrete(J: Matrix) -> nh.Discretization:
    """Return the library's top with step 1."""
    return nh.discretize(nh.SuslovTop(array(J)), 1.0)


def unit(values: Sequence[Number]) -> Vector:
    """Return a vector of length one."""
    length = ctx.sqrt(ctx.fsum(ctx.mpf(x) ** 2 for x in values))
    return [x / length for x in values]


def points() -> list[Vector]:
    """Return displacements: generic ones, tiny and zero ones, half-turns, nearly half-turns, and axes e1, e2."""
    generic = [twin.numbers(seed, 3) for seed in range(6)]
    nasty = [[1, 0, 0], [1, 1e-20, -2e-20], [0, 0.6, 0.8], [1e-20, 1, -0.5], [0.3, 0.7, 0], [0.9, 0, -0.2]]
    return [unit([abs(q0), q1, q2]) for q0, q1, q2 in generic + nasty]


def rotation(q: Sequence[Number]) -> Matrix:
    """Return the rotation about (q1, q2, 0) by the angle whose half has the cosine q0: a matrix exponential."""
    sine = ctx.hypot(q[1], q[2])
    if sine == 0:
        return ctx.eye(3)
    return twin.exp(twin.hat(SO(3), [2 * ctx.atan2(sine, q[0]) * x / sine for x in (q[1], q[2], 0)]))


@functools.cache
def turns() -> list[tuple[Vector, Matrix]]:
    """Return the displacements with their matrices."""
    return [(q, rotation(q)) for q in points()]


def samples() -> Iterator[tuple[Matrix, Vector, Matrix]]:
    """Return each body with each displacement."""
    return ((J, q, W) for J in bodies() for q, W in turns())


def wedge(u: Sequence[Number]) -> Matrix:
    """Return the generator of the rotation from e_n to u, u below n."""
    n = len(u) + 1
    X = ctx.zeros(n)
    for i, x in enumerate(u):
        X[i, n - 1], X[n - 1, i] = x, -x
    return X


def attitude(seed: int, n: int) -> Matrix:
    """Return a random rotation."""
    return twin.exp(twin.hat(SO(n), twin.numbers(seed, SO(n).dim, -2, 2)))


def momentum(J: Matrix, W: Matrix) -> Vector:
    """Return the coordinates of W J - J W^T."""
    return twin.vee(SO(W.rows), W * J - J * W.T)


def turned(J: Matrix, W: Matrix) -> Vector:
    """Return the coordinates of W^T (W J - J W^T) W."""
    return twin.vee(SO(W.rows), W.T * (W * J - J * W.T) * W)


def reduced_energy(J: Matrix, M: Sequence[Number]) -> Number:
    """Return half of the energy of an admissible velocity with these momenta along the constraint."""
    inertia = twin.trace(J) * ctx.eye(3) - J
    velocity = inertia[:2, :2] ** -1 * ctx.matrix(list(M[:2]))
    return (M[0] * velocity[0] + M[1] * velocity[1]) / 4


def energy(J: Matrix, q: Sequence[Number]) -> Number:
    """Return the reduced energy of a displacement."""
    return reduced_energy(J, momentum(J, rotation(q)))


def cayley(y: Sequence[Number]) -> Matrix:
    """Return the displacement with half-angle tangents y, complex ones too."""
    Y = wedge(y)
    one = ctx.eye(Y.rows)
    return (one - Y) ** -1 * (one + Y)


def point_of(y: Sequence[Number]) -> Vector:
    """Return (q0, q1, q2) of half-angle tangents."""
    q0 = 1 / ctx.sqrt(1 + y[0] * y[0] + y[1] * y[1])
    return [q0, -q0 * y[1], q0 * y[0]]


def refined(J: Matrix, target: Sequence[Number], y: Sequence[complex]) -> Vector:
    """Return the tangents near y of the displacement whose momentum along the constraint is given, in 50 digits."""

    def missed(a: Number, b: Number) -> Vector:
        M = momentum(J, cayley([a, b]))
        return [M[0] - target[0], M[1] - target[1]]

    start = [ctx.mpf(v.real) if v.imag == 0 else ctx.mpc(v) for v in y]
    return list(ctx.findroot(missed, start, tol=1e-90, maxsteps=12, verify=False))


@functools.cache
def successors(name: str, y: tuple[float, float]) -> list[Vector]:
    """Return the tangents of all values of the map after y: the library's, refined in 50 digits; real ones first."""
    J = body(name)
    result = nh.branches(discrete(J), displacement=array(cayley(y)))
    starts = [(W[:2, 2] / (1 + W[2, 2]), real) for W, real in zip(result.displacement, result.is_real, strict=True)]
    return [refined(J, turned(J, cayley(y)), [complex(v.real, 0 if real else v.imag) for v in s]) for s, real in starts]


STEPS = [("generic", (0.3, 0.4)), ("generic", (-0.7, 0.55)), ("four branches", (-0.25, -0.375))]


def slope(curve: Callable[[Number], Matrix]) -> Matrix:
    """Return the derivative of a curve of matrices at 0: a difference quotient with 110 digits."""
    with ctx.workdps(110):
        small = ctx.mpf(10) ** -40
        return (curve(small) - curve(-small)) / (2 * small)


def lacking(*facts: bool) -> float:
    """Return how many facts do not hold: the defect of a statement that is not an equation."""
    return float(sum(not fact for fact in facts))
