"""The free rigid body: no constraint at all."""

import dataclasses
from typing import ClassVar

import numpy as np

from nonholo.base.checks import positive_definite
from nonholo.base.memo import system_memo
from nonholo.base.types import Array, Float
from nonholo.groups import SO, AbstractMatrixGroup
from nonholo.systems._base import AbstractLLSystem, unchecked
from nonholo.systems._body import lines_of, mass_tensor_of_body, tensors_shown
from nonholo.systems._mass import body_tensor, checked_group, group_mass_tensor


@dataclasses.dataclass(frozen=True, repr=False, eq=False)
class RigidBody(AbstractLLSystem):
    r"""A free body on SO(n) (the top of Euler; discretized, of Moser and Veselov) or on SE(n).

    $$ l(\omega) = \tfrac12\mathrm{tr}(\hat\omega\,\mathbb{J}\,\hat\omega^T), \qquad \mathfrak{d} = \mathfrak{g},
       \qquad \dot p = \mathrm{ad}^*_\omega p; $$

    every component of the spatial momentum is conserved.

    Reference: [fedorov-zenkov-2004], section 4, whose discrete free top is that of [moser-veselov-1991].

    Args:
        mass_tensor: Symmetric: (n, n), n >= 3, on SO(n), homogeneous (n + 1, n + 1) on SE(n). For n = 3 it is not the
            inertia tensor $\mathrm{tr}(J)\,\mathrm{Id} - J$: `from_inertia` takes that one.
        group: SO(n), by default, or SE(n).

    Raises:
        ValueError: A shape, an asymmetry, a value that is not finite, an inertia that is not positive definite,
            another group.

    Example:
        >>> from nonholo.systems import RigidBody
        >>> RigidBody(np.diag([1.0, 2.0, 3.0])).inertia_operator.diagonal()
        array([5., 4., 3.])
    """

    mass_tensor: Array
    group: Array = None
    leaves: ClassVar[tuple[str, ...]] = ("mass_tensor",)
    structure: ClassVar[tuple[str, ...]] = ("group",)
    stacked = unchecked

    def __post_init__(self) -> None:
        where = "RigidBody(mass_tensor=...)"
        remedy = "Pass the mass tensor J; `RigidBody.from_inertia` takes the inertia tensor."
        if self.group is None:
            tensor = body_tensor(where, self.mass_tensor, remedy)
            object.__setattr__(self, "group", SO(tensor.shape[0]))
        else:
            checked_group("RigidBody(group=...)", self.group)
            instead = "`LLSystem` takes an inertia operator on any group."
            tensor = group_mass_tensor(where, self.group, self.mass_tensor, instead)
        object.__setattr__(self, "mass_tensor", tensor)
        positive_definite(where, self.inertia_operator, "the inertia operator", remedy)

    @classmethod
    def from_inertia(
        cls, mass: Array, inertia: Array, center_of_mass: Array, group: AbstractMatrixGroup
    ) -> "RigidBody":
        """Build a body from its mass, its inertia about the center of mass, and where that is in the body.

        On SO(3) the body turns about the origin of body coordinates, to which Steiner's theorem carries the inertia; on
        SE(n) the origin is the reference point. An `ImpossibleBodyWarning` says so if no body has the inertia.

        Args:
            mass: m.
            inertia: About the center of mass: a number in the plane, the inertia tensor (3, 3) in space (not the mass
                tensor).
            center_of_mass: n body coordinates, from the origin.
            group: SO(2), SO(3), SE(2) or SE(3). In more dimensions an inertia tensor is none of a body: pass the mass
                tensor to the class itself.

        Raises:
            ValueError: Another group, a mass or moment that is not positive, a wrong shape; and as for the class.

        Example:
            >>> RigidBody.from_inertia(2.0, np.diag([3.0, 2.0, 1.5]), [0.0, 0.0, 0.5], nh.SO(3)).inertia_operator
            array([[3.5, 0. , 0. ],
                   [0. , 2.5, 0. ],
                   [0. , 0. , 1.5]])
        """
        return cls(mass_tensor_of_body("RigidBody", mass, inertia, center_of_mass, group), group)

    def __repr__(self) -> str:
        return f"RigidBody({self.group!r},\n  {lines_of(tensors_shown(self.group, self.mass_tensor))})"

    @system_memo
    def homogeneous_mass_tensor(self) -> Float[Array, "... N N"]:
        """The mass tensor itself."""
        return self.mass_tensor

    @system_memo
    def constraint_subspace(self) -> Float[np.ndarray, "dim dim"]:
        """All coordinate rows."""
        return np.eye(self.group.dim)

    @system_memo
    def annihilator(self) -> Float[np.ndarray, "0 dim"]:
        """No rows."""
        return np.empty((0, self.group.dim))
