r"""Potentials: linear in the entries of the pose, $U = \mathrm{tr}(A^Tg)$, such as weights; and springs."""

import abc
import dataclasses
from typing import Any

import numpy as np

from nonholo.base.checks import array, assign, error
from nonholo.base.numerics import applied
from nonholo.base.types import Array, Float
from nonholo.groups import AbstractMatrixGroup
from nonholo.systems._base import AbstractTree, Covectors, Poses


class AbstractLinear(AbstractTree, abc.ABC):
    r"""A potential $U(g) = \mathrm{tr}(A^Tg)$ with a constant matrix A, homogeneous on SE(n)."""

    @abc.abstractmethod
    def matrix_for(self, group: AbstractMatrixGroup) -> Float[Array, "N N"]:
        """Return A for matrices of the group."""

    def energy(self, group: AbstractMatrixGroup, configuration: Poses) -> Float[Array, "..."]:
        """Return U at configurations."""
        return (self.matrix_for(group) * configuration).sum(axis=(-2, -1))

    def covector(self, group: AbstractMatrixGroup, configuration: Poses) -> Covectors:
        """Return -dU along the body directions at configurations."""
        return covector_of(group, self.matrix_for(group), configuration)

    def mean_covector(self, group: AbstractMatrixGroup, g: Poses, W: Poses) -> Covectors:
        r"""Return -G of steps W from poses, $\langle G, x\rangle = \mathrm{tr}(A^Tg(I + Y)x)$: exactly what U loses."""
        return covector_of(group, self.matrix_for(group), leaning(g, W))


@dataclasses.dataclass(frozen=True, eq=False)
class Linear(AbstractLinear):
    r"""The potential $U(g) = \mathrm{tr}(A^Tg) = \sum_{ij}A_{ij}g_{ij}$: a magnet, a field, weights at several points.

    Args:
        matrix: A, (N, N), as large as the matrices of the group: (n + 1, n + 1) on SE(n), whose last column acts on the
            position. A force F at the body point x is $A = -F x^T$, with x = (..., 1) and F = (..., 0) on SE(n).

    Raises:
        ValueError: No square matrix, a value that is not finite.

    Example:
        A magnet along the third body axis in a field along the first axis of space:

        >>> magnet = nh.Linear([[0.0, 0.0, -1.5], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
        >>> needle = nh.Forced(nh.SuslovTop(np.diag([1.0, 1.2, 0.6])), magnet)
        >>> orbit = nh.simulate(nh.discretize(needle, 0.1), body_velocity=(0.2, 0.1, 0.0), steps=1000)
        >>> float(np.ptp(orbit.energy)) < 1e-13
        True
    """

    matrix: Array

    def __post_init__(self) -> None:
        rows = array("Linear(matrix=...)", self.matrix, (None, None), "Pass A, as large as the matrices of the group.")
        assign(self, matrix=rows)

    def check(self, group: AbstractMatrixGroup) -> None:
        """Refuse a group of another size."""
        if self.matrix.shape != (group.size, group.size):
            remedy = f"Pass a matrix {(group.size, group.size)}."
            got = f"shape {self.matrix.shape}"
            raise error("Forced(potential=Linear(...))", f"be as large as matrices of {group}", got, remedy)

    def matrix_for(self, group: AbstractMatrixGroup) -> Float[Array, "N N"]:
        """Return A."""
        del group
        return self.matrix

    def levers(self, group: AbstractMatrixGroup) -> tuple[Float[Array, "N N"], Float[Array, "dim N N"]]:
        """Return vectors F_j and L: -dU is the sum of L_j g^T F_j, over the columns of A."""
        return -self.matrix.T, group.basis.mT


def covector_of(group: AbstractMatrixGroup, A: Array, g: Poses) -> Covectors:
    r"""Return the covectors $-\mathrm{tr}(A^Tg\,x)$ of body directions x at matrices g."""
    xp: Any = g.__array_namespace__()
    return -xp.einsum("...ab,...ac,dcb->...d", xp.asarray(A), g, xp.asarray(group.basis))


def leaning(g: Poses, W: Poses) -> Poses:
    r"""Return $g(I + Y) = 2 g W(I + W)^{-1}$ with the Cayley matrix Y of displacements."""
    xp: Any = W.__array_namespace__()
    return g @ xp.linalg.solve(xp.eye(W.shape[-1]) + W, 2 * W)


