"""What maps in coordinates and on groups share."""

import dataclasses
import importlib
from collections.abc import Iterator
from typing import Any, cast

from nonholo.lagrange_dalembert._motion import CoordinateMotion
from nonholo.lagrange_dalembert._start import fixed_time_step
from nonholo.lagrange_dalembert._stepper import CoordinateStepper, after_parts
from nonholo.orbit import AbstractStepper
from nonholo.systems import AbstractCoordinateDiscretization, OrbitT


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
        object.__setattr__(self, "time_step", fixed_time_step(self.time_step))

    def stepper(self, *, posed: bool) -> AbstractStepper[Any]:
        """Return what takes its steps."""
        del posed
        return cast(Any, CoordinateStepper(self))

    def after_parts(self, states: OrbitT, fractions: Any) -> OrbitT:
        """Return what is reached from states of an orbit after fractions in (0, 1) of the steps that begin there."""
        return after_parts(self, states, fractions)

    def simulate(self, **run: Any) -> OrbitT:
        """Run the map: `nonholo.simulate(self, ...)`."""
        return importlib.import_module("nonholo.simulation").simulate(self, **run)

    def iterate(self, **run: Any) -> Iterator[OrbitT]:
        """Run the map block by block: `nonholo.iterate(self, ...)`."""
        return importlib.import_module("nonholo.simulation").iterate(self, **run)
