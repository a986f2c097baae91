"""Any system with a left-invariant Lagrangian, a constraint fixed in the body or in space; the Veselova top."""

import dataclasses
import functools
from typing import Any, ClassVar

import numpy as np

from nonholo.base.checks import array, error, is_traced, positive_definite, symmetric
from nonholo.base.memo import system_memo
from nonholo.base.types import Array, Float
from nonholo.groups import AbstractMatrixGroup
from nonholo.systems import _mass
from nonholo.systems._base import AbstractLLSystem, AbstractLRSystem, replace_numbers
from nonholo.systems._normal_form import NormalForm, recognized_form
from nonholo.systems._subspace import subspace_and_annihilator
from nonholo.systems.families._tops import AbstractTop

_SINGULAR = 1e-13  # relative to the terms of the inertia


@dataclasses.dataclass(frozen=True, eq=False, repr=False, init=False)
class LLSystem(AbstractLLSystem):
    r"""A system on any matrix group whose body velocity stays in a subspace of the algebra, of any dimension.

    $$ l(\omega) = \tfrac12\langle\mathbb{I}\omega, \omega\rangle \ \Bigl(= \tfrac12\mathrm{tr}(\hat\omega\,\mathbb{J}\,
       \hat\omega^*)\Bigr), \qquad \omega \in \mathfrak{d}, $$

    where $x^* = x^T$ on SO(n) and SE(n), and $x^* = G^{-1}x^TG$ on a `MatrixGroup` with the form G.

    With a mass tensor the discrete map of this library conserves the energy exactly; with a general inertia operator it
    does not.

    Reference: [fedorov-zenkov-2004], section 2.

    Args:
        group: The configuration space.
        mass_tensor: $\mathbb{J} = \int r r^T dm$: (n, n) on SO(n), homogeneous (n + 1, n + 1) on SE(n), both symmetric;
            (N, N) with $\mathbb{J}^* = \mathbb{J}$ on a group with a form; or else `inertia_operator`. It is not the
            inertia tensor: `from_inertia` takes that one, and `repr` shows both.
        constraint_subspace: Rows span $\mathfrak{d}$; an empty (0, dim) array forbids all motion, dim rows forbid none.
        annihilator: Rows span the covectors that vanish on $\mathfrak{d}$. One of the two may be left out: it is then
            computed, as coordinate rows where the given rows are coordinate rows, orthonormal otherwise.
        inertia_operator: $\mathbb{I}$, symmetric (dim, dim), on any group.

    Raises:
        ValueError: Both or none of mass_tensor and inertia_operator; a mass tensor on another group; no constraint;
            dependent rows; a subspace and an annihilator that do not fit; a wrong shape, an asymmetry, a value that is
            not finite; an inertia along the constraint that is not positive definite (on a group with a form, which has
            motions of negative kinetic energy too: not invertible).

    Example:
        >>> from nonholo.systems import LLSystem
        >>> top = LLSystem(nh.SO(3), np.diag([1.0, 2.0, 3.0]), annihilator=[[0.0, 0.0, 1.0]])
        >>> top.constraint_subspace
        array([[1., 0., 0.],
               [0., 1., 0.]])
        >>> top.constrained_inertia
        array([[5., 0.],
               [0., 4.]])

        The Suslov problem on SO(2, 1):

        >>> G = np.diag([1.0, 1.0, -1.0])
        >>> lorentz, J = nh.MatrixGroup(G @ nh.SO(3).basis, form=G), np.array([[1, 0, 0.3], [0, 2, 0.1], [0.3, 0.1, 4]])
        >>> top = LLSystem(lorentz, J @ G, annihilator=[[0.0, 0.0, 1.0]])
        >>> top.constrained_inertia
        array([[2., 0.],
               [0., 3.]])
        >>> orbit = nh.simulate(nh.discretize(top, 0.1), body_velocity=(0.4, 0.2, 0.0), steps=100)
        >>> bool(np.ptp(orbit.energy) < 1e-14), bool(np.ptp(orbit.body_velocity[:, 0]) > 0.1)
        (True, True)
    """

    group: AbstractMatrixGroup
    mass_tensor: Array
    given_inertia: Array
    constraint_subspace: Array = None
    annihilator: Array = None
    structure: ClassVar[tuple[str, ...]] = ("group", "constraint_subspace", "annihilator")
    stack = replace_numbers

    def __init__(
        self,
        group: AbstractMatrixGroup,
        mass_tensor: Any = None,
        constraint_subspace: Any = None,
        *,
        annihilator: Any = None,
        inertia_operator: Any = None,
    ) -> None:
        _mass.checked_group("LLSystem(group=...)", group)
        where = "LLSystem(mass_tensor=...)"
        if (mass_tensor is None) == (inertia_operator is None):
            got = "neither" if mass_tensor is None else "both"
            remedy = "Pass the mass tensor on SO(n), SE(n) or a group with a form, the inertia operator on any other."
            raise error(where, "be given, or else inertia_operator=", got, remedy)
        rows, covectors = subspace_and_annihilator("LLSystem", group.dim, constraint_subspace, annihilator)
        if mass_tensor is None:
            where, shape = "LLSystem(inertia_operator=...)", (group.dim, group.dim)
            remedy = f"Pass the symmetric {shape} matrix that takes body velocities to body momenta."
            inertia_operator = symmetric(where, array(where, inertia_operator, shape, remedy), remedy)
        elif group.form is None:
            instead = "Pass inertia_operator= instead or, if the group preserves a form G, MatrixGroup(basis, form=G)."
            mass_tensor = _mass.group_mass_tensor(where, group, mass_tensor, instead)
        else:
            mass_tensor = _mass.form_mass_tensor(where, group, mass_tensor)
        self._hold(group, mass_tensor, inertia_operator, rows, covectors)
        if len(rows) and mass_tensor is not None and group.form is not None:
            _refuse_singular(where, self)
        elif len(rows):
            remedy = "Every admissible velocity needs a positive kinetic energy."
            positive_definite(where, self.constrained_inertia, "the inertia along the constraint", remedy)

    @classmethod
    def from_inertia(
        cls,
        mass: Any,
        inertia: Any,
        center_of_mass: Any,
        group: AbstractMatrixGroup,
        constraint_subspace: Any = None,
        *,
        annihilator: Any = None,
    ) -> "LLSystem":
        """Build a system from its mass, its inertia about the center of mass, and where that is in the body.

        On SO(3) the body turns about the origin of body coordinates, to which Steiner's theorem carries the inertia; on
        SE(n) the origin is the reference point. An `ImpossibleBodyWarning` is issued if no body has the inertia.

        Args:
            mass: m.
            inertia: About the center of mass: a number in the plane, the inertia tensor (3, 3) in space (not the mass
                tensor).
            center_of_mass: n body coordinates, from the origin.
            group: SO(2), SO(3), SE(2) or SE(3). In more dimensions an inertia tensor is none of a body: pass the mass
                tensor to the class itself.
            constraint_subspace: As for the class.
            annihilator: As for the class.

        Raises:
            ValueError: Another group, a mass or moment that is not positive, a wrong shape; and as for the class.

        Example:
            >>> from nonholo.systems import LLSystem
            >>> LLSystem.from_inertia(2.0, 1.0, [0.5, 0.0], nh.SE(2), annihilator=[[0.0, 0.0, 1.0]]).inertia_operator
            array([[1.5, 0. , 1. ],
                   [0. , 2. , 0. ],
                   [1. , 0. , 2. ]])
        """
        tensor = _mass.mass_tensor_of_body("LLSystem", mass, inertia, center_of_mass, group)
        return cls(group, tensor, constraint_subspace, annihilator=annihilator)

    @system_memo
    def inertia_operator(self) -> Float[Array, "... dim dim"]:
        """The inertia operator, that of the mass tensor if there is one."""
        return self.given_inertia if self.mass_tensor is None else super().inertia_operator

    @functools.cached_property
    def normal_form(self) -> NormalForm | None:
        """The top or sleigh that the system is; None if it is neither, or has no mass tensor."""
        return recognized_form(self)


