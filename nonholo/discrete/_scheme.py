"""The parts of the equations of a step: all of a discretization that they and the routes see."""

import functools
from collections.abc import Callable

from nonholo.base.types import Array
from nonholo.discrete._variety import Constraint, Variety, variety_of
from nonholo.systems import System

Difference = str | Callable[[Array], Array]


class Scheme:
    """A system, a time step, a discrete Lagrangian and a displacement variety.

    A class of its own, not a protocol: to try whether an object obeys one would ask it for its variety, whose matrices
    fill the memory for wide bodies.

    Attributes:
        system: What moves.
        time_step: The time step h.
        difference: The discrete Lagrangian: "matrix", "logarithmic" or a callable.
        constraint: The name of the variety, or its functions.
        order: 2, or that of a composition.
    """

    system: System
    time_step: Array
    difference: Difference
    constraint: Constraint
    order: int

    @functools.cached_property
    def variety(self) -> Variety:
        """The displacement variety in the canonical frame."""
        return variety_of(self.system, self.constraint)
