"""Bodies and displacements for statements about any group: the same numbers at 50 digits and in the library."""

import dataclasses
import functools
from collections.abc import Callable

import numpy as np

from nonholo.groups import SE, SO, AbstractMatrixGroup
from nonholo.systems import LLSystem
from nonholo_paper import _twin as twin
from nonholo_paper._twin import Matrix, Number, ctx

Rows = tuple[tuple[float, ...], ...]


@dataclasses.dataclass(frozen=True)
class Body:
    """A body on a matrix group whose velocity lies in a subspace; all numbers are short binary fractions.

    Attributes:
        group: SO(n) or SE(2).
        mass_tensor: Homogeneous on SE(2).
        subspace: Rows span the admissible velocities.
        annihilator: Rows vanish on them.
    """

    group: AbstractMatrixGroup
    mass_tensor: Rows
    subspace: Rows
    annihilator: Rows

    @functools.cached_property
    def system(self) -> LLSystem:
        """The body as a system of the library."""
        return LLSystem(self.group, self.mass_tensor, self.subspace, annihilator=self.annihilator)

    @functools.cached_property
    def tensor(self) -> Matrix:
        """The mass tensor."""
        return ctx.matrix(self.mass_tensor)

    @functools.cached_property
    def inertia(self) -> Matrix:
        """The inertia operator by its definition, twice the kinetic energy as a bilinear form."""
        basis = twin.basis(self.group)
        return ctx.matrix([[twin.inner(E * self.tensor, F) for F in basis] for E in basis])

    @functools.cached_property
    def forms(self) -> list[Matrix]:
        """The annihilator as columns."""
        return [twin.column(row) for row in self.annihilator]

    @functools.cached_property
    def directions(self) -> list[Matrix]:
        """The basis of the subspace as columns."""
        return [twin.column(row) for row in self.subspace]

    def lagrangian(self, W: Matrix) -> Number:
        """Return the discrete Lagrangian of X = W - I, tr(X J X^T)/2."""
        X = W - ctx.eye(W.rows)
        return twin.inner(X * self.tensor, X) / 2

    def restrict(self, p: Matrix) -> Matrix:
        """Return the values of a covector on the basis of the subspace."""
        return twin.column([twin.dot(p, e) for e in self.directions])

    def restricted_inertia(self) -> Matrix:
        """Return the inertia operator in the basis of the subspace."""
        return ctx.matrix([[twin.dot(e, self.inertia * f) for f in self.directions] for e in self.directions])

    def velocity(self, coefficients: list) -> Matrix:
        """Return an admissible velocity."""
        pairs = zip(coefficients, self.directions, strict=True)
        return sum((ctx.convert(c) * e for c, e in pairs), ctx.zeros(self.group.dim, 1))

    def displacement(self, velocity: Matrix) -> Matrix:
        """Return the exponential of a velocity."""
        return twin.exp(twin.hat(self.group, list(velocity)))

    def momentum(self, W: Matrix) -> Matrix:
        """Return the discrete momentum of a displacement by its definition, the derivatives of l_d(exp(e E) W)."""
        return slopes(lambda nudge: self.lagrangian(nudge * W), self.group)

    def arriving(self, W: Matrix) -> Matrix:
        """Return the momentum that arrives at the end of a displacement, the derivatives of l_d(W exp(e E))."""
        return slopes(lambda nudge: self.lagrangian(W * nudge), self.group)


def slopes(value: Callable[[Matrix], Number], group: AbstractMatrixGroup) -> Matrix:
    """Return the derivatives of a function of exp(e E) at e = 0, for the basis E, as `_twin.rate` does."""
    digits = ctx.dps
    with ctx.workdps(3 * digits):
        step = 2 * ctx.mpf(10) ** -digits
        return ctx.matrix([(value(forth) - value(back)) / step for forth, back in _nudges(group, digits)])


@functools.cache
def _nudges(group: AbstractMatrixGroup, digits: int) -> list[tuple[Matrix, Matrix]]:
    with ctx.workdps(3 * digits):
        h = ctx.mpf(10) ** -digits
        return [(twin.exp(h * E), twin.exp(-h * E)) for E in twin.basis(group)]


