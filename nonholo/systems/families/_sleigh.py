"""The Chaplygin sleigh: a rigid body in the plane on a blade that cannot slip sideways."""

import dataclasses
import functools
from typing import ClassVar

import numpy as np

from nonholo.base.checks import is_traced, number, scale
from nonholo.base.memo import system_memo
from nonholo.base.types import Array, Bool, Float
from nonholo.groups import SE, AbstractMatrixGroup
from nonholo.systems._base import AbstractLLSystem, unchecked
from nonholo.systems._normal_form import NormalForm


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class ChaplyginSleigh(AbstractLLSystem):
    r"""A sleigh on SE(2): body velocity $(\omega, v_1, v_2)$ with $v_2 = 0$; the blade points along body axis 1.

    $$ l = \tfrac12\bigl[(J + m(a^2 + b^2))\omega^2 + m(v_1^2 + v_2^2) - 2mb\,\omega v_1 + 2ma\,\omega v_2\bigr]. $$

    Reference: [fedorov-zenkov-2004], section 5 (whose J is about the center of mass, as its formulas show).

    Args:
        mass: m.
        inertia: J, about the center of mass.
        a: Coordinate of the center of mass along the blade, from the contact point; the sleigh settles to move with the
            sign of a; a = 0 is balanced.
        b: Coordinate of the center of mass across the blade.

    Raises:
        ValueError: A mass or inertia that is not positive, a value that is not finite.

    Example:
        >>> ChaplyginSleigh(mass=2.0, inertia=1.0, a=0.5).inertia_operator
        array([[1.5, 0. , 1. ],
               [0. , 2. , 0. ],
               [1. , 0. , 2. ]])
    """

    mass: Array
    inertia: Array
    a: Array
    b: Array = 0.0
    group: ClassVar[AbstractMatrixGroup] = SE(2)
    leaves: ClassVar[tuple[str, ...]] = ("mass", "inertia", "a", "b")
    structure: ClassVar[tuple[str, ...]] = ()
    stacked = unchecked
    has_blade: ClassVar[bool] = True

    def __post_init__(self) -> None:
        about = "Pass the moment of inertia about the center of mass."
        object.__setattr__(self, "mass", scale("ChaplyginSleigh(mass=...)", self.mass, "Pass the mass of the body."))
        object.__setattr__(self, "inertia", scale("ChaplyginSleigh(inertia=...)", self.inertia, about))
        object.__setattr__(self, "a", number("ChaplyginSleigh(a=...)", self.a))
        object.__setattr__(self, "b", number("ChaplyginSleigh(b=...)", self.b))

    def __repr__(self) -> str:
        shown = (f"{name}={getattr(self, name)}" for name in ("mass", "inertia", "a", "b"))
        return f"ChaplyginSleigh({', '.join(shown)})"

    @system_memo
    def homogeneous_mass_tensor(self) -> Float[Array, "... 3 3"]:
        """The mass tensor about the contact point in homogeneous coordinates; the moment J is shared by both axes."""
        m, a, b = self.mass, self.a, self.b
        xp = (m * a * b * self.inertia).__array_namespace__()
        half = self.inertia / 2
        rows = ((half + m * a * a, m * a * b, m * a), (m * a * b, half + m * b * b, m * b), (m * a, m * b, m))
        return xp.stack([xp.stack(row, axis=-1) for row in rows], axis=-2)

    @property
    def is_clear(self) -> Bool[np.ndarray, "..."]:
        """Whether mass and moment are positive."""
        return np.asarray((self.mass > 0) & (self.inertia > 0))

    @system_memo
    def constraint_subspace(self) -> Float[np.ndarray, "2 3"]:
        """Rows (omega) and (v1)."""
        return np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])

    @system_memo
    def annihilator(self) -> Float[np.ndarray, "1 3"]:
        """The velocity across the blade."""
        return np.array([[0.0, 0.0, 1.0]])

    @system_memo
    def frame(self) -> Float[Array, "... 3 3"]:
        """The translation to the foot of the center of mass on the line through the contact point across the blade."""
        xp = (self.b * self.mass).__array_namespace__()
        zero, one = xp.zeros_like(self.b), xp.ones_like(self.b)
        rows = ((one, zero, zero), (zero, one, self.b), (zero, zero, one))
        return xp.stack([xp.stack(row, axis=-1) for row in rows], axis=-2)

    @functools.cached_property
    def canonical(self) -> "ChaplyginSleigh":
        """The same sleigh with b = 0: the offset across the blade does not enter the reduced motion."""
        is_canonical = not is_traced(self.b) and not np.any(self.b)
        return self if is_canonical else unchecked(self, b=np.zeros(np.shape(self.b))[()])

    @functools.cached_property
    def normal_form(self) -> NormalForm:
        r"""J, m and a; the plane $e_1\wedge e_2$ turns against $\omega$."""
        xp = (self.inertia * self.mass * self.a).__array_namespace__()
        inertia, none = xp.asarray(self.inertia)[..., None, None], np.zeros((*np.shape(self.inertia), 1))
        return NormalForm(inertia, 0.0, none, self.mass, self.a, none, frame_map=np.diag([-1.0, 1.0]))
