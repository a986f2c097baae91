"""The free rigid body, and the Suslov top, which only turns in planes through an axis fixed in it, in any dimension."""

import dataclasses
from typing import Any, ClassVar

import numpy as np

from nonholo.base.checks import array, error, is_traced, positive_definite, symmetric
from nonholo.base.memo import system_memo
from nonholo.base.types import Array, Float
from nonholo.groups import SO, AbstractMatrixGroup
from nonholo.systems import _mass
from nonholo.systems._base import AbstractLLSystem, AbstractSystem, replace_numbers
from nonholo.systems._normal_form import NormalForm, top_form
from nonholo.systems._subspace import top_rows


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
    structure: ClassVar[tuple[str, ...]] = ("group",)
    stack = replace_numbers

    def __post_init__(self) -> None:
        where = "RigidBody(mass_tensor=...)"
        remedy = "Pass the mass tensor J; `RigidBody.from_inertia` takes the inertia tensor."
        if self.group is None:
            tensor = _mass.body_tensor(where, self.mass_tensor, remedy)
        else:
            _mass.checked_group("RigidBody(group=...)", self.group)
            instead = "`LLSystem` takes an inertia operator on any group."
            tensor = _mass.group_mass_tensor(where, self.group, self.mass_tensor, instead)
        self._hold(tensor, self.group or SO(len(tensor)))
        positive_definite(where, self.inertia_operator, "the inertia operator", remedy)

    @classmethod
    def from_inertia(cls, mass: Any, inertia: Any, center_of_mass: Any, group: AbstractMatrixGroup) -> "RigidBody":
        """Build a body from its mass, its inertia about the center of mass, and where that is in the body.

        On SO(3) the body turns about the origin of body coordinates, to which Steiner's theorem carries the inertia; on
        SE(n) the origin is the reference point. An `ImpossibleBodyWarning` is issued if no body has the inertia.

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
        return cls(_mass.mass_tensor_of_body("RigidBody", mass, inertia, center_of_mass, group), group)

    @system_memo
    def constraint_subspace(self) -> Float[np.ndarray, "dim dim"]:
        """All coordinate rows."""
        return np.eye(self.group.dim)


class AbstractTop(AbstractSystem):
    """A top on SO(n), whose first field is as long as n."""

    @system_memo
    def group(self) -> AbstractMatrixGroup:
        """The rotation group SO(n)."""
        return SO(getattr(self, self.leaves[0]).shape[-1])

    @system_memo
    def constraint_subspace(self) -> Float[np.ndarray, "k dim"]:
        r"""Rows $e_i\wedge e_n$."""
        return top_rows(self.group)


_E3 = (0.0, 0.0, 1.0)
_LAST = array("SuslovTop(axis=...)", _E3, (3,))


@dataclasses.dataclass(frozen=True, repr=False, eq=False)
class SuslovTop(AbstractTop, AbstractLLSystem):
    r"""A top on SO(n) that may only turn in planes that contain a body axis: $e_n$, or for n = 3 the axis `axis`.

    $$ l(\omega) = \tfrac12 \mathrm{tr}(\hat\omega J \hat\omega^T), \qquad
       \omega \in \mathfrak{d} = \mathrm{span}\{e_i\wedge e_n\}; \qquad n = 3:\ \langle\gamma, \omega\rangle = 0, $$

    with the mass tensor $J = \int r r^T dm$ (not, for n = 3, the inertia tensor $\mathrm{tr}(J)\,\mathrm{Id} - J$;
    `from_inertia` takes that one). With $J = \begin{pmatrix} A & c \\ c^T & d\end{pmatrix}$ in the canonical frame,
    $B = A + d\,\mathrm{Id}$ is the constrained inertia and $c$ the `coupling`, which drives the top from one permanent
    rotation to another.

    Reference: [fedorov-zenkov-2004], section 4.

    Args:
        mass_tensor: Symmetric (n, n), n >= 3, with positive definite B; flat and rod-like bodies are allowed.
        axis: The forbidden body axis as a unit vector, for n = 3 only; by default e3.

    Raises:
        ValueError: A shape, an asymmetry, a value that is not finite, B not positive definite, an axis for n > 3.

    Example:
        >>> top = SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]])
        >>> top.constrained_inertia
        array([[2.3, 0.2],
               [0.2, 1.9]])
        >>> SuslovTop(np.diag([1.0, 2.0, 3.0, 4.0])).constraint_subspace  # e1^e4, e2^e4, e3^e4
        array([[0., 0., 1., 0., 0., 0.],
               [0., 0., 0., 0., 1., 0.],
               [0., 0., 0., 0., 0., 1.]])
    """

    mass_tensor: Array
    axis: Array = dataclasses.field(default=None, kw_only=True)
    structure: ClassVar[tuple[str, ...]] = ("axis",)
    stack = replace_numbers

    def __post_init__(self) -> None:
        where = "SuslovTop(mass_tensor=...)"
        remedy = "Pass the mass tensor J, not the inertia tensor; `SuslovTop.from_inertia` takes that one."
        tensor = _mass.body_tensor(where, self.mass_tensor, remedy)
        self._hold(tensor, _forbidden_axis("SuslovTop(axis=...)", self.axis, len(tensor)))
        positive_definite(where, self.constrained_inertia, "the inertia along the constraint", remedy)

    @classmethod
    def from_inertia(cls, inertia: Array, axis: Array = _E3) -> "SuslovTop":
        """Build a top (n = 3) from its inertia tensor and the forbidden body axis, all in the user's body frame.

        The inertia tensor is about the fixed point. An `ImpossibleBodyWarning` is issued if no body has it.

        Example:
            >>> SuslovTop.from_inertia(np.diag([3.0, 2.0, 1.5]), axis=(0, 1, 0)).annihilator
            array([[0., 1., 0.]])
        """
        where = "SuslovTop.from_inertia(inertia=...)"
        tensor = symmetric(where, array(where, inertia, (3, 3)), "Pass the inertia tensor about the fixed point.")
        return cls(_mass.possible(where, _mass.mass_tensor_from_inertia(tensor)), axis=axis)

    @staticmethod
    def arrowhead(diagonal: Any, coupling: Any) -> "ArrowheadTop":
        r"""Build a top in many dimensions, n up to millions: $J = \mathrm{diag}(d)$ plus c in the last row and column.

        No n x n array is made. Every mass tensor has this form in the axes that diagonalize B.

        Args:
            diagonal: d, n numbers, n >= 3.
            coupling: c, n - 1 numbers.

        Raises:
            ValueError: A wrong shape, a value that is not finite, an inertia along the constraint that is not positive.

        Example:
            >>> SuslovTop.arrowhead([1.0, 2.0, 3.0, 4.0], [0.1, 0.2, 0.3]).dense.constrained_inertia.diagonal()
            array([5., 6., 7.])
        """
        return ArrowheadTop(diagonal, coupling)

    def __repr__(self) -> str:
        head = f"n={self.group.size}" if self.axis is None else f"axis={np.asarray(self.axis).tolist()}"
        return f"SuslovTop({head},\n  {_mass.lines_of(_mass.tensors_shown(self.group, self.mass_tensor))})"

    @system_memo
    def inertia_operator(self) -> Float[Array, "... dim dim"]:
        r"""The operator $\omega \mapsto J\omega + \omega J$; for n = 3 it is $\mathrm{tr}(J)\,\mathrm{Id} - J$."""
        return super().inertia_operator if self.axis is None else _mass.inertia_tensor(self.mass_tensor)

    @system_memo
    def inertia_along(self) -> Float[Array, "... k k"]:
        r"""The matrix $B = A + d\,\mathrm{Id}$; for n = 3 in the rows of the constraint subspace."""
        return self.normal_form.stiffness

    @system_memo
    def constraint_subspace(self) -> Float[np.ndarray, "k dim"]:
        r"""Rows $e_i\wedge e_n$; n = 3: S(0, 1, 0) and S(-1, 0, 0), S the shortest rotation taking e3 to the axis."""
        rows = top_rows(self.group)
        return rows if self.axis is None else rows @ self.frame.T

    @system_memo
    def annihilator(self) -> Float[np.ndarray, "s dim"]:
        r"""The forbidden planes $e_i\wedge e_j$, i < j < n; for n = 3 the forbidden axis."""
        return super().annihilator if self.axis is None else np.array(self.axis)[None, :]

    @system_memo
    def frame(self) -> Float[np.ndarray, "... n n"]:
        """The shortest rotation taking e3 to the forbidden axis; the identity for n > 3."""
        return self.group.identity if self.axis is None else _mass.rotation_to(self.axis)

    @system_memo
    def canonical(self) -> "SuslovTop":
        """The same top in body axes whose last one is the forbidden axis."""
        if self.axis is None or tuple(self.axis) == _E3:
            return self
        tensor = self.frame.T @ self.mass_tensor @ self.frame
        return replace_numbers(self, mass_tensor=(tensor + tensor.mT) / 2, axis=np.array(_E3))

    @property
    def coupling(self) -> Float[Array, "... k"]:
        """The vector c of the mass tensor in the canonical frame; zero for a balanced top."""
        return self.normal_form.coupling

    @system_memo
    def normal_form(self) -> NormalForm:
        """B and c."""
        return top_form(self.canonical.mass_tensor)


def _forbidden_axis(where: str, value: Array, n: int) -> Array:
    if n > 3:
        if value is not None:
            remedy = "Turn the body so that its planes of rotation contain e_n."
            raise error(where, "be left out for n > 3", f"an axis for n = {n}", remedy)
        return None
    if value is None:
        return _LAST
    axis = array(where, value, (3,), "Pass a unit vector in body coordinates.")
    if is_traced(axis):
        raise error(where, "be concrete", "a traced value", "Differentiate with respect to mass_tensor instead.")
    length = np.linalg.norm(axis)
    if abs(length - 1) > 1e-12:
        raise error(where, "be a unit vector", f"length {length:.17g}", "Divide it by its length.")
    return axis


@dataclasses.dataclass(frozen=True, repr=False, eq=False)
class ArrowheadTop(AbstractTop, AbstractLLSystem):
    r"""The Suslov top on SO(n) with $J = \mathrm{diag}(d_1, \dots, d_n)$ plus c in the last row and column.

    The constrained inertia is $B = \mathrm{diag}(d_1 + d_n, \dots, d_{n-1} + d_n)$. `SuslovTop.arrowhead` makes it;
    `dense` gives the same top as a `SuslovTop`.

    Args:
        diagonal: d, n numbers, n >= 3.
        coupling: c, n - 1 numbers.

    Raises:
        ValueError: As by `SuslovTop.arrowhead`.

    Example:
        >>> top = nh.SuslovTop.arrowhead(np.linspace(1, 2, 1000), np.full(999, 0.01))
        >>> orbit = nh.simulate(nh.discretize(top, 0.1), restricted_velocity=np.full(999, 0.03), steps=10,
        ...                     reconstruct=False)
        >>> orbit.restricted_momentum.shape, bool(np.ptp(orbit.energy) < 1e-14)
        ((11, 999), True)
    """

    diagonal: Array
    coupling: Array

    def __post_init__(self) -> None:
        self._hold(*_mass.arrow_numbers("SuslovTop.arrowhead", self.diagonal, self.coupling))
        _mass.refuse_negative("SuslovTop.arrowhead(diagonal=...)", self.inertia_along)

    def __repr__(self) -> str:
        return f"SuslovTop.arrowhead(n={len(self.diagonal)})"

    @property
    def dense(self) -> SuslovTop:
        """The same top with its mass tensor as a matrix."""
        return SuslovTop(self.homogeneous_mass_tensor)

    @system_memo
    def homogeneous_mass_tensor(self) -> Float[np.ndarray, "n n"]:
        """The mass tensor as a matrix."""
        return _mass.arrowhead("SuslovTop.arrowhead", self.diagonal, self.coupling, -1)

    @system_memo
    def inertia_along(self) -> _mass.WideInertia:
        """The diagonal of B."""
        return _mass.WideInertia(self.diagonal[:-1] + self.diagonal[-1], None, 0 * self.coupling)

    @system_memo
    def normal_form(self) -> NormalForm:
        """The diagonal of B, and c."""
        return NormalForm(self.diagonal[:-1], self.diagonal[-1], self.coupling)
