"""The interface of systems in coordinates."""

import abc
import importlib
from collections.abc import Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, ClassVar, Generic, NoReturn

from nonholo.base.checks import error
from nonholo.base.memo import Keeper

if TYPE_CHECKING:
    from typing_extensions import TypeVar

    OrbitT = TypeVar("OrbitT", default=Any)
    DiscretizationT = TypeVar("DiscretizationT", default=Any)
else:
    from typing import TypeVar

    OrbitT, DiscretizationT = TypeVar("OrbitT"), TypeVar("DiscretizationT")


class _Former:
    """A method of earlier versions: its use raises an error that names the function in its place."""

    def __init__(self, call: str) -> None:
        self.call = call

    def __set_name__(self, kind: type, name: str) -> None:
        self.name = name

    def __get__(self, owner: Any, kind: type) -> NoReturn:
        page = "docs/project/migration.md"
        raise AttributeError(f"`{kind.__name__}.{self.name}` is now `{self.call}`: see {page}.")


class AbstractCoordinateDiscretization(Keeper, abc.ABC, Generic[OrbitT]):
    """A discretized system in coordinates."""

    system: Any
    time_step: float
    route_name: ClassVar[None] = None
    forces: ClassVar[None] = None
    starts: ClassVar[tuple[str, ...]] = ("body_velocity", "displacement", "momentum")

    @abc.abstractmethod
    def first(self, start: Any, *, with_poses: bool) -> Any:
        """Return a checked start in the numbers of the motion."""

    @abc.abstractmethod
    def stepper(self, *, with_poses: bool) -> Any:
        """Return what takes its steps."""

    if not TYPE_CHECKING:
        simulate = _Former("nonholo.simulate(discrete, steps=...)")
        iterate = _Former("nonholo.iterate(discrete, steps=...)")


class AbstractCoordinateSystem(Keeper, abc.ABC, Generic[DiscretizationT, OrbitT]):
    """A system in coordinates: `nonholo.discretize` and `Forced` hand their arguments on to it.

    Attributes:
        description: Its description in stores, instead of its fields: a name and parameters.
        parameters: Numbers that its functions take.
    """

    leaves: ClassVar[tuple[str, ...]] = ()
    is_wide: ClassVar[bool] = False
    normal_form: ClassVar[None] = None
    has_functions: ClassVar[bool] = True
    """Whether it has its Lagrangian: one from a store need not."""

    description: tuple[str, dict[str, Any]] | None = None
    parameters: Mapping[str, Any] = MappingProxyType({})

    @property
    def family(self) -> Any:
        """The one system that stands for all numbers of the parameters."""
        return self

    def _with_fields(self, **fields: Any) -> Any:
        """Return a system with other fields, which need no check; it does not have a name for stores."""
        system = object.__new__(type(self))
        vars(system).update(vars(self), **fields)
        caches = {"description", "family", "form", "free", "holding", "plain", "recipe", "slips", "table"}
        for name in caches - fields.keys():
            vars(system).pop(name, None)
        return system

    free = property(lambda self: self)
    """The system without the form of its constraint that may yield; itself if none may."""

    @property
    def plain(self) -> Any:
        """The same system without parameters."""
        return self

    def bound(self, *numbers: Any) -> Any:
        """Return the system whose functions have numbers of its parameters within."""
        return self

    def with_parameters(self, **numbers: Any) -> Any:
        """Return the same system with other numbers of its parameters; refused where there are none."""
        remedy = "Pass parameters= to a LagrangeDAlembert."
        raise error("with_parameters(...)", "be called on a system with parameters", type(self).__name__, remedy)

    def takes_time(self, function: str) -> bool:
        """Return whether a function is called with the time."""
        return False

    @property
    def has_parts(self) -> bool:
        """Whether parts of a step are defined."""
        return True

    def forced(self, potential: Any, force: Any) -> Any:
        """Return the system with a potential and a force; refused where there is no way to have them."""
        remedy = "Put them into a LagrangeDAlembert or an LLSystem."
        raise error("Forced(system=...)", "be a system that forces act on", type(self).__name__, remedy)

    def vector_field(self) -> Any:
        """Return the equations of motion, see `nonholo.vector_field`."""
        return importlib.import_module("nonholo.lagrange_dalembert").vector_field(self)

    def flow_from(self, begins: float) -> Any:
        """Return the continuous motion from a time on."""
        return importlib.import_module("nonholo.lagrange_dalembert").CoordinateFlow(self, begins)

    @abc.abstractmethod
    def discrete_map(self, time_step: Any) -> DiscretizationT:
        """Return the discretized system, see `nonholo.discretize`."""

    if not TYPE_CHECKING:
        discretize = _Former("nonholo.discretize(system, time_step)")
        flow = _Former("nonholo.flow(system, times=...)")


def in_coordinates(motion: Any) -> bool:
    """Return whether a map or a flow is one of a system in coordinates.

    Example:
        >>> in_coordinates(nh.discretize(nh.examples.particle().system, 0.1))
        True
    """
    return isinstance(motion.system, AbstractCoordinateSystem)
