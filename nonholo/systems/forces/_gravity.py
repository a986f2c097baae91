r"""A constant force in space that acts at a point of the body, such as the weight at the center of mass."""

import dataclasses
from typing import ClassVar

from nonholo.base.checks import array
from nonholo.base.numerics import applied
from nonholo.base.types import Array, Float
from nonholo.groups import AbstractMatrixGroup
from nonholo.systems.forces._linear import AbstractLinear, check_point, homogeneous


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
    leaves: ClassVar[tuple[str, ...]] = ("force", "point")
    structure: ClassVar[tuple[str, ...]] = ()

    def __post_init__(self) -> None:
        point = array("Gravity(point=...)", self.point, (None,), "Pass the n body coordinates of a point.")
        force = array("Gravity(force=...)", self.force, point.shape, "Pass as many numbers as the point has.")
        object.__setattr__(self, "force", force)
        object.__setattr__(self, "point", point)

    def check(self, group: AbstractMatrixGroup) -> None:
        """Refuse a group whose matrices move points of another dimension."""
        check_point("Forced(potential=Gravity(...))", group, self.point)

    def matrix_for(self, group: AbstractMatrixGroup) -> Float[Array, "N N"]:
        """Return -F x^T for matrices of the group."""
        weight, place = self.homogeneous(group)
        return -weight[:, None] * place

    def energy(self, group: AbstractMatrixGroup, configuration: Float[Array, "... N N"]) -> Float[Array, "..."]:
        """Return U at configurations."""
        weight, place = self.homogeneous(group)
        return -applied(weight[None], configuration @ place)[..., 0]

    def covector(self, group: AbstractMatrixGroup, configuration: Float[Array, "... N N"]) -> Float[Array, "... dim"]:
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
