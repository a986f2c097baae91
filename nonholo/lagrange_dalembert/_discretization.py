"""The discrete maps: a system with a time step, and its run; what maps in coordinates and on groups share."""

import dataclasses
import functools
import importlib
from collections.abc import Iterator
from typing import Any, cast

import numpy as np

from nonholo.base.checks import error, is_traced, scale
from nonholo.lagrange_dalembert._motion import CoordinateMotion
from nonholo.lagrange_dalembert._orbit import CoordinateOrbit, GroupOrbit
from nonholo.lagrange_dalembert._room import equations_of, in_double, room
from nonholo.lagrange_dalembert._stepper import CoordinateStepper, after_parts
from nonholo.lagrange_dalembert._system import LagrangeDAlembert
from nonholo.orbit import AbstractStepper, First
from nonholo.systems import AbstractCoordinateDiscretization, OrbitT, Start, one_start


@dataclasses.dataclass(frozen=True, eq=False)
class AbstractLagrangeDAlembertMap(CoordinateMotion, AbstractCoordinateDiscretization[OrbitT]):
    r"""A discretized system: it says how a run starts.

    $$ D_1 L_d(q_k, q_{k+1}) + D_2 L_d(q_{k-1}, q_k) = -\sum_j \lambda_j A^j(q_k), \qquad F(q_k, q_{k+1}) = 0, $$

    and on a group $P(W_{k+1}) - \mathrm{Ad}^*_{W_k}P(W_k) = \sum_j\lambda_j a^j(g_{k+1})$, $F(g_{k+1}, W_{k+1}) = 0$,
    $g_{k+1} = g_k W_k$. The map may be multivalued. Each step takes the root next to the last one, extrapolated; it is
    trusted if Newton's corrections shrink and no determinant changes its sign, and otherwise followed from the last
    step by continuation. Where the matrix of the equations is singular to rounding the run ends (`no_real_branch`).

    A velocity $v_0$ sets out with $-D_1 L_d(q_0, q_1) = \partial L/\partial v + \sum_j \mu_j A^j(q_0)$ (second order),
    a momentum with itself in place of $\partial L/\partial v$; only its action on admissible velocities counts.

    Attributes:
        system: What moves.
        time_step: h.
    """

    system: Any
    time_step: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "time_step", _fixed_time_step(self.time_step))

    def first(self, start: Start, *, posed: bool) -> First:
        """Return the checked momentum, place and velocity of a start."""
        del posed
        system, h, given = self.system, np.float64(self.time_step), (start.owner, self.system)
        checks, equations = room(system._start), equations_of(system)
        q = checks.point(*given, start.configuration)
        checks.consistent(system, q, h)
        if start.name == "momentum":
            return First(checks.of_momentum(*given, q, start.value))
        if start.name == "displacement":
            v = checks.velocity_of_displacement(system, q, start.value, h)
            return First((in_double(equations.momenta, system, q, v, h)[0], q, v))
        v = checks.velocity(*given, q, start.value)
        return First((in_double(equations.momentum, system, q, v), q, v))

    @functools.cached_property
    def _stepper(self) -> AbstractStepper[Any]:
        return cast(Any, CoordinateStepper(self))

    def stepper(self, *, posed: bool) -> AbstractStepper[Any]:
        """Return what takes its steps."""
        del posed
        return self._stepper

    def after_parts(self, states: OrbitT, fractions: Any) -> OrbitT:
        """Return what is reached from states of an orbit after fractions in (0, 1) of the steps that begin there."""
        return after_parts(self, states, fractions)

    def simulate(self, **run: Any) -> OrbitT:
        """Run the map: `nonholo.simulate(self, ...)`."""
        return importlib.import_module("nonholo.simulation").simulate(self, **run)

    def iterate(self, **run: Any) -> Iterator[OrbitT]:
        """Run the map block by block: `nonholo.iterate(self, ...)`."""
        return importlib.import_module("nonholo.simulation").iterate(self, **run)


@dataclasses.dataclass(frozen=True, eq=False)
class CoordinateDiscretization(AbstractLagrangeDAlembertMap[CoordinateOrbit]):
    """A discretized system in coordinates, made by `nonholo.discretize`.

    Attributes:
        system: What moves.
        time_step: h.

    Example:
        >>> from nonholo.lagrange_dalembert import CoordinateDiscretization, LagrangeDAlembert
        >>> CoordinateDiscretization(LagrangeDAlembert(lambda q, v: v @ v, None, dimension=2), 0.5).time_step
        0.5
    """

    system: LagrangeDAlembert
    time_step: float

    def regularity(self, q: Any, q_next: Any) -> float:
        """Return the smallest singular value of the scaled regularity matrix of a step; zero at a fold.

        Args:
            q: Configuration.
            q_next: The next configuration.

        Raises:
            ValueError: A wrong shape, or a value that is not finite.

        Example:
            >>> from nonholo.lagrange_dalembert import LagrangeDAlembert
            >>> free = LagrangeDAlembert(lambda q, v: 3 * v @ v, None, dimension=2)
            >>> round(free.discretize(0.5).regularity((0, 0), (1, 2)), 12)
            1.0
        """
        return self.system.regularity(q, q_next, time_step=self.time_step)


@dataclasses.dataclass(frozen=True, eq=False)
class GroupDiscretization(AbstractLagrangeDAlembertMap[GroupOrbit]):
    """A discretized `GroupLagrangeDAlembert`, made by its `discretize`.

    Attributes:
        system: What moves.
        time_step: h.

    Example:
        >>> from nonholo.lagrange_dalembert import GroupLagrangeDAlembert, mass_tensor_lagrangian
        >>> free = GroupLagrangeDAlembert(nh.SO(3), mass_tensor_lagrangian(nh.SO(3), np.eye(3)), None)
        >>> free.discretize(0.5).time_step
        0.5
    """

    system: Any
    time_step: float


def checked_state(
    system: Any, configuration: Any, starts: dict[str, Any], time: float, owner: str = "flow"
) -> tuple[np.ndarray, np.ndarray]:
    """Return the checked start of a flow, or another place and velocity."""
    checks, name = room(system._start), one_start(owner, **starts)
    q = checks.point(owner, system, configuration, time)
    if name == "momentum":
        return checks.of_momentum(owner, system, q, starts[name])[1:]
    return q, checks.velocity(owner, system, q, starts[name])


def _fixed_time_step(value: Any) -> float:
    """Return a positive time step that is a number."""
    where = "discretize(time_step=...)"
    if is_traced(value):
        remedy = "Runs in coordinates are compiled by themselves: call them outside jax.jit and jax.grad."
        raise error(where, "be a number", "a traced value", remedy)
    return float(scale(where, value, "Pass a positive real time step."))
