r"""The discrete maps: a system with a time step, and its run; what maps in coordinates and on groups share.

Steps in coordinates and on groups by the definition: of a start, of blocks of rows, and parts of steps.

After a fraction s of a step the motion is where the step of length s h from the same state leads. With momentum p at
the place q the velocity w of the part solves $P_{sh}(q, w) = p + \sum_j\mu_j A^j(q)$, $F_{sh} = 0$, next to the
velocity v of the whole step. The whole step from its end begins with the momentum $P^+_{sh}(q, w)$.
"""

import dataclasses
import functools
import math
from typing import Any, ClassVar, cast

import jax
import jax.numpy as jnp
import numpy as np

from nonholo.base.checks import assign, error, is_traced, scale
from nonholo.base.results import Outcome
from nonholo.base.traced import FEW, call_in_blocks
from nonholo.base.types import Array, Float
from nonholo.lagrange_dalembert import _equations as equations
from nonholo.lagrange_dalembert import _orbit as orbits
from nonholo.lagrange_dalembert import compiled
from nonholo.lagrange_dalembert._newton import orientation, solve
from nonholo.lagrange_dalembert._system import LagrangeDAlembert
from nonholo.lagrange_dalembert.functions import ROWS, configurations, in_double, in_rows, places, room
from nonholo.orbit import AbstractStepper, First, Rows, State
from nonholo.systems import AbstractCoordinateDiscretization, OrbitT, Start, one_start


@dataclasses.dataclass(frozen=True, eq=False)
class AbstractLagrangeDAlembertMap(orbits.CoordinateMotion, AbstractCoordinateDiscretization[OrbitT]):
    r"""A discretized system, which checks the start of a run.

    $$ D_1 L_d(q_k, q_{k+1}) + D_2 L_d(q_{k-1}, q_k) = -\sum_j \lambda_j A^j(q_k), \qquad F(q_k, q_{k+1}) = 0, $$

    and on a group $P(W_{k+1}) - \mathrm{Ad}^*_{W_k}P(W_k) = \sum_j\lambda_j a^j(g_{k+1})$, $F(g_{k+1}, W_{k+1}) = 0$,
    $g_{k+1} = g_k W_k$. The map may be multivalued. Each step takes the root next to the last one, extrapolated; it is
    trusted if Newton's corrections shrink and no determinant changes its sign, and otherwise followed from the last
    step by continuation. Where the matrix of the equations is singular to rounding the run ends (`no_real_branch`).

    A velocity $v_0$ sets out with $-D_1 L_d(q_0, q_1) = \partial L/\partial v + \sum_j \mu_j A^j(q_0)$ (second order),
    a momentum with itself in place of $\partial L/\partial v$; only its action on admissible velocities counts.

    Attributes:
        system: The system.
        time_step: h.
    """

    system: Any
    time_step: float

    def __post_init__(self) -> None:
        where = "discretize(time_step=...)"
        if is_traced(self.time_step):
            remedy = "Runs in coordinates are compiled by themselves: call them outside jax.jit and jax.grad."
            raise error(where, "be a number", "a traced value", remedy)
        assign(self, time_step=float(scale(where, self.time_step, "Pass a positive real time step.")))

    def first(self, start: Start, *, with_poses: bool) -> First:
        """Return the checked momentum, place and velocity of a start."""
        del with_poses
        system, h, subject = self.system.free, np.float64(self.time_step), (start.owner, self.system.free)
        checks = room("_start")
        q = checks.point(*subject, start.configuration, project=start.project)
        checks.consistent(system, q, h)
        if start.name == "momentum":
            return First(checks.of_momentum(*subject, q, start.value))
        if start.name == "displacement" and self.system.slips:
            got, remedy = "a Slip, which decides over it", "Pass body_velocity= or momentum=."
            raise error(f"{start.owner}(displacement=...)", "be of forms that never yield", got, remedy)
        if start.name == "displacement":
            v = checks.velocity_of_displacement(system, q, start.value, h)
            return First((in_double(equations.momenta, system, q, v, h)[0], q, v))
        return First(checks.velocity(*subject, q, start.value, project=start.project))

    @functools.cached_property
    def _stepper(self) -> AbstractStepper[OrbitT]:
        return cast(Any, room("_slipping").SlipStepper if self.system.slips else CoordinateStepper)(self)

    def stepper(self, *, with_poses: bool) -> AbstractStepper[OrbitT]:
        """Return what takes its steps."""
        del with_poses
        return self._stepper

    def after_parts(self, states: Any, fractions: Float[np.ndarray, "K"]) -> Any:
        """Return what is reached after fractions of the steps from states; NaN where there is no such step."""
        system, h, number = self.system, np.float64(self.time_step), np.arange(len(states))
        x, v = places(system, states.configuration, states.time), states.body_velocity
        run = functools.partial(in_double, _after_parts, system, h)
        ends, ahead = call_in_blocks(run, FEW, number, fractions, x, v, states.momentum)
        none = np.empty((0, system.constraints))
        orbit = CoordinateStepper(self).orbit((ends, ahead, none), 0, 1, Outcome.successful)
        step = states.step + fractions.astype(np.int64)
        return dataclasses.replace(orbit, time=states.time + fractions * h, step=step, events=states.events)


