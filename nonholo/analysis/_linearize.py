"""Steady motions of flows and maps, the linear equations beside them, and where these lose their stability."""

import functools
import itertools
from collections.abc import Callable, Iterator, Sequence
from typing import Any, NamedTuple, cast

import numpy as np
import scipy.linalg
from scipy.optimize import bisect, brentq

from nonholo.base.checks import array, count, error, function, instance, needs, shown
from nonholo.base.memo import Keeper
from nonholo.base.results import result
from nonholo.base.types import Float, Inexact, Int
from nonholo.discrete import Discretization
from nonholo.systems import AbstractCoordinateDiscretization, AbstractCoordinateSystem, AbstractSystem, extent_of

_CHOICES = 1000  # of velocities
_SHARE = 0.05  # least singular value of the dependent columns of constraints, orthonormal in units of equal energy
_UNSEEN = 1e-11  # of the largest derivative
_STEADY = 1e-7  # of the extent of a state


class Local(NamedTuple):
    """Changes beside some states: the steady one, the same later, and others that show what depends on what.

    Attributes:
        names: Those of m numbers of a state: first coordinates seen from its place, then velocities or momenta.
        places: How many of them are coordinates.
        state: The steady state, shape (m,), of poses seen from there.
        change: Rates of the states, or what a step adds to them, shape (K, m).
        slope: Their derivatives by the states, shape (K, m, m).
        rows: Derivatives of the constraints, shape (K, s, m); those of holonomic ones by velocities are zero.
        times: Those of the first states, which are the steady motion.
        units: Units of the velocities, in which each has the same kinetic energy, shape (n,).
        is_carried: Whether places are seen from a frame that moves with the state; those in coordinates are not.
    """

    names: tuple[str, ...]
    places: int
    state: Float[np.ndarray, "m"]
    change: Float[np.ndarray, "K m"]
    slope: Float[np.ndarray, "K m m"]
    rows: Float[np.ndarray, "K s m"]
    times: Float[np.ndarray, "1+L"]
    units: Float[np.ndarray, "n"]
    is_carried: bool


class Reduced(NamedTuple):
    """The linear equations of the states that matter.

    Attributes:
        states: Numbers of these states.
        matrix: Derivatives of their changes.
        defect: Their changes, which vanish in a steady motion.
        directions: Changes of the whole state, a column for each of these states.
        is_steady: Whether they do, and the derivatives stay the same.
        ignorable: Numbers of the coordinates that are left out.
        units: Units of all numbers of a state.
        extent: The size of the state in these.
        rate: The largest derivative in these.
    """

    states: Int[np.ndarray, "d"]
    matrix: Float[np.ndarray, "d d"]
    defect: Float[np.ndarray, "d"]
    directions: Float[np.ndarray, "m d"]
    is_steady: bool
    ignorable: Int[np.ndarray, "_"]
    units: Float[np.ndarray, "m"]
    extent: float
    rate: float


def reduced(local: Local) -> Reduced:
    """Return the equations in the velocities that leave the fewest coordinates, steady if there are such."""
    rows, places = local.rows[0], local.places
    of_places = ~rows[:, places:].any(axis=1)  # holonomic constraints
    sizes = np.resize(local.units, places)  # with one for the time
    holonomic = list(next(_choices(rows[of_places, :places] * sizes)))
    choices = _choices(rows[~of_places, places:] * local.units)
    equations = (_without(local, holonomic + [places + i for i in dependent]) for dependent in choices)
    return min(equations, key=lambda each: (not each.is_steady, len(each.states)))


def _choices(rows: Float[np.ndarray, "s n"]) -> Iterator[tuple[int, ...]]:
    """Return sets of velocities that may depend on the others, those of the first coordinates first."""
    s, n = rows.shape
    across = np.linalg.qr(rows.T)[0]
    order: Any = scipy.linalg.qr(across.T, mode="r", pivoting=True)[-1] if s else ()
    for choice in itertools.islice(itertools.combinations(range(n), s), _CHOICES):
        if not s or np.linalg.svd(across[list(choice)], compute_uv=False)[-1] > _SHARE:
            yield choice
    yield tuple(map(int, order[:s]))


