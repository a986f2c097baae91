"""The interface of systems in coordinates, which discretise, run and flow by themselves."""

import abc
from typing import Any


class AbstractCoordinateDiscretization(abc.ABC):
    """A discretised system in coordinates: `nonholo.simulate` hands its arguments on to it."""

    @abc.abstractmethod
    def simulate(self, **arguments: Any) -> Any:
        """Run the discrete map."""


class AbstractCoordinateSystem(abc.ABC):
    """A system in coordinates: `nonholo.discretize` and `nonholo.flow` hand their arguments on to it."""

    @abc.abstractmethod
    def discretize(self, time_step: Any) -> AbstractCoordinateDiscretization:
        """Return the discretised system."""

    @abc.abstractmethod
    def flow(self, **arguments: Any) -> Any:
        """Solve the continuous equations."""
