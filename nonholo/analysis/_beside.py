r"""Motions beside a state, on groups and in coordinates. Needs JAX.

On a group the pose is seen from a frame that moves with the body velocity of the state: then
$\dot\xi = \omega - \omega_0 + [\xi, \omega_0]$ to first order, and a body that moves steadily stays where it is.
"""

import functools
from collections.abc import Callable
from typing import Any

import jax
import numpy as np
from scipy.integrate import solve_ivp

from nonholo.analysis._linearize import Local
from nonholo.base.checks import error
from nonholo.base.traced import FEW, call_in_blocks
from nonholo.base.types import Array, Float
from nonholo.continuous import vector_field
from nonholo.discrete import Discretization
from nonholo.discrete.definition import compile_double, step_slopes
from nonholo.lagrange_dalembert import CoordinateFlow, tangents
from nonholo.simulation import refuse_many_matrices, simulate
from nonholo.simulation.traced import definition_of
from nonholo.systems import AbstractCoordinateSystem, Start, central_differences, reach_of, refuse_slip, refuse_wide

_TIMES = np.array([0.0, 0.3719, 0.9173])  # not in a ratio that a rotation may have
_OTHERS, _SPREAD = 3, 0.3
_RTOL, _ATOL = 1e-11, 1e-12  # of the equations of variation


def on_group(owner: str, subject: Any, configuration: Any, velocity: Any) -> tuple[Local, Any]:
    """Return the changes beside a state of a system on a group, or of its map, and what gives states beside it."""
    is_map = isinstance(subject, Discretization)
    system: Any = subject.system if is_map else subject
    group, where = system.group, f"{owner}(system=...)"
    refuse_slip(where, system)
    if system.forces is not None and system.forces.table is not None:
        got, remedy = "one force for each step", "Linearize it without the table."
        raise error(where, "have forces that do not depend on time", got, remedy)
    refuse_wide(group)
    start = Start.of(owner, configuration, body_velocity=np.zeros(group.dim) if velocity is None else velocity)
    g = start.pose(group)
    r = system.from_canonical(start.momentum(system, g))
    rng, dim, count = np.random.default_rng(0), group.dim, len(_TIMES)
    if is_map:
        refuse_many_matrices("linearize(system=...)", subject, 6, "Linearize a smaller body.", derivatives=len(r))
        orbit = simulate(subject, momentum=r, configuration=g, steps=count)
        poses, momenta = orbit.configuration, orbit.restricted_momentum
    else:  # a motion that is steady
        poses = g @ group.exp(_TIMES[:, None] * _flowing(system)(np.float64(0), g, r)[0])
        momenta = np.tile(r, (count, 1))
    xi, s = _SPREAD * rng.uniform(-1, 1, (_OTHERS, dim)), _SPREAD * rng.uniform(-1, 1, (_OTHERS, len(r)))
    poses = np.concatenate([poses[:count], g @ group.exp(xi)])
    others = r + (np.abs(r).max() or 1.0) * s
    times = np.append(_TIMES, np.zeros(_OTHERS))
    change, slope = _slopes(subject, times, poses, np.concatenate([momenta[:count], others]))
    if is_map:  # where forces know the times of steps
        change = change.copy()
        change[:count, dim:] = np.diff(momenta, axis=0)
    rows = np.zeros((len(slope), 0, slope.shape[-1]))
    names = *(f"xi{i}" for i in range(1, 1 + dim)), *(f"r{i}" for i in range(1, 1 + len(r)))

    def beside(xi: Array, s: Array) -> tuple[np.ndarray, np.ndarray]:
        after = g @ group.exp(xi)
        return after, _flowing(system)(np.float64(0), after, r + s)[0]

    state = np.append(np.zeros(dim), r)
    return Local(names, dim, state, change, slope, rows, _TIMES, np.ones(len(r)), True), beside


