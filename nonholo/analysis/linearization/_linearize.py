"""Steady motions of flows and maps, the linear equations beside them, and where these lose their stability."""

import dataclasses
import functools
import itertools
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from scipy.optimize import bisect, brentq

from nonholo.analysis.linearization._reduction import Local, reduced
from nonholo.base.checks import array, count, error, instance, needs, shown
from nonholo.base.memo import Keeper
from nonholo.base.types import Float, Inexact
from nonholo.discrete import Discretization
from nonholo.systems import AbstractCoordinateSystem, AbstractSystem, in_coordinates

Shifted = Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]
"""Takes changes of coordinates and of velocities to a configuration and a body velocity."""


@dataclasses.dataclass(frozen=True, eq=False)
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
    """

    matrix: Float[np.ndarray, "d d"]
    names: tuple[str, ...]
    ignorable: tuple[str, ...]
    time_step: float | None

    @property
    def eigenvalues(self) -> Inexact[np.ndarray, "d"]:
        """Rates, the one that grows fastest first; of a map multipliers of a step, the largest first."""
        return self._spectrum[0]

    @property
    def modes(self) -> Inexact[np.ndarray, "d d"]:
        """Columns in the order of the eigenvalues, of length one; rows belong to the names."""
        return self._spectrum[1]

    @functools.cached_property
    def _spectrum(self) -> tuple[np.ndarray, np.ndarray]:
        values, modes = np.linalg.eig(self.matrix)
        size = np.real(values) if self.time_step is None else np.abs(values)
        order = np.lexsort((-np.imag(values), -size))
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
    on the pose $\xi$ of $g\,e^\xi$, seen from a body that moves on steadily. So a top in steady precession is, too.

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
        >>> found = nh.linearize(pendulum, configuration=[np.pi])
        >>> found.names, found.eigenvalues.round(12)
        (('q1', "q1'"), array([ 1., -1.]))
    """
    local, _ = local_motion("linearize", system, configuration, body_velocity)
    where = "linearize(body_velocity=...)"
    if not np.isfinite(local.slope[0]).all():
        remedy = "Take a smaller time step, or another state."
        raise error(where, "have a finite linearization", f"none at {local.state.tolist()}", remedy)
    equations = reduced(local)
    names = tuple(local.names[i] for i in equations.states)
    if not equations.is_steady:
        rates = ", ".join(f"{name}: {rate:.6g}" for name, rate in zip(names, equations.defect, strict=True))
        remedy = "Pass a state of rest or of a steady motion; coordinates that matter have to stay."
        raise error(where, "be that of a steady motion", f"rates {rates}", remedy)
    ignorable = tuple(local.names[i] for i in equations.ignorable)
    matrix = equations.matrix if _time_step(system) is None else np.eye(len(names)) + equations.matrix
    return Linearization(matrix, names, ignorable, _time_step(system))


def step_tangents(orbit: Any) -> Float[np.ndarray, "L d d"]:
    """Return the derivative of each state of a discrete orbit on a group by the one before."""
    with needs("jax", "Orbit.tangent"):
        from nonholo.analysis.linearization import _beside
    return _beside.along(orbit)


def local_motion(owner: str, system: Any, configuration: Any, velocity: Any) -> tuple[Local, Shifted]:
    """Return the changes beside a state, and the function that gives the states beside it."""
    with needs("jax", owner):
        from nonholo.analysis.linearization import _beside
    if isinstance(system, AbstractCoordinateSystem) or in_coordinates(system):
        return _beside.beside_state(owner, system, configuration, velocity)
    if not isinstance(system, AbstractSystem | Discretization):
        remedy = "Pass a system, on a group or in coordinates, or what `discretize` returned."
        raise error(f"{owner}(system=...)", "be a system or its map", shown(system), remedy)
    return _beside.on_group(owner, system, configuration, velocity)


def _time_step(system: Any) -> float | None:
    return getattr(system, "time_step", None)


_MOST = 50  # corrections
_CLOSE = 1e-13  # of a state, for the last one
_RANK = 1e-10  # of the largest singular value
_STABLE = 1e-7  # of the largest eigenvalue: rounding moves double ones by its root


