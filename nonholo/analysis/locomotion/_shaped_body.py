"""`ShapedBody`: a body on any group whose shape its owner moves, by its reduced Lagrangian and constraints."""

import dataclasses
from collections.abc import Callable
from typing import Any

from nonholo.base.checks import error, instance, names, needs
from nonholo.base.types import Array
from nonholo.systems import checked_group

_NAMES = "ShapedBody(shape_coordinates=...)"


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class ShapedBody:
    r"""A body on a matrix group G with a shape s, seen from itself: for `local_connection` and what follows from it.

    $$ l(s, \xi, \dot s), \qquad W(s)\begin{pmatrix}\xi\\\dot s\end{pmatrix} = 0, \qquad \dot g = g\,\xi . $$

    Nothing depends on the pose g. A falling cat, a satellite with rotors, a fish, a rover on a ball are of this kind.
    Systems in the plane that are given in coordinates need it not.

    Attributes:
        group: G.
        shape_coordinates: Names of the shape variables s.
        lagrangian: `lagrangian(shape, body_velocity, shape_velocity)` -> scalar, quadratic in the velocities, written
            with `jax.numpy`; None if the constraints determine the body velocity.
        constraint_forms: `constraint_forms(shape)` -> (c, dim + m), the rows W; None for none.
        name: For pictures and messages.

    Raises:
        ValueError: Something that is no group or no function, no shape, values of wrong shapes.

    Example:
        A satellite with two rotors, of inertia 0.5 about its first two axes: $A = (I + j)^{-1}j$ for each.

        >>> import jax.numpy as jnp
        >>> def lagrangian(s, xi, ds):
        ...     return (jnp.array([1.0, 1.5, 2.0]) @ xi**2 + 0.5 * ((xi[:2] + ds) ** 2).sum()) / 2
        >>> body = ShapedBody(nh.SO(3), ("a", "b"), lagrangian)
        >>> nh.local_connection(body).matrix((0.0, 0.0)).round(4)
        array([[0.3333, 0.    ],
               [0.    , 0.25  ],
               [0.    , 0.    ]])
    """

    group: Any
    shape_coordinates: tuple[str, ...]
    lagrangian: Callable[[Array, Array, Array], Array] | None = None
    constraint_forms: Callable[[Array], Array] | None = None
    name: str = "Body with a shape"

    def __post_init__(self) -> None:
        checked_group("ShapedBody(group=...)", self.group)
        names(_NAMES, instance(_NAMES, self.shape_coordinates, tuple, "be names", "Pass a tuple of strings."))
        if self.lagrangian is None and self.constraint_forms is None:
            remedy = "Pass lagrangian=, constraint_forms= or both."
            raise error("ShapedBody(...)", "have a Lagrangian or constraints", "neither", remedy)
        with needs("jax", "ShapedBody"):
            from nonholo.analysis.locomotion import _reduction
        _reduction.check_functions(self)

    def __repr__(self) -> str:
        return f"<ShapedBody {self.name!r} on {self.group}: shape {', '.join(self.shape_coordinates)}>"