def along(orbit: Any) -> Float[np.ndarray, "L d d"]:
    """Return the derivative of each state of a discrete orbit by the one before; momenta alone if they decide."""
    discrete, system, r = orbit.motion, orbit.motion.system, orbit.restricted_momentum[:-1]
    poses = orbit.configuration[:-1] if orbit.has_poses else np.tile(system.group.identity, (len(r), 1, 1))
    if _needs_function(discrete):
        slope = _by_differences(discrete, orbit.time[:-1], poses, r)[1] + np.eye(system.group.dim + system.rank)
    else:
        slope = _step_slopes(discrete, r, poses, orbit.canonical_chart[:-1])
    matters = slice(0 if system.forces is not None or system.is_spatial else system.group.dim, None)
    return slope[:, matters, matters]


def along_flow(orbit: Any) -> Float[np.ndarray, "L d d"]:
    """Return the derivative of each state of a flow by the one before, by the equations of variation."""
    system, (k, N), m = orbit.system, (orbit.system.rank, orbit.system.group.size), orbit.system.group.dim
    field, m = vector_field(system), m + k

    def rate(time: float, y: np.ndarray) -> np.ndarray:
        state, D = y[: k + N * N], y[k + N * N :].reshape(m, m)
        _, slope = _slopes(system, np.array([time]), state[k:].reshape(1, N, N), state[None, :k])
        return np.concatenate([field(time, state), (slope[0] @ D).ravel()])

    states = np.hstack([orbit.restricted_momentum, orbit.configuration.reshape(len(orbit), -1)])
    maps = np.empty((len(orbit) - 1, m, m))
    for i, state in enumerate(states[:-1]):
        span, begin = orbit.time[i : i + 2], np.append(state, np.eye(m))
        maps[i] = solve_ivp(rate, span, begin, "DOP853", rtol=_RTOL, atol=_ATOL).y[-m * m :, -1].reshape(m, m)
    return maps


def _flowing(system: Any) -> Callable[[Array, Array, Array], tuple[Array, Array]]:
    """Return the function that takes time, pose and momentum to velocity and rate."""
    field, group, k = vector_field(system), system.group, system.rank

    def move(time: Array, g: Array, r: Array) -> tuple[Array, Array]:
        rates = field(time, g.__array_namespace__().concatenate([r, g.ravel()]))
        return group.vee(group.inverse(g) @ rates[k:].reshape(g.shape)), rates[:k]

    return move


def _beside(subject: Any, time: Array, g: Array, r: Array) -> tuple[Callable[[Array], Array], Float[Array, "m"]]:
    """Return the change of a state as a function of what it is beside one, and where it is that state."""
    is_map, xp = isinstance(subject, Discretization), g.__array_namespace__()
    group = (subject.system if is_map else subject).group

    def step(_: Array, g: Array, r: Array) -> tuple[Array, Array]:  # to the next pose, and the change of momentum
        pair = simulate(subject, momentum=r, configuration=g, steps=1, throw=False)
        return pair.configuration[-1], pair.restricted_momentum[-1] - r

    move = step if is_map else _flowing(subject)
    first, _ = move(time, g, r)

    def change(z: Array) -> Array:
        xi, s = z[: group.dim], z[group.dim :]
        there, rate = move(time, g @ group.exp(xi), s)
        way = group.log(group.inverse(first) @ there) - xi if is_map else there - first + group.bracket(xi, first)
        return xp.concatenate([way, rate])

    return change, xp.concatenate([xp.zeros(group.dim), r])


def _needs_function(subject: Any) -> bool:
    return subject.forces is not None and subject.forces.needs_function