def _without(local: Local, dependent: list[int]) -> Reduced:
    independent = np.setdiff1d(np.arange(len(local.state)), dependent)
    dependence = -np.linalg.solve(local.rows[:, :, dependent], local.rows[:, :, independent])
    slope = local.slope[:, independent][:, :, independent] + local.slope[:, independent][:, :, dependent] @ dependence
    change, count, sizes = local.change[:, independent], len(local.times), _sizes(local)
    ratios = sizes / sizes[:, None]

    # a change depends on a state if it does so anywhere where the derivatives are finite, directly or by other states
    finite = np.abs(slope * ratios[independent][:, independent])
    finite = finite[np.isfinite(finite).all(axis=(1, 2))]
    depends = np.any(finite > _UNSEEN * finite.max(axis=(1, 2), initial=0.0, keepdims=True), axis=0)
    matters = independent >= local.places
    while np.any(more := depends[matters].any(axis=0) & ~matters):
        matters |= more

    states = independent[matters]
    matrix, defects, units = slope[:count, matters][:, :, matters], change[:count, matters], sizes[states]
    rates, largest = matrix * ratios[states][:, states], np.abs(local.slope[0] * ratios).max()
    free = independent[independent < local.places]
    ignorable, places = np.setdiff1d(free, states), states[states < local.places]
    extents = np.abs(local.state) / sizes
    first = places if len(places) else states
    extents += extent_of(local.state[first], sizes[first])
    bound = _STEADY * np.abs(rates[0]) @ extents[states] + _UNSEEN * largest * extents[states].max(initial=0.0)
    same = np.abs(rates - rates[0]).max(initial=0.0) <= _STEADY * largest
    is_steady = bool(same and np.all(np.abs(defects) / units <= bound))
    worst = defects[np.argmax(np.abs(defects).max(axis=1, initial=0.0))]
    directions = np.eye(len(local.state))[:, independent]
    directions[dependent] = dependence[0]
    extent = np.delete(extents, ignorable).max()
    return Reduced(states, matrix[0], worst, directions[:, matters], is_steady, ignorable, sizes, extent, largest)


def _sizes(local: Local) -> Float[np.ndarray, "m"]:
    """Return units of all numbers of a state: velocities of one energy, and their paths in the shortest time."""
    sizes = np.append(np.resize(local.units, local.places), local.units)
    finite, n = local.slope[np.isfinite(local.slope).all(axis=(1, 2))], local.places
    largest = np.abs(finite * (sizes / sizes[:, None])).max(axis=0, initial=0.0)
    moves, pulls, drags = (x.max(initial=0.0) for x in (largest[:n, n:], largest[n:, :n], largest[n:, n:]))
    rate = max(np.sqrt(pulls * moves), drags)
    sizes[:n] *= moves / rate if rate * moves > 0 else 1.0
    return sizes


@result
class Linearization(Keeper):
    r"""The linear equations beside a steady motion, $\delta\dot z = A\,\delta z$, of a map $\delta z' = A\,\delta z$.

    Attributes:
        matrix: A, shape (d, d).
        names: The names of the states z. In coordinates those of coordinates, and of independent velocities with a
            prime; on groups "xi1", ... of the pose $g\,e^\xi$, then "r1", ... of momenta along the rows of the
            constraint subspace, or "v1", ... of body velocities.
        ignorable: Coordinates on which no velocity depends. They are left out, and may move; each of them has a further
            eigenvalue 0, of a map 1.
        time_step: h of a map; None of a flow.
        rate: The largest derivative in units in which velocities have equal energy: rounding moves eigenvalues by some
            1e-16 of it.
    """

    matrix: Float[np.ndarray, "d d"]
    names: tuple[str, ...]
    ignorable: tuple[str, ...]
    time_step: float | None
    rate: float = 0.0

    @property
    def eigenvalues(self) -> Inexact[np.ndarray, "d"]:
        """Rates, the one that grows fastest first; of a map multipliers of a step, the largest first.

        Of those that grow alike, to nine digits, the fastest oscillation is first.
        """
        return self._spectrum[0]

    @property
    def modes(self) -> Inexact[np.ndarray, "d d"]:
        """Columns in the order of the eigenvalues, of length one; rows belong to the names."""
        return self._spectrum[1]

    @functools.cached_property
    def _spectrum(self) -> tuple[np.ndarray, np.ndarray]:
        values, modes = np.linalg.eig(self.matrix)
        size = np.real(values) if self.time_step is None else np.abs(values)
        growth = np.round(size / (np.abs(values).max(initial=0.0) or 1.0), 9)  # rounding orders nothing
        order = np.lexsort((-np.imag(values), -np.abs(np.imag(values)), -growth))
        return values[order], modes[:, order]

    def to_pandas(self) -> Any:
        """Return a `pandas.DataFrame` with a row for each eigenvalue and a column for each state of its mode."""
        import pandas

        table = pandas.DataFrame(self.modes.T, columns=list(self.names))
        table.insert(0, "eigenvalue", self.eigenvalues)
        return table