def homogeneous(group: AbstractMatrixGroup, vector: Array, last: float) -> Array:
    """Return a vector as matrices of the group take it: on motions with one more number, 1 of points, 0 of forces."""
    if not group.is_affine:
        return vector
    rows = np.eye(len(vector) + 1)
    return vector @ rows[:-1] + last * rows[-1]


def check_point(where: str, group: AbstractMatrixGroup, point: Array) -> None:
    """Refuse a group whose matrices move points of another dimension."""
    if point.shape != (group.point_size,):
        remedy = f"Pass points and forces with {group.point_size} numbers each, or a function of the configuration."
        raise error(where, f"have points of {group}", f"{len(point)} numbers", remedy)


@dataclasses.dataclass(frozen=True, eq=False)
class Gravity(AbstractLinear):
    r"""The potential of a constant spatial force F at the body point x, $U(g) = -F\cdot(g\,x)$.

    Its body covector is exact, $\langle -dU, \xi\rangle = (R^TF)\cdot(\hat\xi\,x)$, R the rotation of g: zero along
    translations across F, the moment $x \times R^TF$ on SO(3). On SO(n) the body turns about the origin of body
    coordinates, on SE(n) that is the reference point; on any other group matrices act on vectors of their size.

    Args:
        force: F, n numbers: m times the acceleration of gravity for a weight.
        point: x, n body coordinates.

    Raises:
        ValueError: Two shapes that differ, a value that is not finite.

    Example:
        >>> heavy = nh.Gravity(force=[0.0, 0.0, -2.0], point=[0.0, 0.0, 0.5])
        >>> float(heavy.energy(nh.SO(3), np.eye(3))), heavy.covector(nh.SO(3), nh.SO(3).exp([0.1, 0.2, 0.0])).round(3)
        (1.0, array([0.099, 0.198, 0.   ]))
    """

    force: Array
    point: Array

    def __post_init__(self) -> None:
        point = array("Gravity(point=...)", self.point, (None,), "Pass the n body coordinates of a point.")
        force = array("Gravity(force=...)", self.force, point.shape, "Pass as many numbers as the point has.")
        assign(self, force=force, point=point)

    def check(self, group: AbstractMatrixGroup) -> None:
        """Refuse a group whose matrices move points of another dimension."""
        check_point("Forced(potential=Gravity(...))", group, self.point)

    def matrix_for(self, group: AbstractMatrixGroup) -> Float[Array, "N N"]:
        """Return -F x^T for matrices of the group."""
        weight, place = self.homogeneous(group)
        return -weight[:, None] * place

    def energy(self, group: AbstractMatrixGroup, configuration: Poses) -> Float[Array, "..."]:
        """Return U at configurations."""
        weight, place = self.homogeneous(group)
        return -applied(weight[None], configuration @ place)[..., 0]

    def covector(self, group: AbstractMatrixGroup, configuration: Poses) -> Covectors:
        """Return -dU along the body directions at configurations."""
        force, levers = self.levers(group)
        return applied(levers, force @ configuration)

    def levers(self, group: AbstractMatrixGroup) -> tuple[Float[Array, "N"], Float[Array, "dim N"]]:
        """Return F and L for matrices of the group, homogeneous on SE(n): -dU is L g^T F."""
        weight, place = self.homogeneous(group)
        return weight, group.basis @ place

    def homogeneous(self, group: AbstractMatrixGroup) -> tuple[Float[Array, "N"], Float[Array, "N"]]:
        """Return F and x as matrices of the group take them."""
        return homogeneous(group, self.force, 0.0), homogeneous(group, self.point, 1.0)