TOP = Body(
    SO(3),
    ((1.5, 0.25, 0.5), (0.25, 1.0, -0.25), (0.5, -0.25, 1.25)),
    ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0)),
    ((0.0, 0.0, 1.0),),
)
"""An unbalanced Suslov top."""
TILTED_TOP = Body(SO(3), TOP.mass_tensor, ((1.0, 0.0, 0.5), (0.0, 1.0, -0.25)), ((-0.5, 0.25, 1.0),))
"""The same top with another forbidden axis."""
BALANCED_TOP = Body(SO(3), ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 0.5)), TOP.subspace, TOP.annihilator)
"""A top with c = 0 and J1 = J2."""
SLEIGH = Body(
    SE(2),
    ((1.25, -0.125, 1.0), (-0.125, 0.625, -0.5), (1.0, -0.5, 2.0)),
    ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0)),
    ((0.0, 0.0, 1.0),),
)
"""A sleigh of mass 2 with its center of mass at (1/2, -1/4)."""
BALANCED_SLEIGH = Body(
    SE(2), ((0.75, 0.0, 0.0), (0.0, 0.625, -0.5), (0.0, -0.5, 2.0)), SLEIGH.subspace, SLEIGH.annihilator
)
"""A sleigh with a = 0."""
_TENSOR_4 = ((1.5, 0.25, 0.0, 0.5), (0.25, 1.0, -0.25, 0.25), (0.0, -0.25, 2.0, -0.5), (0.5, 0.25, -0.5, 1.25))
TOP_4 = Body(
    SO(4),
    _TENSOR_4,
    tuple(tuple(float(i == j) for j in range(6)) for i in (2, 4, 5)),
    tuple(tuple(float(i == j) for j in range(6)) for i in (0, 1, 3)),
)
"""A Suslov top in four dimensions."""
ANY_4 = Body(
    SO(4),
    _TENSOR_4,
    ((1.0, 0.0, 0.0, 0.5, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0, 0.25, -0.5)),
    (
        (0.0, 0.0, 1.0, 0.0, 0.0, 0.0),
        (-0.5, 0.0, 0.0, 1.0, 0.0, 0.0),
        (0.0, -0.25, 0.0, 0.0, 1.0, 0.0),
        (0.0, 0.5, 0.0, 0.0, 0.0, 1.0),
    ),
)
"""Two admissible directions in so(4) that belong to no symmetric pair."""

SMALL = (TOP, TILTED_TOP, SLEIGH)
BODIES = (TOP, TILTED_TOP, BALANCED_TOP, SLEIGH, BALANCED_SLEIGH, TOP_4, ANY_4)


def pose(body: Body, seed: int = 3) -> Matrix:
    """Return a random group element."""
    return twin.exp(twin.hat(body.group, twin.numbers(seed, body.group.dim, -2, 2)))


def any_velocity(body: Body) -> Matrix:
    """Return a random velocity, admissible or not."""
    return twin.column(twin.numbers(5, body.group.dim, -2, 2))


def admissible(body: Body) -> Matrix:
    """Return a random admissible velocity."""
    return body.velocity(twin.numbers(6, len(body.subspace), -2, 2))


def velocities(body: Body) -> list[Matrix]:
    """Return admissible velocities: zero, small, of size one, of half a turn and more."""
    k = len(body.subspace)
    sizes = (0.0, 2.0**-20, 0.75, 3.0, 4.0)
    return [body.velocity([size * c for c in twin.numbers(7 + i, k)]) for i, size in enumerate(sizes)]


def displacements(body: Body) -> list[Matrix]:
    """Return admissible displacements, from none to more than half a turn."""
    return [body.displacement(velocity) for velocity in velocities(body)]


def in_double(matrix: Matrix) -> np.ndarray:
    """Return a matrix, or a column as a vector, rounded to double precision."""
    rounded = np.array(matrix.tolist(), dtype=float)
    return rounded[:, 0] if rounded.shape[1] == 1 else rounded


def apart(library: np.ndarray, exact: Matrix) -> float:
    """Return the distance of a result of the library from a matrix or column."""
    return float(np.abs(np.asarray(library) - in_double(exact)).max(initial=0.0))