def linearize(system: Any, *, configuration: Any = None, body_velocity: Any = None) -> Linearization:
    r"""Linearize a system, or its discrete map, beside a steady motion or at rest.

    $$ \delta\dot z = \frac{\partial f}{\partial z}\,\delta z, \qquad
       \delta z' = \frac{\partial z_{k+1}}{\partial z_k}\,\delta z, $$

    where z are the states on which anything depends. In coordinates they are the coordinates and n - s independent
    velocities; the constraints $A v = b$ give the others. Coordinates that no equation contains, such as the place and
    the heading of a vehicle on a plane, are left out: they may move, all others and the independent velocities have to
    be constant. On a group z has the momenta along the constraint, $r = S\,\mathbb{I}\omega$, and where forces depend
    on the pose $\xi$ of $g\,e^\xi$, seen from a body that moves on steadily. So a top in steady precession counts.

    Derivatives are exact, by JAX; those of forces and potentials that are functions, on groups, are central
    differences of order 6. Dependences are seen at the state and three more, up to 1e-11 of the largest
    derivative. The step of a map begins as `simulate` begins, with `body_velocity`.

    Args:
        system: Any system, on a group or in coordinates, or what `discretize` made of it.
        configuration: Where it is; on a group the identity by default.
        body_velocity: Its velocity, which must satisfy the constraint; at rest by default.

    Raises:
        ValueError: Something else, a table of forces, a system without matrices, a bad state, or one that is not
            steady: the error has its rates.

    Example:
        A sleigh that moves ahead, with the center of mass in front of the blade, loses all turning:

        >>> sleigh = nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.5)
        >>> nh.linearize(sleigh, body_velocity=(0.0, 2.0, 0.0)).eigenvalues
        array([ 0. , -0.8])

        A pendulum, upside down:

        >>> import jax.numpy as jnp
        >>> pendulum = nh.LagrangeDAlembert(lambda q, v: v @ v / 2 + jnp.cos(q[0]), None, dimension=1)
        >>> motion = nh.linearize(pendulum, configuration=[np.pi])
        >>> motion.names, motion.eigenvalues.round(12)
        (('q1', "q1'"), array([ 1., -1.]))
    """
    local, _ = local_motion("linearize", system, configuration, body_velocity)
    where = "linearize(body_velocity=...)"
    if not (np.isfinite(local.slope[0]).all() and np.isfinite(local.rows[0]).all()):
        remedy = "Take a smaller time step, or another state."
        raise error(where, "have a finite linearization", f"none at {local.state.tolist()}", remedy)
    equations = reduced(local)
    names = tuple(local.names[i] for i in equations.states)
    if not equations.is_steady:
        rates = ", ".join(f"{name}: {rate:.6g}" for name, rate in zip(names, equations.defect, strict=True))
        remedy = "Pass a state of rest or of a steady motion; coordinates that matter have to stay."
        raise error(where, "be that of a steady motion", f"rates {rates}", remedy)
    ignorable = tuple(local.names[i] for i in equations.ignorable)
    step = getattr(system, "time_step", None)
    matrix = equations.matrix if step is None else np.eye(len(names)) + equations.matrix
    return Linearization(matrix, names, ignorable, step, equations.rate)


