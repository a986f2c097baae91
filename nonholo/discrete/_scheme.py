"""The parts of the equations of a step: all of a discretization that they and the routes see."""

from collections.abc import Callable
from typing import Protocol, runtime_checkable

from nonholo.base.types import Array
from nonholo.discrete._variety import Constraint, Variety
from nonholo.systems import System

Difference = str | Callable[[Array], Array]


@runtime_checkable
class Scheme(Protocol):
    """A system, a time step, a discrete Lagrangian and a displacement variety."""

    @property
    def system(self) -> System:
        """The system that moves."""
        ...

    @property
    def time_step(self) -> Array:
        """The time step h."""
        ...

    @property
    def difference(self) -> Difference:
        """The discrete Lagrangian: "matrix", "logarithmic" or a callable."""
        ...

    @property
    def constraint(self) -> Constraint:
        """The name of the variety, or its functions."""
        ...

    @property
    def variety(self) -> Variety:
        """The displacement variety in the canonical frame."""
        ...

    @property
    def order(self) -> int:
        """The order: 2, or that of a composition."""
        ...