def _refuse_singular(where: str, system: LLSystem) -> None:
    """Refuse an inertia along the constraint that is singular to rounding; it may have either sign."""
    inertia, rows = system.constrained_inertia, np.abs(system.constraint_subspace)
    if is_traced(inertia):
        return
    terms, units = rows @ np.abs(system.inertia_operator) @ rows.T, np.ones(len(rows))
    for _ in range(8):  # rows may mix lengths and angles
        sizes = (terms / units / units[:, None]).max(axis=1, initial=0.0)
        units = units * np.sqrt(np.where(sizes > 0, sizes, 1.0))
    if not np.abs(np.linalg.eigvalsh(inertia / units / units[:, None])).min() > _SINGULAR:
        got = f"eigenvalues {np.linalg.eigvalsh(inertia).tolist()}"
        remedy = "Every admissible velocity needs a separate momentum along the constraint."
        raise error(where, "make the inertia along the constraint invertible", got, remedy)


_REMEDY = "The constrained directions turn in the body, so the body needs a positive kinetic energy in every motion."


@dataclasses.dataclass(frozen=True, repr=False, eq=False)
class LRSystem(AbstractLRSystem):
    r"""A body on SO(n) or SE(n) whose spatial velocity stays in a subspace that is fixed in space.

    $$ l(\omega) = \tfrac12\mathrm{tr}(\hat\omega\,\mathbb{J}\,\hat\omega^T), \qquad
       \mathrm{Ad}_g\omega \in \mathfrak{d}. $$

    The spatial momentum along $\mathfrak{d}$ is conserved.

    Reference: [veselov-veselova-1986]; discrete: [fedorov-zenkov-2004], section 2.

    Args:
        group: SO(n) or SE(n).
        mass_tensor: Symmetric: (n, n) on SO(n), homogeneous (n + 1, n + 1) on SE(n), with a positive definite inertia
            operator. It is not the inertia tensor; `repr` shows both.
        constraint_subspace: Rows span $\mathfrak{d}$; any dimension from 0 to that of the group.
        annihilator: Rows span the covectors that vanish on $\mathfrak{d}$; one of the two may be left out.

    Raises:
        ValueError: As for `LLSystem`.

    Example:
        >>> from nonholo.systems import LRSystem
        >>> LRSystem(nh.SO(3), np.diag([1.0, 2.0, 3.0]), [[1.0, 0.0, 0.0]]).annihilator
        array([[0., 1., 0.],
               [0., 0., 1.]])
    """

    group: AbstractMatrixGroup
    mass_tensor: Array
    constraint_subspace: Array = None
    annihilator: Any = dataclasses.field(default=None, kw_only=True)
    structure: ClassVar[tuple[str, ...]] = ("group", "constraint_subspace", "annihilator")

    def __post_init__(self) -> None:
        where, instead = "LRSystem(mass_tensor=...)", "LR systems on other groups are not offered."
        _mass.checked_group("LRSystem(group=...)", self.group)
        spaces = (self.constraint_subspace, self.annihilator)
        rows, covectors = subspace_and_annihilator("LRSystem", self.group.dim, *spaces)
        tensor = _mass.group_mass_tensor(where, self.group, self.mass_tensor, instead)
        self._hold(self.group, tensor, rows, covectors)
        positive_definite(where, self.inertia_operator, "the inertia operator", _REMEDY)