def local_motion(owner: str, system: Any, configuration: Any, velocity: Any) -> tuple[Local, Any]:
    """Return the changes beside a state, and what takes changes of places and velocities to a state beside it."""
    if isinstance(system, AbstractCoordinateSystem | AbstractCoordinateDiscretization):
        return door(owner).beside_state(owner, system, configuration, velocity)
    if not isinstance(system, AbstractSystem | Discretization):
        remedy = "Pass a system, on a group or in coordinates, or what `discretize` returned."
        raise error(f"{owner}(system=...)", "be a system or its map", shown(system), remedy)
    return door(owner).on_group(owner, system, configuration, velocity)


def door(owner: str) -> Any:
    """Return the motions beside a state, for a caller whom an error names where there is no JAX."""
    with needs("jax", owner):
        from nonholo.analysis import _beside
    return _beside


def _step(matrix: Float[np.ndarray, "d d"], defect: Float[np.ndarray, "d"]) -> Float[np.ndarray, "d"]:
    """Return the step of Levenberg and Marquardt: damped by the defect, Newton's where steady motions are families."""
    left, sizes, right = np.linalg.svd(matrix)
    rank = np.count_nonzero(sizes > _RANK * sizes.max(initial=0.0))
    gains = sizes[:rank] / (sizes[:rank] ** 2 + defect @ defect)
    return right[:rank].T @ (gains * (left[:, :rank].T @ defect))


_NEAR = "equilibria(configuration=...)"
_MOST = 50  # corrections
_CLOSE = 1e-13  # of the extent of a state, for the last one
_RANK = 1e-10  # of the largest singular value
_STABLE = 1e-7  # of the largest eigenvalue: rounding moves double ones by its root
_AT_REST = 1e-3  # of a velocity, below which corrections have led to rest


@result
class SteadyMotion:
    """A state of rest, or a motion whose velocity stays, and what happens beside it.

    Attributes:
        configuration: Where it is, or passes.
        body_velocity: Its velocity; of a map that of its steps.
        linearization: The linear equations beside it.
    """

    configuration: Float[np.ndarray, "..."]
    body_velocity: Float[np.ndarray, "n"]
    linearization: Linearization

    @property
    def rates(self) -> Inexact[np.ndarray, "d"] | None:
        """Eigenvalues of the flow; None of a map."""
        return self.linearization.eigenvalues if self.linearization.time_step is None else None

    @property
    def multipliers(self) -> Inexact[np.ndarray, "d"] | None:
        """Eigenvalues of a step of a map; None of a flow."""
        return None if self.linearization.time_step is None else self.linearization.eigenvalues

    @property
    def is_stable(self) -> bool:
        """Whether no eigenvalue grows: no small disturbance does so exponentially."""
        values = self.linearization.eigenvalues
        growth = np.real(values) if self.multipliers is None else np.abs(values) - 1
        return bool(np.all(growth <= _STABLE * np.abs(values).max(initial=0.0)))


def steady_motion(system: Any, configuration: Any, body_velocity: Any) -> SteadyMotion:
    """Return the steady motion near a state; of a map in coordinates its own, which begins at that of the flow."""
    is_map = isinstance(system, Discretization | AbstractCoordinateDiscretization)
    flow: Any = system.system if is_map else system  # the map rests where the flow does
    state = _steady_state(flow, flow, (configuration, body_velocity))
    if is_map and np.any(body_velocity) and getattr(flow, "coordinates", ()):
        state = _steady_state(system, flow, state)
    return SteadyMotion(*state, linearize(system, configuration=state[0], body_velocity=state[1]))


