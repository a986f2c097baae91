"""The interface of systems in coordinates."""

import abc
import importlib
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, ClassVar, Generic, NoReturn

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
    parameters: Mapping[str, Any]
    forced: Callable[..., Any]
    with_parameters: Callable[..., Any]

    def _with_fields(self, **fields: Any) -> Any:
        """Return a system with other fields, which need no check; it does not have a name for stores."""
        system = object.__new__(type(self))
        vars(system).update(vars(self), **fields)
        caches = {"description", "family", "form", "free", "holding", "plain", "recipe", "slips", "table"}
        for name in caches - fields.keys():
            vars(system).pop(name, None)
        return system

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