@dataclasses.dataclass(frozen=True, repr=False, eq=False)
class VeselovaTop(AbstractTop, AbstractLRSystem):
    r"""A top on SO(n) that may only turn in planes that contain an axis $e_n$ fixed in space.

    $$ l(\omega) = \tfrac12\mathrm{tr}(\hat\omega J\hat\omega^T), \qquad
       R\,\omega R^T \in \mathfrak{d} = \mathrm{span}\{e_i\wedge e_n\}; $$

    for n = 3 the spatial angular velocity has no component along the vertical $e_3$. It is the Suslov top with the
    constraint fixed in space instead of in the body.

    Reference: [veselov-veselova-1986].

    Args:
        mass_tensor: Symmetric (n, n), n >= 3, with a positive definite inertia operator.

    Raises:
        ValueError: A shape, an asymmetry, a value that is not finite, an inertia that is not positive definite.

    Example:
        >>> from nonholo.systems import VeselovaTop
        >>> VeselovaTop(np.diag([1.0, 2.0, 3.0])).annihilator
        array([[0., 0., 1.]])
    """

    mass_tensor: Array

    def __post_init__(self) -> None:
        where = "VeselovaTop(mass_tensor=...)"
        self._hold(_mass.body_tensor(where, self.mass_tensor, "Pass the mass tensor J, not the inertia tensor."))
        positive_definite(where, self.inertia_operator, "the inertia operator", _REMEDY)