@dataclasses.dataclass(frozen=True, eq=False)
class CoordinateDiscretization(AbstractLagrangeDAlembertMap[orbits.CoordinateOrbit]):
    """A discretized system in coordinates, made by `nonholo.discretize`.

    Attributes:
        system: The system.
        time_step: h.

    Example:
        >>> from nonholo.lagrange_dalembert import CoordinateDiscretization, LagrangeDAlembert
        >>> CoordinateDiscretization(LagrangeDAlembert(lambda q, v: v @ v, None, dimension=2), 0.5).time_step
        0.5
    """

    system: LagrangeDAlembert

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
            >>> round(nh.discretize(free, 0.5).regularity((0, 0), (1, 2)), 12)
            1.0
        """
        return self.system.regularity(q, q_next, time_step=self.time_step)


@dataclasses.dataclass(frozen=True, eq=False)
class GroupDiscretization(AbstractLagrangeDAlembertMap[orbits.GroupOrbit]):
    """A discretized `GroupLagrangeDAlembert`, made by `nonholo.discretize`.

    Attributes:
        system: The system.
        time_step: h.

    Example:
        >>> from nonholo.lagrange_dalembert import GroupLagrangeDAlembert, mass_tensor_lagrangian
        >>> free = GroupLagrangeDAlembert(nh.SO(3), mass_tensor_lagrangian(nh.SO(3), np.eye(3)), None)
        >>> nh.discretize(free, 0.5).time_step
        0.5
    """


MAPS: dict[str, Any] = {"CoordinateOrbit": CoordinateDiscretization, "GroupOrbit": GroupDiscretization}
"""The discretized systems by the names of their orbits."""


def checked_state(
    system: Any, configuration: Any, starts: dict[str, Any], time: float, owner: str = "flow", *, project: bool = False
) -> tuple[np.ndarray, np.ndarray]:
    """Return the checked start of a flow, or another place and velocity."""
    checks, name = room("_start"), one_start(owner, **starts)
    q = checks.point(owner, system, configuration, time, project=project)
    if name == "momentum":
        return checks.of_momentum(owner, system, q, starts[name])[1:]
    return checks.velocity(owner, system, q, starts[name], project=project)[1:]


@dataclasses.dataclass(frozen=True, eq=False)
class CoordinateStepper(AbstractStepper[orbits.AbstractCoordinateOrbit]):
    """The steps of a discretized system in coordinates or on a group.

    A row is a place (with the time, of a driven system), the velocity of the step from there and its impulse. The
    velocity of the step before and the orientation to keep are its own numbers.

    Attributes:
        motion: The discretization.
    """

    motion: Any
    branch = "nearest"
    in_threads = False
    lead: ClassVar[int] = 0
    block = 1 << 18

    @functools.cached_property
    def columns(self) -> dict[str, int]:  # type: ignore[override]
        """The names and sizes of what a row holds."""
        system = self.motion.system
        place, rate = map(math.prod, (system.place_shape, system.shapes[1]))
        return {"place": place, "body_velocity": rate, "multipliers": system.constraints}

    @property
    def part_refused(self) -> str | None:
        """Why a step has no parts; None if it has."""
        why = "a table of forces, or discrete functions without a time step"
        return None if self.motion.system.has_parts else why

    def start(self, first: First) -> tuple[State, Outcome]:
        """Return the state at the root next to a velocity."""
        system, h, (p, q, v) = self.motion.system, np.float64(self.motion.time_step), first.numbers
        motion, sign, code = compiled.set_out(system, h, q, v, p) or in_double(set_out, system, h, q, v, p)
        return self._state(motion, sign), Outcome(int(code))

    def advance(self, state: State, steps: int, every: int, rows: Rows) -> tuple[int, int]:
        """Take steps by compiled formulas, or by JAX."""
        system, h = self.motion.system, np.float64(self.motion.time_step)
        by_jax, sign = functools.partial(in_double, _advance, system, h), state[-1]
        table = tuple(column[: steps // every] for column in rows)
        place, rate, _ = self.columns.values()
        motion = self._places(state[:place])[0], state[place : place + rate], state[-1 - rate : -1]
        count, motion, code = compiled.advance(by_jax, system, h, motion, sign, every, table)
        for column, entries in zip(rows, (*motion[:2], np.nan), strict=True):
            if count % every == 0:
                column[count // every] = np.ravel(entries)
        state[:] = self._state(motion, sign)
        return count, int(code)

    def orbit(self, rows: Rows, step: int, every: int, outcome: Outcome) -> orbits.AbstractCoordinateOrbit:
        """Return rows as an orbit, with all that they tell."""
        system, h = self.motion.system, np.float64(self.motion.time_step)
        q, (_, v, impulses) = self._places(rows[0]), rows
        columns = compiled.decoded(_decode, system, h, q, v)
        columns = columns or call_in_blocks(functools.partial(in_rows, _decode, system, h), ROWS, q, v)
        displacement, momentum, energy, residual = columns
        number = step + every * np.arange(len(q))
        arrays = h * number, configurations(system, q), displacement, v, momentum, impulses, energy, residual
        return orbits.ORBITS[system.orbits](*arrays, outcome, system, float(h), every, step=number)

    def matrices(self, rows: Rows) -> Float[np.ndarray, "K N N"]:
        """Return the poses."""
        return configurations(self.motion.system, self._places(rows[0]))

    def _places(self, rows: np.ndarray) -> np.ndarray:
        """Return places from flat ones."""
        return rows.reshape(-1, *self.motion.system.place_shape)

    def _state(self, motion: tuple[Array, Array, Array], sign: Any) -> State:
        q, v, before = motion
        impulse = np.zeros(self.motion.system.constraints)  # unknown; a store takes NaN for a chunk that is lost
        return np.concatenate([q.ravel(), v, impulse, before, [sign]])


def set_out(system: Any, h: Array, q: Array, v: Array, p: Array) -> tuple[tuple[Array, Array, Array], Array, Array]:
    """Return the start with a momentum, by the root next to the velocity v, with its orientation and outcome.

    A start is a place, the velocity of its step, and the velocity of the step before.
    """
    sign, _ = orientation(system, q, v, h)
    first, _, code = solve(system, h, q, p, v, v, sign)
    return (q, first, first), sign, code


def _advance(system: Any, h: Array, state: tuple[Array, Array, Array], sign: Array, steps: Array) -> tuple:
    """Take steps, at most `ROWS`; return how many were good, the end, the outcome, and the states with impulses."""

    def one(carry: tuple) -> tuple:
        count, current, _, table = carry
        q, v, before = current
        ahead, arriving = equations.arrival(system, q, v, h)
        following, multipliers, code = solve(system, h, ahead, arriving, v, 2 * v - before, sign)
        next_state = jax.tree.map(lambda new, old: jnp.where(code == 0, new, old), (ahead, following, v), current)
        table = [rows.at[count].set(new) for rows, new in zip(table, (q, v, multipliers), strict=True)]
        return count + (code == 0), next_state, code, table

    table = [jnp.zeros((ROWS, *shape)) for shape in (state[0].shape, state[1].shape, (system.constraints,))]
    start = (jnp.asarray(0), state, jnp.asarray(0), table)
    return jax.lax.while_loop(lambda c: (c[0] < steps) & (c[2] == 0), one, start)


def _decode(system: Any, h: Array, q: Array, v: Array, *node: Array) -> tuple[Array, ...]:
    """Return displacement, momentum, energy and residual of a state."""
    residual = jnp.max(jnp.abs(equations.discrete_constraints(system, q, v, h)), initial=0.0)
    momentum, energy = equations.momenta(system, q, v, h)[0], equations.discrete_energy(system, q, v, h, *node)
    return system.places.displacement(v, h), momentum, energy, residual


def _after_parts(system: Any, h: Array, number: Array, fractions: Array, x: Array, v: Array, p: Array) -> tuple:
    """Return the places after parts of steps, and the velocities of the whole steps that begin there.

    One after another: the bits of each do not depend on the others. Rows with the number of the last one are left out.
    """

    def leg(carry: tuple[Array, Array, Array], length: Array) -> tuple[tuple[Array, Array, Array], tuple]:
        begin, near, p = carry
        (_, w, _), _, code = set_out(system, length, begin, near, p)
        ahead, arriving = equations.arrival(system, begin, w, length)
        return (ahead, w, arriving), (begin, w, code)

    def one(carry: tuple[Array, Array, Array]) -> tuple[Array, Array, Array]:
        i, places, velocities = carry
        _, (begins, w, codes) = jax.lax.scan(leg, (x[i], v[i], p[i]), jnp.stack([fractions[i] * h, h]))
        end = jnp.where(codes[0] == 0, begins[1], jnp.nan)
        return i + 1, places.at[i].set(end), velocities.at[i].set(jnp.where(jnp.all(codes == 0), w[1], jnp.nan))

    return jax.lax.while_loop(lambda c: c[0] <= number[-1] - number[0], one, (jnp.asarray(0), x, v))[1:]
