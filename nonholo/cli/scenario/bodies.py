"""The bodies that a scenario can hold, one class for each kind; each checks itself by building its system."""

import abc
from typing import TYPE_CHECKING, Any, ClassVar, Literal, Self, get_args

from pydantic import model_validator

import nonholo
from nonholo.cli.scenario._groups import Group, group_of
from nonholo.cli.scenario.sections import Matrix, Number, Positive, Section, Vector, exactly_one

if TYPE_CHECKING:
    from nonholo.systems import System

Keys = tuple[tuple[str, ...], ...]


class AbstractBody(Section, abc.ABC):
    """A body of any kind: its system is built once when it is read, so that the library's refusals are reported."""

    one_of: ClassVar[Keys] = ()
    """Groups of keys of which exactly one must be there."""

    @abc.abstractmethod
    def system(self) -> "System":
        """Return what moves."""

    @model_validator(mode="after")
    def _is_a_body(self) -> Self:
        for names in self.one_of:
            exactly_one(self, names)
        self.system()
        return self


class SuslovBody(AbstractBody):
    """A body about a fixed point, in n dimensions, that may only turn in planes containing one of its axes."""

    kind: Literal["suslov"]
    mass_tensor: Matrix | None = None
    """J, symmetric; not the inertia tensor."""
    inertia: Matrix | None = None
    """Inertia tensor, instead of the mass tensor; n = 3."""
    axis: Vector | None = None
    """The body axis without spin; by default e_n."""
    one_of: ClassVar[Keys] = (("mass_tensor", "inertia"),)

    def system(self) -> "System":
        """Return the top."""
        if self.inertia is not None:
            return nonholo.SuslovTop.from_inertia(
                self.inertia, axis=(0.0, 0.0, 1.0) if self.axis is None else self.axis
            )
        return nonholo.SuslovTop(self.mass_tensor, axis=self.axis)


class SleighBody(AbstractBody):
    """A rigid body in the plane on a blade that cannot slip sideways; it turns round until its mass leads."""

    kind: Literal["sleigh"]
    mass: Positive
    """Of the whole body."""
    inertia: Positive
    """About the center of mass, not about the blade."""
    a: Number
    """Center of mass along the blade, from the contact point."""
    b: Number = 0.0
    """Center of mass across the blade."""

    def system(self) -> "System":
        """Return the sleigh."""
        return nonholo.ChaplyginSleigh(self.mass, self.inertia, self.a, self.b)


class MultidimensionalSleighBody(AbstractBody):
    """A sleigh in n dimensions: its reference point moves along body axis 1, which may turn but not twist."""

    kind: Literal["multidimensional_sleigh"]
    mass: Positive
    """Of the whole body."""
    center_of_mass: Vector
    """From the reference point, in body axes."""
    mass_tensor: Matrix
    """J about the center of mass, symmetric."""

    def system(self) -> "System":
        """Return the sleigh."""
        return nonholo.MultidimensionalSleigh(self.mass, self.center_of_mass, self.mass_tensor)


class RigidBodyBody(AbstractBody):
    """A free body: about a fixed point in n dimensions, or with group = "SE(n)" moving about in them."""

    kind: Literal["rigid_body"]
    mass_tensor: Matrix
    """J, symmetric; not the inertia tensor."""
    group: Group | None = None
    """SO(n) by default, or SE(n)."""

    def system(self) -> "System":
        """Return the body."""
        return nonholo.RigidBody(self.mass_tensor, None if self.group is None else group_of(self.group))


class VeselovaBody(AbstractBody):
    """A body about a fixed point, in n dimensions, that may only turn in planes containing an axis fixed in space."""

    kind: Literal["veselova"]
    mass_tensor: Matrix
    """J, symmetric; not the inertia tensor."""

    def system(self) -> "System":
        """Return the top."""
        return nonholo.VeselovaTop(self.mass_tensor)


class LeftInvariantBody(AbstractBody):
    """Anything on a matrix group whose velocity, seen from the body, stays in a subspace fixed in the body."""

    kind: Literal["left_invariant"]
    group: Group
    """SO(n), SE(n), Translations(m), products with x between them, or {basis = [matrices]}."""
    mass_tensor: Matrix | None = None
    """J, symmetric; not the inertia tensor."""
    inertia_operator: Matrix | None = None
    """Instead of a mass tensor: the kinetic energy in coordinates of the algebra."""
    constraint_subspace: Matrix | None = None
    """Rows span the velocities that are allowed."""
    annihilator: Matrix | None = None
    """Instead: rows vanish on those velocities."""
    one_of: ClassVar[Keys] = (
        ("mass_tensor", "inertia_operator"),
        ("constraint_subspace", "annihilator"),
    )

    def system(self) -> "System":
        """Return the system."""
        return nonholo.LLSystem(
            group_of(self.group),
            self.mass_tensor,
            self.constraint_subspace,
            annihilator=self.annihilator,
            inertia_operator=self.inertia_operator,
        )


class RightInvariantBody(AbstractBody):
    """A body on SO(n) or SE(n) whose velocity, seen from space, stays in a subspace fixed in space."""

    kind: Literal["right_invariant"]
    group: Group
    """SO(n), SE(n), Translations(m), products with x between them, or {basis = [matrices]}."""
    mass_tensor: Matrix
    """J, symmetric; not the inertia tensor."""
    constraint_subspace: Matrix | None = None
    """Rows span the velocities that are allowed."""
    annihilator: Matrix | None = None
    """Instead: rows vanish on those velocities."""
    one_of: ClassVar[Keys] = (("constraint_subspace", "annihilator"),)

    def system(self) -> "System":
        """Return the system."""
        given: Any = (self.mass_tensor, self.constraint_subspace)
        return nonholo.LRSystem(group_of(self.group), *given, annihilator=self.annihilator)


AnyBody = (
    SuslovBody
    | SleighBody
    | MultidimensionalSleighBody
    | RigidBodyBody
    | VeselovaBody
    | LeftInvariantBody
    | RightInvariantBody
)
BODIES: dict[str, type[AbstractBody]] = {
    get_args(body.model_fields["kind"].annotation)[0]: body for body in get_args(AnyBody)
}
"""The class of each kind."""