def _steady_state(subject: Any, flow: Any, state: tuple[Any, Any]) -> tuple[Any, Any]:
    """Correct a state until a flow or its map is steady: each correction is the shortest of the states that matter."""
    is_rest, begin = state[1] is None or not np.any(state[1]), None
    for _ in range(_MOST):
        local, beside = local_motion("equilibria", subject, *state)
        equations = _equations_of(flow, local)
        matrix, defect = _balance(local._replace(is_carried=False) if is_rest else local, equations)
        is_seen, units = np.abs(matrix) > _UNSEEN * equations.rate, equations.units * equations.extent
        change = equations.directions @ (units[equations.states] * _step(matrix * is_seen, defect))
        state = beside(-change[: local.places], -change[local.places :])
        velocity = local.state[local.places :]
        begin = begin or (velocity, equations.units[local.places :])
        if np.abs(change / units).max(initial=0.0) <= _CLOSE:
            if not equations.is_steady:
                break
            speed, before = (np.abs(v / begin[1]).max(initial=0.0) for v in (velocity, begin[0]))
            if speed < _AT_REST * before:
                remedy = "Guess closer to one, or leave body_velocity out."
                raise error(_NEAR, "be near a steady motion", "one from which corrections lead to rest", remedy)
            return state
    got = f"none, after corrections that lead to {np.asarray(state[0]).tolist()}"
    raise error(_NEAR, "be near a steady motion", got, "Guess closer to one.")


def _equations_of(flow: Any, local: Local) -> Reduced:
    """Return the equations beside a state, refused where they are not finite or depend on the time."""
    if not np.isfinite(local.slope[0]).all():
        got = f"none at {local.state.tolist()}"
        raise error(_NEAR, "have a finite linearization", got, "Guess closer to an equilibrium.")
    equations = reduced(local)
    if getattr(flow, "is_driven", False) and flow.dimension in equations.states:
        remedy = "Prescribed motions and forces of the time drive it: leave them out."
        raise error(_NEAR, "be near a steady motion", "equations that depend on time", remedy)
    return equations


def _balance(local: Local, equations: Reduced) -> tuple[np.ndarray, np.ndarray]:
    r"""Return derivatives of what vanishes in a steady motion by the states that matter, and its values, in units.

    In coordinates and at rest these are the changes of the states. Seen from a frame that moves along, a motion is
    steady if its velocity is constant at all its poses: $\dot w(g e^{\xi} e^{t (v + w)}, v + w) = 0$.
    """
    states, units = equations.states, equations.units
    if not local.is_carried:
        sizes, matrix, change = units[states], equations.matrix, local.change[0][states]
    else:
        rates, count = slice(local.places, None), len(local.times)
        frame = np.where(np.arange(len(units))[:, None] < local.places, local.slope[0], 0.0)
        transport = scipy.linalg.expm(local.times[:, None, None] * frame) @ equations.directions
        sizes, matrix = np.tile(units[rates], count), np.concatenate(local.slope[:count, rates] @ transport)
        change = local.change[:count, rates].ravel()
    return matrix * (units[states] / sizes[:, None]), change / sizes / equations.extent


_SHIFT = 1e-14  # relative, of eigenvalues by rounding
_TIGHT = 1e-14  # error of a critical value, relative to those around it
_NEUTRAL = 1e-7  # relative to the largest eigenvalue: what neither grows nor decays, up to rounding


def critical_values(
    linearization: Callable[[float], Linearization], interval: Sequence[float], *, samples: int = 65
) -> Float[np.ndarray, "M"]:
    r"""Return the values of a parameter at which eigenvalues begin or cease to grow.

    Eigenvalues of `linearize` that grow are counted at equally spaced values. Between two neighbors with other numbers
    of them the real part that changes its sign, of maps $\log|\mu|$, is followed to its zero by Brent's method; where
    eigenvalues meet on the imaginary axis, and stay there, the place is found by bisection. Two changes between two
    neighboring values are not seen: take more samples.

    Args:
        linearization: Maps a value to what `nonholo.linearize` returns there. Where it has fewer states, as at rest,
            those that are missing count as ignorable.
        interval: The least and the largest value.
        samples: Number of values of the first scan.

    Raises:
        ValueError: A function that returns something else, an interval that does not rise, no samples.

    Example:
        A heavy top stands upright above the spin $2\sqrt{Amgl}/C$, here with A = 1.2, C = 1:

        >>> weight = nh.Gravity(force=[0.0, 0.0, -9.81], point=[0.0, 0.0, 0.3])
        >>> top = nh.Forced(nh.RigidBody(np.diag([0.5, 0.5, 0.7])), weight)
        >>> of = lambda spin: nh.linearize(top, body_velocity=(0.0, 0.0, spin))
        >>> spins = nh.critical_values(of, (1.0, 6.0), samples=5)
        >>> bool(np.allclose(spins, 2 * np.sqrt(1.2 * 9.81 * 0.3), rtol=1e-9))
        True
    """
    function("critical_values(linearization=...)", linearization, "value")
    where, remedy = "critical_values(interval=...)", "Pass the least and the largest value."
    low, high = array(where, interval, (2,), remedy)
    if not low < high:
        raise error(where, "have its lower end first", shown(interval), remedy)
    places = np.linspace(low, high, 1 + count("critical_values(samples=...)", samples, "Pass a positive number."))
    pairs = [_rates(linearization, value) for value in places]
    size = max(len(values) for values, _ in pairs)
    rows, shifts = ([_with_zeros(row, size) for row in part] for part in zip(*pairs, strict=True))
    sizes = np.abs(np.real(rows))
    noise = sizes[sizes <= np.array(shifts)].max(initial=0.0)
    least = max(noise, _NEUTRAL * np.abs(rows).max(initial=0.0))
    changes = np.flatnonzero(np.diff([_growing(row, least) for row in rows]))
    return np.array([_change_between(linearization, least, places[i : i + 2], rows[i : i + 2]) for i in changes])


