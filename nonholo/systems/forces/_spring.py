r"""A spring between a point of the body and a point of space."""

import dataclasses
from typing import Any, ClassVar

import numpy as np

from nonholo.base.checks import array
from nonholo.base.types import Array, Float
from nonholo.groups import AbstractMatrixGroup
from nonholo.systems.forces._linear import check_point, homogeneous, leaning


@dataclasses.dataclass(frozen=True, eq=False)
class Spring:
    r"""The potential of a spring between the body point x and the space point p, $U(g) = \tfrac k2(|gx - p| - L)^2$.

    Under the scheme "energy" its covector of a step between ends at distances $d_0$, $d_1$ is exact:
    $\langle G, \xi\rangle = k\bigl(1 - \tfrac{2L}{d_0 + d_1}\bigr)\bigl(\tfrac{gx + g'x}2 - p\bigr)\cdot g(I + Y)\xi x$.

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
    leaves: ClassVar[tuple[str, ...]] = ("body_point", "space_point", "stiffness", "length")
    structure: ClassVar[tuple[str, ...]] = ()

    def __post_init__(self) -> None:
        x = array("Spring(body_point=...)", self.body_point, (None,), "Pass the n body coordinates of a point.")
        p = array("Spring(space_point=...)", self.space_point, x.shape, "Pass as many numbers as the body point has.")
        given = {"body_point": x, "space_point": p}
        for name in ("stiffness", "length"):
            given[name] = array(f"Spring({name}=...)", getattr(self, name), (), "Pass a finite number.")
        for name, value in given.items():
            object.__setattr__(self, name, value)

    def check(self, group: AbstractMatrixGroup) -> None:
        """Refuse a group whose matrices move points of another dimension."""
        check_point("Forced(potential=Spring(...))", group, self.body_point)

    def energy(self, group: AbstractMatrixGroup, configuration: Float[Array, "... N N"]) -> Float[Array, "..."]:
        """Return U at configurations."""
        return self.stiffness * (self._size(self._arm(group, configuration)) - self.length) ** 2 / 2

    def covector(self, group: AbstractMatrixGroup, configuration: Float[Array, "... N N"]) -> Float[Array, "... dim"]:
        """Return -dU along the body directions at configurations."""
        arm = self._arm(group, configuration)
        return self._pulled(group, arm, 2 * self._size(arm), configuration)

    def mean_covector(
        self, group: AbstractMatrixGroup, g: Float[Array, "... N N"], W: Float[Array, "... N N"]
    ) -> Float[Array, "... dim"]:
        """Return -G of steps W from poses: what U loses, exactly."""
        arm, ahead = self._arm(group, g), self._arm(group, g @ W)
        return self._pulled(group, (arm + ahead) / 2, self._size(arm) + self._size(ahead), leaning(g, W))

    def numbers_for(self, group: AbstractMatrixGroup) -> Float[Array, "size"]:
        """Return stiffness, length and both points as matrices of the group take them."""
        x, p = homogeneous(group, self.body_point, 1.0), homogeneous(group, self.space_point, 1.0)
        return np.concatenate([[self.stiffness, self.length], x, p])

    def _arm(self, group: AbstractMatrixGroup, g: Array) -> Array:
        return g @ homogeneous(group, self.body_point, 1.0) - homogeneous(group, self.space_point, 1.0)

    def _size(self, arm: Array) -> Array:
        xp: Any = arm.__array_namespace__()
        return xp.sqrt((arm * arm).sum(axis=-1))

    def _pulled(self, group: AbstractMatrixGroup, arm: Array, sizes: Array, leaning: Array) -> Array:
        xp: Any = leaning.__array_namespace__()
        stiff = self.stiffness * (1 - 2 * self.length / sizes)
        moved = group.basis @ homogeneous(group, self.body_point, 1.0)
        return -stiff[..., None] * xp.einsum("...a,...ab,db->...d", arm, leaning, xp.asarray(moved))
