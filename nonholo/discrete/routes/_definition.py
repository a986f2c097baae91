"""The route by the definition, for every discrete Lagrangian and variety; its JAX files load on first use."""

import dataclasses
from typing import Any, ClassVar

import numpy as np

from nonholo.base.checks import needs
from nonholo.base.types import Array, Float
from nonholo.discrete._pytrees import pytree
from nonholo.discrete._scheme import Difference, Scheme
from nonholo.discrete._variety import Constraint
from nonholo.discrete.routes._base import AbstractBodyStepper, AbstractRoute, Compact, posed
from nonholo.orbit import Orbit
from nonholo.systems import System


@pytree
@dataclasses.dataclass(frozen=True, eq=False)
class DefinitionRoute(Scheme, AbstractRoute):
    """The data of `_definition` and `_composition_definition`."""

    system: System
    time_step: Array
    difference: Difference
    constraint: Constraint
    order: int
    leaves: ClassVar[tuple[str, ...]] = ("system", "time_step")
    structure: ClassVar[tuple[str, ...]] = ("difference", "constraint", "order")
    name: ClassVar[str] = "definition"
    is_scalar: ClassVar[bool] = False
    needs_pose: ClassVar[bool] = True
    compiled: ClassVar[None] = None

    def stepper(self, motion: Any, *, posed: bool, branch: str = "principal") -> AbstractBodyStepper:
        """Return what takes the steps by the definition."""
        with needs("jax", "simulate(...) of a step that is not compiled"):
            from nonholo.discrete.definition import DefinitionStepper

        return DefinitionStepper(motion, posed, branch)

    def next_charts(self, states: Orbit) -> Float[np.ndarray, "K m"]:
        """Return the displacements that follow, one step of order 2 from each state."""
        with needs("jax", "A step that is not compiled"):
            from nonholo.discrete.definition import next_charts_by_definition

        return next_charts_by_definition(self, states)

    def parts(self, states: Orbit, fractions: Float[np.ndarray, "K"]) -> Compact:
        """Return momenta, charts and poses after fractions of the steps from states; NaN where none starts."""
        with needs("jax", "A part of a step that is not compiled"):
            from nonholo.discrete.definition import parts_by_definition

        return parts_by_definition(self, states, posed(states, needed=True), fractions)

    def whole_steps(self, momenta: Float[np.ndarray, "K k"], g: Float[np.ndarray, "K N N"]) -> Compact:
        """Take one step from each row of momenta and poses; return both after it, and the outcomes."""
        with needs("jax", "A step that is not compiled"):
            from nonholo.discrete.definition import whole_steps_by_definition

        return whole_steps_by_definition(self, momenta, g)