def _slopes(subject: Any, *states: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the changes beside states of a system or its map, and their derivatives."""
    if _needs_function(subject):
        return _by_differences(subject, *states)
    if not isinstance(subject, Discretization):
        change, slope = call_in_blocks(functools.partial(_by_jax, subject), FEW, *states)
        return change, slope
    _, poses, momenta = states
    pairs = [simulate(subject, momentum=r, configuration=g, steps=1) for g, r in zip(poses, momenta, strict=True)]
    slope = _step_slopes(subject, momenta, poses, np.stack([pair.canonical_chart[0] for pair in pairs]))
    change = np.stack([pair.restricted_momentum[1] - pair.restricted_momentum[0] for pair in pairs])
    return np.pad(change, ((0, 0), (slope.shape[-1] - change.shape[-1], 0))), slope - np.eye(slope.shape[-1])


def _step_slopes(discrete: Discretization, *states: np.ndarray) -> Float[np.ndarray, "K m m"]:
    return call_in_blocks(lambda *rows: (step_slopes(*definition_of(discrete), *rows),), FEW, *states)[0]


@compile_double
def _by_jax(system: Any, *states: Array) -> tuple[Array, Array]:
    def at(*state: Array) -> tuple[Array, Array]:
        change, z = _beside(system, *state)
        return change(z), jax.jacfwd(change)(z)

    return jax.vmap(at)(*states)


def _by_differences(subject: Any, *states: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return what a function of the user's leads to, which is not traced."""
    changes, slopes = [], []
    for change, z in (_beside(subject, *state) for state in zip(*states, strict=True)):
        offsets, weights = central_differences(len(z))
        ends = [[change(z + to) - change(z + fro) for to, fro in along] for along in offsets]
        changes.append(change(z))
        slopes.append(np.einsum("iwj,w->ji", np.array(ends), weights))
    return np.stack(changes), np.stack(slopes)


def beside_state(owner: str, subject: Any, configuration: Any, velocity: Any) -> tuple[Local, Any]:
    """Return the changes beside a state of a system or of its map, and the function that gives states beside it."""
    motion = CoordinateFlow(subject) if isinstance(subject, AbstractCoordinateSystem) else subject
    x, v = tangents.begin(motion, owner, configuration, velocity)
    places, units = np.concatenate([x[None], tangents.following(motion, x, v)]), tangents.units(motion.system, x, v)
    steady = tangents.slopes(motion, places, np.tile(v, (len(places), 1)))
    rng, n, coordinates = np.random.default_rng(0), len(v), motion.system.coordinates
    size = n + motion.system.is_driven
    state = np.append(x if coordinates else np.zeros(size), v)
    reach = reach_of(state[:n], units)
    slope = steady[1][0]
    fastest = np.abs(np.linalg.eigvals(slope)).max() if np.isfinite(slope).all() else 0.0  # of what moves beside rest
    speed = units * np.abs(v / units).max() if np.any(v) else reach * (fastest or 1.0) / (motion.time_step or 1.0)
    xi = _SPREAD * np.append(reach, np.ones(size - n)) * rng.uniform(-1, 1, (_OTHERS, size))
    others = tangents.beside(motion, x, v, xi, _SPREAD * speed * rng.uniform(-1, 1, (_OTHERS, n)))
    pairs = zip(steady, tangents.slopes(motion, *others), strict=True)
    change, slope, rows = (np.concatenate(pair) for pair in pairs)
    names = _names_of_coordinates(motion.system)
    times = np.append(0.0, tangents.LATER)

    def beside(xi: Array, w: Array) -> tuple[np.ndarray, np.ndarray]:
        places, velocities = tangents.beside(motion, x, v, xi[None], w[None])
        if motion.time_step is not None:
            velocities = tangents.departing(motion, places, velocities)
        return places[0][: len(places[0]) - motion.system.is_driven], velocities[0]

    return Local(names, size, state, change, slope, rows, times, units, not coordinates), beside


def _names_of_coordinates(system: Any) -> tuple[str, ...]:
    numbers, time = range(1, 1 + system.dimension), ("time",) * system.is_driven
    if not system.coordinates:
        return *(f"xi{i}" for i in numbers), *time, *(f"v{i}" for i in numbers)
    return *system.coordinates, *time, *(f"{name}'" for name in system.coordinates)
