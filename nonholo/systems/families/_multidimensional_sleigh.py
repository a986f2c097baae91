"""The Chaplygin sleigh in n dimensions: its contact point moves along one body axis, about which alone it turns."""

import dataclasses
import functools
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from nonholo.base.checks import array, error, positive_definite, scale, symmetric
from nonholo.base.memo import system_memo
from nonholo.base.types import Array, Float
from nonholo.groups import SE, AbstractMatrixGroup
from nonholo.systems._base import AbstractLLSystem
from nonholo.systems._normal_form import NormalForm, sleigh_form
from nonholo.systems._subspace import sleigh_rows

if TYPE_CHECKING:
    from nonholo.systems.families._arrowhead import ArrowheadSleigh


@dataclasses.dataclass(frozen=True, repr=False, eq=False)
class MultidimensionalSleigh(AbstractLLSystem):
    r"""A sleigh on SE(n), n >= 3: its reference point moves along body axis 1, it turns in planes that contain it.

    $$ \mathfrak{d} = \{(w, v) : w = \textstyle\sum_{j\ge2} w_j\, e_1\wedge e_j,\ v = v_1 e_1\}, \qquad
       l = \tfrac12\mathrm{tr}(\xi\,\mathbb{J}\,\xi^T), \qquad
       \mathbb{J} = \begin{pmatrix} J_C + m\,aa^T & m\,a \\ m\,a^T & m \end{pmatrix}. $$

    With $a = (a_1, \alpha)$, $J_C = \begin{pmatrix} J_{11} & c^T \\ c & A\end{pmatrix}$, $B_1 = A + (J_{11} +
    m a_1^2)\,\mathrm{Id}$ and the velocity $u = v_1 + \alpha\cdot w$ the motion is $B_1\dot w = |w|^2c - (c\cdot w)w -
    m a_1 u\,w$, $\dot u = a_1|w|^2$. For n = 2 there is `ChaplyginSleigh`.

    Reference: [fedorov-zenkov-2004], section 5, "Left-invariant constraints on SE(n)".

    Args:
        mass: m.
        center_of_mass: a, n body coordinates from the reference point.
        mass_tensor: $J_C$, symmetric (n, n), about the center of mass.

    Raises:
        ValueError: A mass that is not positive, a wrong shape, an asymmetry, a value that is not finite, an inertia
            along the constraint that is not positive definite.

    Example:
        >>> from nonholo.systems import MultidimensionalSleigh
        >>> MultidimensionalSleigh(2.0, [0.5, 0.0, 0.0], np.diag([1.0, 2.0, 3.0])).constrained_inertia
        array([[3.5, 0. , 0. ],
               [0. , 4.5, 0. ],
               [0. , 0. , 2. ]])
    """

    mass: Array
    center_of_mass: Array
    mass_tensor: Array
    leaves: ClassVar[tuple[str, ...]] = ("mass", "center_of_mass", "mass_tensor")
    structure: ClassVar[tuple[str, ...]] = ()
    has_blade: ClassVar[bool] = True

    def __post_init__(self) -> None:
        owner = "MultidimensionalSleigh"
        mass = scale(f"{owner}(mass=...)", self.mass, "Pass the mass of the body.")
        where, remedy = f"{owner}(center_of_mass=...)", "Pass n body coordinates."
        center = array(where, self.center_of_mass, (None,), remedy)
        n = center.shape[0]
        if n < 3:
            raise error(where, "have at least 3 coordinates", f"{n}", "In the plane use `ChaplyginSleigh`.")
        where, remedy = f"{owner}(mass_tensor=...)", "Pass the mass tensor about the center of mass."
        tensor = symmetric(where, array(where, self.mass_tensor, (n, n), remedy), remedy)
        for field, value in zip(dataclasses.fields(self), (mass, center, tensor), strict=True):
            object.__setattr__(self, field.name, value)
        positive_definite(where, self.constrained_inertia, "the inertia along the constraint", remedy)

    @staticmethod
    def arrowhead(mass: Any, center_of_mass: Any, diagonal: Any, coupling: Any) -> "ArrowheadSleigh":
        r"""Build a sleigh in many dimensions: $J_C = \mathrm{diag}(d)$ plus c in the first row and column.

        No n x n array is made. Every mass tensor has this form in the axes that diagonalize its block A.

        Args:
            mass: m.
            center_of_mass: a, n body coordinates from the reference point.
            diagonal: d, n numbers, n >= 3.
            coupling: c, n - 1 numbers.

        Raises:
            ValueError: A wrong shape, a value that is not finite, a mass or an inertia that is not positive.

        Example:
            >>> sleigh = MultidimensionalSleigh.arrowhead(2.0, [0.5, 0, 0], [1.0, 2.0, 3.0], [0.1, 0.2])
            >>> sleigh.dense.constrained_inertia.diagonal()
            array([3.5, 4.5, 2. ])
        """
        from nonholo.systems.families._arrowhead import ArrowheadSleigh

        return ArrowheadSleigh(mass, center_of_mass, diagonal, coupling)

    def __repr__(self) -> str:
        tensor = np.array2string(np.asarray(self.mass_tensor), prefix=" " * 39)
        head = f"mass={self.mass}, center_of_mass={np.asarray(self.center_of_mass).tolist()}"
        return f"MultidimensionalSleigh({head},\n  mass tensor about the center of mass = {tensor})"

    @system_memo
    def group(self) -> AbstractMatrixGroup:
        """The group of rigid motions SE(n)."""
        return SE(self.center_of_mass.shape[-1])

    @system_memo
    def homogeneous_mass_tensor(self) -> Float[Array, "N N"]:
        """The mass tensor about the reference point in homogeneous coordinates."""
        xp = (self.mass * self.center_of_mass @ self.mass_tensor).__array_namespace__()
        a = xp.asarray(self.center_of_mass)
        lever = xp.concatenate([a, xp.ones_like(a[:1])])
        return xp.pad(xp.asarray(self.mass_tensor), ((0, 1), (0, 1))) + self.mass * lever[:, None] * lever

    @system_memo
    def inertia_along(self) -> Float[Array, "n n"]:
        r"""The matrix of $w\cdot Bw + m\,a_1^2|w|^2 + m(v_1 + \alpha\cdot w)^2$ in (w, v_1), twice the energy."""
        J, a, m = self.mass_tensor, self.center_of_mass, self.mass
        xp = (m * a @ J).__array_namespace__()
        J, a = xp.asarray(J), xp.asarray(a)
        lever = xp.concatenate([a[1:], xp.ones_like(a[:1])])
        turning = J[1:, 1:] + (J[0, 0] + m * a[0] ** 2) * xp.eye(J.shape[-1] - 1, dtype=J.dtype)
        return xp.pad(turning, ((0, 1), (0, 1))) + m * lever[:, None] * lever

    @system_memo
    def constraint_subspace(self) -> Float[np.ndarray, "n dim"]:
        r"""Rows $e_1\wedge e_j$, j = 2..n, then the velocity along body axis 1."""
        return sleigh_rows(self.group)

    @functools.cached_property
    def normal_form(self) -> NormalForm:
        """The numbers of the equations of motion, c with the other sign."""
        return sleigh_form(self.mass, self.center_of_mass, self.mass_tensor)