def _rates(linearization: Callable[[float], Linearization], value: float) -> tuple[np.ndarray, np.ndarray]:
    r"""Return the eigenvalues at a value, of maps their logarithms, and the distance by which rounding moves each.

    With unit eigenvectors x, y of both sides it is $\epsilon\|A\|/|y^*x|$, which has no bound for multiple ones; those
    of d numbers move by $2\epsilon^{1/d}\|A\|$ at most [elsner-1985]. Where A is
    rounding alone it is $\epsilon$ times the largest derivative.
    """
    result: Any = linearization(float(value))
    remedy = "Return nh.linearize(...) of the value."
    instance("critical_values(linearization=...)", result, Linearization, "return a Linearization", remedy)
    with np.errstate(invalid="ignore"):  # units that are no integers
        matrix: Any = scipy.linalg.matrix_balance(result.matrix, permute=False)[0]
    values, left, right = cast(Any, scipy.linalg.eig(matrix, left=True))
    size, most = np.linalg.norm(matrix), 2 * _SHIFT ** (1 / max(1, len(values)))
    with np.errstate(divide="ignore"):
        shift = size * np.minimum(_SHIFT / np.abs((left.conj() * right).sum(axis=0)), most)
    shift = np.maximum(shift, _SHIFT * result.rate)
    h = result.time_step
    return (values, shift) if h is None else (np.log(values) / h, shift / np.abs(values) / h)


def _with_zeros(row: np.ndarray, size: int) -> np.ndarray:
    """Return numbers with zeros after them: rates of ignorable coordinates."""
    return np.append(row, np.zeros(max(0, size - len(row))))


def _growing(rates: np.ndarray, least: float) -> int:
    return int((np.real(rates) > least).sum())


def _change_between(linearization: Any, least: float, ends: np.ndarray, rows: Sequence[np.ndarray]) -> float:
    """Return where between two values the number of growing eigenvalues changes.

    As many eigenvalues as are neutral at both ends, the smallest, are left out.
    """
    neutral = min(int((np.abs(np.real(row)) <= least).sum()) for row in rows)
    few, many = min(_growing(row, least) for row in rows), _growing(rows[0], least)

    def growth(rates: np.ndarray) -> np.ndarray:
        rates = _with_zeros(rates, len(rows[0]))
        rest = rates[np.argsort(np.abs(rates), kind="stable")[neutral:]]
        return np.sort(np.real(rest))[::-1]

    def change(x: float) -> float:
        return growth(_rates(linearization, x)[0])[few]

    def is_alike(x: float) -> float:
        return 1.0 if _growing(_rates(linearization, x)[0], least) == many else -1.0

    before, after = (growth(row)[few] for row in rows)
    crosses = before * after < 0 and min(abs(before), abs(after)) > least
    tight = _TIGHT * np.abs(ends).max()
    root: Any = brentq(change, *ends, xtol=tight) if crosses else bisect(is_alike, *ends, xtol=tight)
    return float(root)
