"""Any system with a left-invariant Lagrangian and a right-invariant constraint, and the Veselova top."""

import dataclasses
from typing import Any, ClassVar

import numpy as np

from nonholo.base.checks import positive_definite
from nonholo.base.memo import system_memo
from nonholo.base.types import Array, Float
from nonholo.groups import SO, AbstractMatrixGroup
from nonholo.systems._base import AbstractLRSystem
from nonholo.systems._body import lines_of, tensors_shown
from nonholo.systems._mass import body_tensor, checked_group, group_mass_tensor
from nonholo.systems._subspace import subspace_and_annihilator, top_rows

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
    leaves: ClassVar[tuple[str, ...]] = ("mass_tensor",)
    structure: ClassVar[tuple[str, ...]] = ("group", "constraint_subspace", "annihilator")

    def __post_init__(self) -> None:
        where, instead = "LRSystem(mass_tensor=...)", "LR systems on other groups are not offered."
        checked_group("LRSystem(group=...)", self.group)
        given = (self.constraint_subspace, self.annihilator)
        rows, covectors = subspace_and_annihilator("LRSystem", self.group.dim, *given)
        tensor = group_mass_tensor(where, self.group, self.mass_tensor, instead)
        for field, value in zip(dataclasses.fields(self), (self.group, tensor, rows, covectors), strict=True):
            object.__setattr__(self, field.name, value)
        positive_definite(where, self.inertia_operator, "the inertia operator", _REMEDY)

    def __repr__(self) -> str:
        shown = tensors_shown(self.group, self.mass_tensor)
        subspace = {"constraint subspace": np.asarray(self.constraint_subspace)}
        return f"LRSystem({self.group!r},\n  {lines_of(shown | subspace)})"

    @system_memo
    def homogeneous_mass_tensor(self) -> Float[Array, "N N"]:
        """The mass tensor itself."""
        return self.mass_tensor


@dataclasses.dataclass(frozen=True, repr=False, eq=False)
class VeselovaTop(AbstractLRSystem):
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
    leaves: ClassVar[tuple[str, ...]] = ("mass_tensor",)
    structure: ClassVar[tuple[str, ...]] = ()

    def __post_init__(self) -> None:
        where = "VeselovaTop(mass_tensor=...)"
        tensor = body_tensor(where, self.mass_tensor, "Pass the mass tensor J, not the inertia tensor.")
        object.__setattr__(self, "mass_tensor", tensor)
        positive_definite(where, self.inertia_operator, "the inertia operator", _REMEDY)

    def __repr__(self) -> str:
        return f"VeselovaTop({self.group!r},\n  {lines_of(tensors_shown(self.group, self.mass_tensor))})"

    @system_memo
    def group(self) -> AbstractMatrixGroup:
        """The rotation group SO(n)."""
        return SO(self.mass_tensor.shape[-1])

    @system_memo
    def homogeneous_mass_tensor(self) -> Float[Array, "n n"]:
        """The mass tensor itself."""
        return self.mass_tensor

    @system_memo
    def constraint_subspace(self) -> Float[np.ndarray, "k dim"]:
        r"""Rows $e_i\wedge e_n$, fixed in space."""
        return top_rows(self.group)