@dataclasses.dataclass(frozen=True, eq=False)
class Spring(AbstractTree):
    r"""The potential of a spring between the body point x and the space point p, $U(g) = \tfrac k2(|gx - p| - L)^2$.

    With a length L it has no direction where $gx = p$: its force is undefined there, and the motion `nonfinite`. Under
    the scheme "energy" its covector of a step between ends at distances $d_0$, $d_1$ is exact:

    $$ \langle G, \xi\rangle = k\Bigl(1 - \frac{2L}{d_0 + d_1}\Bigr)
       \Bigl(\frac{gx + g'x}2 - p\Bigr)\cdot g(I + Y)\xi x. $$

    Args:
        body_point: x, n body coordinates.
        space_point: p, n coordinates in space.
        stiffness: k.
        length: L of the free spring.

    Raises:
        ValueError: Two shapes that differ, a value that is not finite.

    Example:
        >>> spring = nh.Spring(body_point=[0.5, 0.0], space_point=[0.0, 0.0], stiffness=2.0, length=0.1)
        >>> swing = nh.Forced(nh.ChaplyginSleigh(1.0, 1.0, 0.3), spring)
        >>> orbit = nh.simulate(nh.discretize(swing, 0.1), body_velocity=(0.5, 1.0, 0.0), steps=1000)
        >>> float(np.ptp(orbit.energy)) < 1e-12
        True
    """

    body_point: Array
    space_point: Array
    stiffness: Array
    length: Array = 0.0

    def __post_init__(self) -> None:
        x = array("Spring(body_point=...)", self.body_point, (None,), "Pass the n body coordinates of a point.")
        p = array("Spring(space_point=...)", self.space_point, x.shape, "Pass as many numbers as the body point has.")
        assign(self, body_point=x, space_point=p)
        for name in ("stiffness", "length"):
            assign(self, **{name: array(f"Spring({name}=...)", getattr(self, name), (), "Pass a finite number.")})

    def check(self, group: AbstractMatrixGroup) -> None:
        """Refuse a group whose matrices move points of another dimension."""
        check_point("Forced(potential=Spring(...))", group, self.body_point)

    def energy(self, group: AbstractMatrixGroup, configuration: Poses) -> Float[Array, "..."]:
        """Return U at configurations."""
        arm = self._arm(group, configuration)
        xp: Any = arm.__array_namespace__()
        square = (arm * arm).sum(axis=-1)
        is_rough = (square > 0) | (self.length != 0)  # with a length dU is undefined at zero
        size = xp.sqrt(xp.where(is_rough, square, 1.0))
        return self.stiffness / 2 * xp.where(is_rough, (size - self.length) ** 2, square + self.length**2)

    def covector(self, group: AbstractMatrixGroup, configuration: Poses) -> Covectors:
        """Return -dU along the body directions at configurations."""
        arm = self._arm(group, configuration)
        return self._pull(group, arm, 2 * self._size(arm), configuration)

    def mean_covector(self, group: AbstractMatrixGroup, g: Poses, W: Poses) -> Covectors:
        """Return -G of steps W from poses: what U loses, exactly."""
        arm, ahead = self._arm(group, g), self._arm(group, g @ W)
        return self._pull(group, (arm + ahead) / 2, self._size(arm) + self._size(ahead), leaning(g, W))

    def numbers_for(self, group: AbstractMatrixGroup) -> Float[Array, "size"]:
        """Return stiffness, length and both points as matrices of the group take them."""
        x, p = homogeneous(group, self.body_point, 1.0), homogeneous(group, self.space_point, 1.0)
        return np.concatenate([[self.stiffness, self.length], x, p])

    def _arm(self, group: AbstractMatrixGroup, g: Array) -> Array:
        return g @ homogeneous(group, self.body_point, 1.0) - homogeneous(group, self.space_point, 1.0)

    def _size(self, arm: Array) -> Array:
        """Return lengths; that of none has the derivative zero, which is right beside a length L of zero."""
        xp: Any = arm.__array_namespace__()
        square = (arm * arm).sum(axis=-1)
        return xp.where(square > 0, xp.sqrt(xp.where(square > 0, square, 1.0)), 0.0)

    def _pull(self, group: AbstractMatrixGroup, arm: Array, sizes: Array, leaning: Array) -> Array:
        xp: Any = leaning.__array_namespace__()
        is_known = (sizes > 0) | (self.length == 0)  # which way the spring pushes
        stiff = self.stiffness * xp.where(is_known, 1 - 2 * self.length / xp.where(sizes > 0, sizes, 1.0), xp.nan)
        directions = group.basis @ homogeneous(group, self.body_point, 1.0)
        return -stiff[..., None] * xp.einsum("...a,...ab,db->...d", arm, leaning, xp.asarray(directions))
