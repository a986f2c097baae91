"""The Chaplygin sleigh: a body on a blade that cannot slip sideways, in the plane and in n dimensions."""

import dataclasses
from typing import Any, ClassVar

import numpy as np

from nonholo.base.checks import array, error, is_traced, number, positive_definite, scale, symmetric
from nonholo.base.memo import system_memo
from nonholo.base.types import Array, Bool, Float
from nonholo.groups import SE, AbstractMatrixGroup
from nonholo.systems._base import AbstractLLSystem, replace_numbers
from nonholo.systems._mass import WideInertia, arrow_numbers, arrowhead, refuse_negative, with_mass
from nonholo.systems._normal_form import NormalForm, sleigh_form
from nonholo.systems._subspace import sleigh_rows


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class ChaplyginSleigh(AbstractLLSystem):
    r"""A sleigh on SE(2): body velocity $(\omega, v_1, v_2)$ with $v_2 = 0$; the blade points along body axis 1.

    $$ l = \tfrac12\bigl[(J + m(a^2 + b^2))\omega^2 + m(v_1^2 + v_2^2) - 2mb\,\omega v_1 + 2ma\,\omega v_2\bigr]. $$

    Reference: [fedorov-zenkov-2004], section 5 (whose J is about the center of mass, as its formulas show).

    Args:
        mass: m.
        inertia: J, about the center of mass.
        a: Coordinate of the center of mass along the blade, from the contact point. The final velocity along the blade
            has the sign of a; a = 0 is balanced.
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
    stack = replace_numbers
    has_blade: ClassVar[bool] = True

    def __post_init__(self) -> None:
        about = "Pass the moment of inertia about the center of mass."
        mass = scale("ChaplyginSleigh(mass=...)", self.mass, "Pass the mass of the body.")
        inertia = scale("ChaplyginSleigh(inertia=...)", self.inertia, about)
        self._hold(mass, inertia, *(number(f"ChaplyginSleigh({name}=...)", getattr(self, name)) for name in "ab"))

    def __repr__(self) -> str:
        fields = (f"{name}={getattr(self, name)}" for name in ("mass", "inertia", "a", "b"))
        return f"ChaplyginSleigh({', '.join(fields)})"

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
    def frame(self) -> Float[Array, "... 3 3"]:
        """The translation to the foot of the center of mass on the line through the contact point across the blade."""
        xp = (self.b * self.mass).__array_namespace__()
        zero = xp.zeros_like(self.b)
        return self.group.exp(xp.stack([zero, zero, self.b], axis=-1))

    @system_memo
    def canonical(self) -> "ChaplyginSleigh":
        """The same sleigh with b = 0: the offset across the blade does not enter the reduced motion."""
        is_canonical = not is_traced(self.b) and not np.any(self.b)
        return self if is_canonical else replace_numbers(self, b=np.zeros(np.shape(self.b))[()])

    @system_memo
    def normal_form(self) -> NormalForm:
        r"""J, m and a; the plane $e_1\wedge e_2$ turns against $\omega$."""
        xp = (self.inertia * self.mass * self.a).__array_namespace__()
        inertia, none = xp.asarray(self.inertia)[..., None, None], np.zeros((*np.shape(self.inertia), 1))
        return NormalForm(inertia, 0.0, none, self.mass, self.a, none, frame_map=np.diag([-1.0, 1.0]))


class AbstractSleighN(AbstractLLSystem):
    """A sleigh on SE(n), which slides along body axis 1."""

    center_of_mass: Array
    has_blade: ClassVar[bool] = True

    @system_memo
    def group(self) -> AbstractMatrixGroup:
        """The group of rigid motions SE(n)."""
        return SE(self.center_of_mass.shape[-1])

    @system_memo
    def constraint_subspace(self) -> Float[np.ndarray, "n dim"]:
        r"""Rows $e_1\wedge e_j$, j = 2..n, then the velocity along body axis 1."""
        return sleigh_rows(self.group)


@dataclasses.dataclass(frozen=True, repr=False, eq=False)
class MultidimensionalSleigh(AbstractSleighN):
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
        self._hold(mass, center, tensor)
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
        return ArrowheadSleigh(mass, center_of_mass, diagonal, coupling)

    def __repr__(self) -> str:
        tensor = np.array2string(np.asarray(self.mass_tensor), prefix=" " * 39)
        head = f"mass={self.mass}, center_of_mass={np.asarray(self.center_of_mass).tolist()}"
        return f"MultidimensionalSleigh({head},\n  mass tensor about the center of mass = {tensor})"

    @system_memo
    def homogeneous_mass_tensor(self) -> Float[Array, "N N"]:
        """The mass tensor about the reference point in homogeneous coordinates."""
        xp = (self.mass * self.center_of_mass @ self.mass_tensor).__array_namespace__()
        return with_mass(xp.asarray(self.mass_tensor), self.mass, xp.asarray(self.center_of_mass))

    @system_memo
    def inertia_along(self) -> Float[Array, "n n"]:
        r"""The matrix of $w\cdot Bw + m\,a_1^2|w|^2 + m(v_1 + \alpha\cdot w)^2$ in (w, v_1), twice the energy."""
        J, a, m = self.mass_tensor, self.center_of_mass, self.mass
        xp = (m * a @ J).__array_namespace__()
        J, a = xp.asarray(J), xp.asarray(a)
        turning = J[1:, 1:] + (J[0, 0] + m * a[0] ** 2) * xp.eye(J.shape[-1] - 1, dtype=J.dtype)
        return with_mass(turning, m, a[1:])

    @system_memo
    def normal_form(self) -> NormalForm:
        """The numbers of the equations of motion, c with the other sign."""
        return sleigh_form(self.mass, self.center_of_mass, self.mass_tensor)


@dataclasses.dataclass(frozen=True, repr=False, eq=False)
class ArrowheadSleigh(AbstractSleighN):
    r"""The sleigh on SE(n) with $J_C = \mathrm{diag}(d_1, \dots, d_n)$ plus c in the first row and column.

    `MultidimensionalSleigh.arrowhead` makes it; `dense` gives the same sleigh as a `MultidimensionalSleigh`.

    Args:
        mass: m.
        center_of_mass: a, n body coordinates.
        diagonal: d, n numbers, n >= 3.
        coupling: c, n - 1 numbers.

    Raises:
        ValueError: A wrong shape, a mass or an inertia that is not positive.

    Example:
        >>> center = np.linspace(0.5, 0.0, 1000)
        >>> nh.MultidimensionalSleigh.arrowhead(1.0, center, np.linspace(1, 2, 1000), np.full(999, 0.01)).rank
        1000
    """

    mass: Array
    center_of_mass: Array
    diagonal: Array
    coupling: Array

    def __post_init__(self) -> None:
        owner = "MultidimensionalSleigh.arrowhead"
        mass = scale(f"{owner}(mass=...)", self.mass, "Pass the mass of the body.")
        diagonal, coupling = arrow_numbers(owner, self.diagonal, self.coupling)
        where = f"{owner}(center_of_mass=...)"
        center = array(where, self.center_of_mass, diagonal.shape, "Pass n body coordinates.")
        self._hold(mass, center, diagonal, coupling)
        refuse_negative(f"{owner}(diagonal=...)", self.inertia_along)

    def __repr__(self) -> str:
        return f"MultidimensionalSleigh.arrowhead(n={len(self.diagonal)}, mass={self.mass}, a={self.center_of_mass[0]})"

    @property
    def dense(self) -> MultidimensionalSleigh:
        """The same sleigh with its mass tensor as a matrix."""
        J = arrowhead("MultidimensionalSleigh.arrowhead", self.diagonal, self.coupling, 0)
        return MultidimensionalSleigh(self.mass, self.center_of_mass, J)

    @system_memo
    def homogeneous_mass_tensor(self) -> Float[np.ndarray, "N N"]:
        """The mass tensor about the reference point as a matrix."""
        return self.dense.homogeneous_mass_tensor

    @system_memo
    def inertia_along(self) -> WideInertia:
        r"""The diagonal of $B_1$, the mass, and the offset of the center of mass across the blade."""
        a = self.center_of_mass
        return WideInertia(self.diagonal[1:] + self.diagonal[0] + self.mass * a[0] ** 2, self.mass, a[1:])

    @system_memo
    def normal_form(self) -> NormalForm:
        """The numbers of the equations of motion, c with the other sign."""
        d, a = self.diagonal, self.center_of_mass
        return NormalForm(d[1:], d[0], -self.coupling, self.mass, a[0], a[1:])