@dataclasses.dataclass(frozen=True, eq=False)
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
    """Return the steady motion near a state: each correction is the shortest one of the states that matter."""
    where, state = "equilibria(configuration=...)", (configuration, body_velocity)
    flow = system.system if isinstance(system, Discretization) else system  # the map rests where the flow does
    for _ in range(_MOST):
        local, beside = local_motion("equilibria", flow, *state)
        if not np.isfinite(local.slope[0]).all():
            got = f"none at {local.state.tolist()}"
            raise error(where, "have a finite linearization", got, "Guess closer to an equilibrium.")
        equations = reduced(local)
        inverse = np.linalg.pinv(equations.matrix, rcond=_RANK)
        change = equations.directions @ inverse @ local.change[0][equations.states]
        state = beside(-change[: local.places], -change[local.places :])
        if np.abs(change).max(initial=0.0) <= _CLOSE * (1 + np.abs(local.state).max()):
            if not equations.is_steady:
                break
            return SteadyMotion(*state, linearize(system, configuration=state[0], body_velocity=state[1]))
    got = f"none, after corrections that lead to {np.asarray(state[0]).tolist()}"
    raise error(where, "be near a steady motion", got, "Guess closer to one.")


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
        linearization: Maps a value to what `nonholo.linearize` returns there, with as many states everywhere.
        interval: The least and the largest value.
        samples: How many values are looked at first.

    Raises:
        ValueError: A function that returns something else, an interval that does not rise, no samples.

    Example:
        A heavy top stands upright above the spin $2\sqrt{Amgl}/C$, here with A = 1.2, C = 1:

        >>> weight = nh.Gravity(force=[0.0, 0.0, -9.81], point=[0.0, 0.0, 0.3])
        >>> top = nh.Forced(nh.RigidBody(np.diag([0.5, 0.5, 0.7])), weight)
        >>> of = lambda spin: nh.linearize(top, body_velocity=(0.0, 0.0, spin))
        >>> found = nh.critical_values(of, (1.0, 6.0), samples=5)
        >>> bool(np.allclose(found, 2 * np.sqrt(1.2 * 9.81 * 0.3), rtol=1e-9))
        True
    """
    where, remedy = "critical_values(interval=...)", "Pass the least and the largest value."
    low, high = array(where, interval, (2,), remedy)
    if not low < high:
        raise error(where, "rise", shown(interval), remedy)
    places = np.linspace(low, high, 1 + count("critical_values(samples=...)", samples, "Pass a positive number."))
    rows = [_rates(linearization, value) for value in places]
    least = _NEUTRAL * max(np.abs(row).max(initial=0.0) for row in rows)
    changes = [
        i for i, (row, other) in enumerate(itertools.pairwise(rows)) if _growing(row, least) != _growing(other, least)
    ]
    return np.array([_change_between(linearization, least, places[i : i + 2], rows[i : i + 2]) for i in changes])


def _rates(linearization: Callable[[float], Linearization], value: float) -> Inexact[np.ndarray, "d"]:
    """Return the eigenvalues at a value, of maps their logarithms."""
    result: Any = linearization(float(value))
    remedy = "Return nh.linearize(...) of the value."
    instance("critical_values(linearization=...)", result, Linearization, "return a Linearization", remedy)
    values = result.eigenvalues.astype(complex)
    return values if result.time_step is None else np.log(values) / result.time_step


def _growing(rates: np.ndarray, least: float) -> int:
    return int((np.real(rates) > least).sum())


def _change_between(linearization: Any, least: float, ends: np.ndarray, rows: list[np.ndarray]) -> float:
    """Return where between two values the number of growing eigenvalues changes.

    As many eigenvalues as are neutral at both ends, the smallest, are left out.
    """
    neutral = min(int((np.abs(np.real(row)) <= least).sum()) for row in rows)
    few, many = min(_growing(row, least) for row in rows), _growing(rows[0], least)

    def growth(rates: np.ndarray) -> np.ndarray:
        rest = rates[np.argsort(np.abs(rates), kind="stable")[neutral:]]
        return np.sort(np.real(rest))[::-1]

    def change(x: float) -> float:
        return growth(_rates(linearization, x))[few]

    def is_alike(x: float) -> float:
        return 1.0 if _growing(_rates(linearization, x), least) == many else -1.0

    before, after = (growth(row)[few] for row in rows)
    crosses = before * after < 0 and min(abs(before), abs(after)) > least
    root: Any = brentq(change, *ends, xtol=1e-14) if crosses else bisect(is_alike, *ends, xtol=1e-14)
    return float(root)
