"""The discrete map on a group: a system with a time step, its run, one step and the decoding."""

import dataclasses
import functools
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from nonholo.base.results import Outcome, finished
from nonholo.base.types import Array
from nonholo.lagrange_dalembert._blocks import State, checked_counts, decoded, run
from nonholo.lagrange_dalembert._newton import root
from nonholo.lagrange_dalembert._precision import in_double
from nonholo.lagrange_dalembert._start import fixed_time_step
from nonholo.lagrange_dalembert.on_groups import _equations as equations
from nonholo.lagrange_dalembert.on_groups import _start as start
from nonholo.lagrange_dalembert.on_groups._orbit import GroupOrbit
from nonholo.lagrange_dalembert.on_groups._system import GroupLagrangeDAlembert
from nonholo.systems import AbstractCoordinateDiscretization, one_start


@dataclasses.dataclass(frozen=True, eq=False)
class GroupDiscretization(AbstractCoordinateDiscretization):
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

    system: GroupLagrangeDAlembert
    time_step: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "time_step", fixed_time_step(self.time_step))

    def simulate(
        self,
        *,
        configuration: Any = None,
        steps: int,
        body_velocity: Any = None,
        displacement: Any = None,
        momentum: Any = None,
        save_every: int = 1,
        throw: bool = True,
        progress: bool = False,
    ) -> GroupOrbit:
        r"""Run the discrete map.

        $$ P(W_{k+1}) - \mathrm{Ad}^*_{W_k}P(W_k) = \sum_j\lambda_j a^j(g_{k+1}), \qquad F(g_{k+1}, W_{k+1}) = 0,
           \qquad g_{k+1} = g_k W_k . $$

        The map may be multivalued. Each step takes the root next to the last one, extrapolated; it is trusted if
        Newton's corrections shrink and no determinant changes its sign, and otherwise followed from the last step by
        continuation. Where the matrix of the equations is singular to rounding the run ends (`no_real_branch`).

        A velocity $\omega_0$ sets out with $P(W_0) = \partial l/\partial\omega + \sum_j\mu_j a^j(g_0)$ (second order),
        a momentum with itself in place of $\partial l/\partial\omega$.

        Args:
            configuration: $g_0$, a matrix of the group; the identity by default.
            steps: Number of steps N; unthinned orbits have N + 1 states.
            body_velocity: Start with this velocity, which must satisfy the constraint.
            displacement: Start with $W_0$, which must satisfy the discrete constraint.
            momentum: Start with this body momentum; only its action on admissible velocities counts.
            save_every: Steps between saved states.
            throw: Raise if the run cannot continue; otherwise return the good steps and the outcome.
            progress: Show a progress bar on standard error.

        Raises:
            ValueError: A bad argument, before any work.
            OutcomeError: With `throw`, the run could not continue; the error's `orbit` holds every good step.

        Example:
            >>> from nonholo.lagrange_dalembert import GroupLagrangeDAlembert, mass_tensor_lagrangian
            >>> free = GroupLagrangeDAlembert(nh.SO(3), mass_tensor_lagrangian(nh.SO(3), np.eye(3)), None)
            >>> orbit = free.discretize(0.5).simulate(momentum=(0.0, 0.0, 2.0), steps=4)  # 4 sin(angle)/2 = 2 * 0.5
            >>> print(orbit.body_velocity[-1].round(9) / np.pi * 6)
            [0. 0. 2.]
        """
        system, h = self.system, np.float64(self.time_step)
        steps, every = checked_counts(steps, save_every, 2 * (system.group.identity.size + system.group.dim))
        starts = {"body_velocity": body_velocity, "displacement": displacement, "momentum": momentum}
        given = one_start("simulate", **starts)
        g = start.pose("simulate", system, configuration)
        start.consistent(system, g, h)
        rows, code, done = run(_step, system, h, _first(system, h, g, given, starts[given]), steps, every, progress)
        return finished(_orbit(system, h, rows, Outcome(int(code)), every), h, done, steps, throw)


def _first(system: GroupLagrangeDAlembert, h: Any, g: np.ndarray, given: str, value: Any) -> tuple[State, Array, Array]:
    if given == "displacement":
        v, p = start.of_displacement(system, g, value, h)
    elif given == "momentum":
        v, p = start.of_momentum("simulate", system, g, value)
    else:
        v, p = start.of_velocity("simulate", system, g, value)
    return in_double(_set_out, system, h, g, v, p)


@functools.partial(jax.jit, static_argnums=0)
def _set_out(system: GroupLagrangeDAlembert, h: Array, g: Array, v: Array, p: Array) -> tuple[State, Array, Array]:
    """Return the first state, the orientation of the equations at the velocity v, and the outcome."""
    matrix, _, _ = equations.newton_matrix(system, g, v, h, equations.inertia(system, h))
    sign = jnp.sign(jnp.linalg.det(matrix))
    first, _, code = _solve(system, h, g, p, v, v, sign)
    return (g, first, first), sign, code


def _solve(
    system: GroupLagrangeDAlembert, h: Array, g: Array, p: Array, near: Array, guess: Array, sign: Array
) -> tuple[Array, Array, Array]:
    kinetic = equations.inertia(system, h)
    rows = equations.forms(system, g)
    return root(lambda v: equations.newton_matrix(system, g, v, h, kinetic), rows, p, near, guess, sign)


def _step(system: GroupLagrangeDAlembert, h: Array, state: State, sign: Array) -> tuple[State, Array, Array]:
    g, v, before = state
    _, arriving = equations.momenta(system, v, h)
    ahead = equations.normalized(system, g @ equations.displaced(system, v, h))
    following, multipliers, code = _solve(system, h, ahead, arriving, v, 2 * v - before, sign)
    return (ahead, following, v), multipliers, code


def _orbit(system: GroupLagrangeDAlembert, h: Any, rows: list[np.ndarray], outcome: Outcome, every: int) -> GroupOrbit:
    g, v, impulses = rows
    displacement, momentum, energy, residual = decoded(_decode, system, h, g, v)
    time = h * (every * np.arange(len(g)))
    return GroupOrbit(time, g, displacement, v, momentum, impulses, energy, residual, outcome)


@functools.partial(jax.jit, static_argnums=0)
def _decode(system: GroupLagrangeDAlembert, h: Array, g: Array, v: Array) -> tuple[Array, Array, Array, Array]:
    def one(g: Array, v: Array) -> tuple[Array, Array, Array, Array]:
        residual = jnp.max(jnp.abs(equations.discrete_constraints(system, g, v, h)), initial=0.0)
        momentum, energy = equations.momenta(system, v, h)[0], equations.discrete_energy(system, v, h)
        return equations.displaced(system, v, h), momentum, energy, residual

    return jax.vmap(one)(g, v)
