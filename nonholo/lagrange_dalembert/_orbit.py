"""Orbits in coordinates and on a group: plain arrays at the saved states, and their labels.

And their motions as stores keep them: what orbits tell, and systems without functions.
"""

import dataclasses
import importlib
from collections.abc import Mapping
from typing import Any, ClassVar, Self

import numpy as np

from nonholo.base.checks import assign, error, shown
from nonholo.base.memo import memo
from nonholo.base.results import Outcome
from nonholo.base.types import Float, Int
from nonholo.groups import AbstractMatrixGroup
from nonholo.lagrange_dalembert import _equations as equations
from nonholo.lagrange_dalembert.functions import in_double, in_rows, places, room
from nonholo.orbit import AbstractMotion, AbstractOrbit, First
from nonholo.systems import AbstractCoordinateSystem, Start
from nonholo.systems.forces import refuse_table

Labels = dict[str, tuple[tuple[str, ...], str]]
"""Name: dimensions after `step`, and what the numbers are."""

_SHARED: Labels = {
    "multipliers": (("constraint",), "impulses of constraint to the next state; of a flow forces of constraint"),
    "energy": ((), "energy"),
    "constraint_residual": ((), "largest residual of the constraint"),
}
_QUADRATIC = 1e-9  # what masses may change with velocities, relative
_SPEEDS = 2.0 ** np.arange(-64, 65, 2)  # at which they are compared, in any unit
_ROWS = ("step", "time", "configuration", "displacement", "body_velocity", "momentum", "energy", "constraint_residual")


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class AbstractCoordinateOrbit(AbstractOrbit):
    """A motion of a system in coordinates or on a group at K saved states."""

    time: Float[np.ndarray, "K"]
    configuration: Float[np.ndarray, "K ..."]
    displacement: Float[np.ndarray, "K ..."] | None
    body_velocity: Float[np.ndarray, "K n"]
    momentum: Float[np.ndarray, "K n"]
    multipliers: Float[np.ndarray, "L s"]
    energy: Float[np.ndarray, "K"]
    constraint_residual: Float[np.ndarray, "K"]
    outcome: Outcome = Outcome.successful
    system: Any = None
    time_step: float | None = None
    save_every: int = 1
    events: Any = None
    step: Int[np.ndarray, "K"] = None  # type: ignore[assignment]
    solution: Any = dataclasses.field(default=None, repr=False)
    branch: ClassVar[str] = "nearest"
    has_poses: ClassVar[bool] = True
    is_compact: ClassVar[bool] = False
    is_measured: ClassVar[bool] = False
    momenta: ClassVar[tuple[str, ...]] = ("momentum", "body_velocity")
    _labels: ClassVar[Labels]

    def _mark_impacts(self) -> None:
        """Steps with impacts have no impulses in the rows at their ends: others act at the wall."""
        if self.is_discrete and self.has_impacts.any():
            cut = self.has_impacts[: len(self.multipliers), None]
            assign(self, multipliers=np.where(cut, np.nan, self.multipliers))

    def __repr__(self) -> str:
        n, *columns = self.configuration.shape[1:]
        place = f"{n} x {n} matrices" if columns else f"{n} coordinates"
        span = f", time {self.time[0]:g} to {self.time[-1]:g}" if len(self) else ""
        return f"<{type(self).__name__}: {len(self)} states of {place}{span}, {self.outcome}>"

    def as_start(self) -> First:
        """Return the momentum, the place and the velocity of the first state."""
        return First((self.momentum[0], places(self.system, self.configuration, self.time)[0], self.body_velocity[0]))

    def beside(self, offsets: Float[np.ndarray, "K n"]) -> Self:
        """Return the states at places beside theirs, on a group by body directions."""
        return dataclasses.replace(self, configuration=self.system.places.beside(self.configuration, offsets))

    def with_step(self, ahead: Self, outcome: Outcome) -> Self:
        """Return one state as that of a run that began there; a run that failed goes no further from there."""
        del outcome
        return dataclasses.replace(ahead, time=self.time, step=self.step)

    def push(self, normal: Float[np.ndarray, "n"], change: float) -> Self:
        """Return one state after the impulse along a covector, that of a gap, which changes the rate of the gap."""
        return room("_flow").push(self, normal, change)

    def rate_along(self, normal: Float[np.ndarray, "n"]) -> float:
        """Return the rate of a gap in the first state, whose derivative is a covector; zero if it is rounding."""
        p, x, _ = self.as_start().numbers
        return self.sum_of_rates(normal * in_double(room("_flow").answer, self.system, x, p, normal)[0])

    def refuse_reset(self, where: str) -> None:
        """Refuse Lagrangians whose masses depend on velocities: Newton's rule does not keep their energy."""
        _, x, v = self.as_start().numbers
        fast = _SPEEDS[:, None] / np.arange(1.0, 1 + len(v))
        speeds = np.concatenate([fast, -fast])
        masses = in_rows(equations.mass_matrix, self.system, np.broadcast_to(x, (len(speeds), *x.shape)), speeds)
        if not np.ptp(masses, axis=0).max() <= _QUADRATIC * np.abs(masses[0]).max():
            got = "another mass matrix at another velocity"
            raise error(where, "be of a Lagrangian quadratic in velocities", got, "Leave the reset out.")

    @property
    def motion(self) -> Any:
        """The discretization or the flow."""
        return CoordinateFlow(self.system) if self.time_step is None else self.system.discrete_map(self.time_step)

    @property
    def span(self) -> tuple[float, float] | None:  # type: ignore[override]
        """The first and the last time between which `at` knows all states; None if saved states are all there is."""
        return None if self.solution is None else self.solution.span

    @property
    def is_discrete(self) -> bool:
        """Whether it has displacements: a flow has none."""
        return self.displacement is not None

    @property
    def conserves_energy(self) -> bool | None:
        """False for a discrete orbit, None for a flow."""
        return False if self.is_discrete else None

    def rows(self) -> dict[str, np.ndarray]:
        """Return the arrays with a row for each state; impulses that are not known are NaN."""
        missing = np.full((len(self) - len(self.multipliers), self.multipliers.shape[1]), np.nan)
        arrays = {name: rows for name in _ROWS if (rows := getattr(self, name)) is not None}
        return arrays | {"multipliers": np.concatenate([self.multipliers, missing])}

    def of_rows(self, rows: dict[str, np.ndarray]) -> Self:
        """Return the orbit of such arrays, without the impulse of the last state if it is not known."""
        impulses = rows["multipliers"]
        count = len(impulses) - int(len(impulses) > 0 and bool(np.isnan(impulses[-1]).any()))
        return dataclasses.replace(self, **{**rows, "multipliers": impulses[:count]})

    @memo
    def work(self) -> Float[np.ndarray, "K"]:
        r"""Work on a driven system since the first state, by the trapezoidal rule; zero of one that is not driven.

        Of a store that holds no functions it is not known: NaN.

        $$ \dot W = f\cdot v + \lambda\cdot b - \partial L/\partial t: $$

        the power of the force, of moving constraints and driven joints, and of a Lagrangian of the time. The energy
        less this work is constant up to an error of order 2 in the time between states.
        """
        return self._works[:, 0]

    @memo
    def dissipation(self) -> Float[np.ndarray, "K"]:
        r"""Energy that `Friction` has taken since the first state, $\int v\cdot Cv\,dt$ by the trapezoidal rule.

        `work + dissipation` is the work of all else. Friction that is part of a function counts as that. Of a store
        that holds no functions it is not known: NaN.
        """
        return self._works[:, 1]

    @memo
    def _works(self) -> Float[np.ndarray, "K 2"]:
        if not self.system.has_functions:
            return np.full((len(self), 2), np.nan if self.system.is_driven else 0.0)
        return room("_flow").works(self) if self.system.is_driven or self.system.slips else np.zeros((len(self), 2))

    @property
    def lacks_forces(self) -> bool:
        """Whether a table has forces of steps between the states."""
        system = self.system
        return bool(system.is_driven and system.has_functions and system.table is not None and not self.has_every_step)

    @memo
    def restricted_momentum(self) -> Float[np.ndarray, "K n"]:
        r"""Momenta less their parts $A^T\mu$ across the constraint: those along admissible directions."""
        A = in_rows(equations.forms, self.system.free, places(self.system, self.configuration, self.time))
        p = self.momentum[..., None]
        return (p - np.linalg.pinv(A) @ (A @ p))[..., 0]

    @memo
    def tangent(self) -> Float[np.ndarray, "L d d"]:
        r"""Derivative of each state by the one before, in orthonormal bases of the admissible changes of (q, v).

        Admissible changes of (q, v) keep $A(q)v = b$, of a map the discrete constraint, and m holonomic ones, d = 2 n -
        s - m; on a group $\xi$ of $g\,e^\xi$ stands for q. Of a map by the implicit function of the step, of a flow by
        its equation of variation.
        """
        maps, rows, units, _ = room("_tangents").changes(self)
        return room("_tangents").among_admissible(maps, rows, np.ones_like(units))

    def at(self, times: Any) -> "AbstractCoordinateOrbit":
        """Return the states of a flow at any of its times, from its Taylor series, without a new run.

        Args:
            times: One or many, in any order, between the first and the last time of the flow.

        Raises:
            ValueError: Times outside, a discrete orbit, or a flow from a file, whose states alone are known.
        """
        if self.solution is None:
            got = f"an orbit in coordinates with {len(self)} states; not {shown(times)}"
            raise error("Orbit.at(...)", "be called on a flow", got, "Slice it; solve a flow from a file again.")
        return room("_flow").at(self, times)

    def labeled_rows(self) -> dict[str, tuple[tuple[str, ...], np.ndarray, dict[str, str]]]:
        """Return its rows by name: dimensions after `step`, numbers and attributes."""
        rows, labels = self.rows(), (self._labels | _SHARED).items()
        return {name: (axes, rows[name], {"long_name": meaning}) for name, (axes, meaning) in labels if name in rows}

    def to_dataset(self) -> Any:
        """Return the orbit as a labeled `xarray.Dataset`; rows that do not exist, of multipliers, are NaN.

        Along `coordinate` numbers have the names of the coordinates: `dataset.configuration.sel(coordinate="x")`. On a
        group poses have the names of `nonholo.io.orbit_to_dataset` besides.
        """
        import xarray

        datasets = importlib.import_module("nonholo.io.datasets")
        variables = {name: (("step", *axes), *rest) for name, (axes, *rest) in self.labeled_rows().items()}
        coords: dict[str, Any] = {"step": self.step, "time": ("step", self.time, {"long_name": "time"})}
        if self.coordinates:
            coords["coordinate"] = np.array(self.coordinates, dtype=object)
        else:
            variables = datasets.with_own_axes(variables | datasets.posed(self.space, self.configuration))
        step = {} if self.time_step is None else {"time_step": self.time_step}
        return xarray.Dataset(variables, coords=coords, attrs={"outcome": self.outcome.name, **step})


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class CoordinateOrbit(AbstractCoordinateOrbit):
    r"""A motion in coordinates at K saved states.

    Attributes:
        time: Times of the saved states, shape (K,).
        configuration: $q_k$, shape (K, n).
        displacement: $q_{k+1} - q_k$ of single steps, shape (K, n); None for a flow.
        body_velocity: The velocity; for a discrete orbit displacement / time_step, shape (K, n).
        momentum: $P_k = -D_1 L_d(q_k, q_{k+1})$, for a flow $\partial L/\partial v$, shape (K, n).
        multipliers: Impulses $\lambda$ in $P_{k+1} - P^+_k = \sum_j \lambda_j A^j(q_{k+1})$ of the steps from the saved
            states but the last, shape (K - 1, s); NaN in steps with impacts, whose impulses act at the wall too, along
            other rows. For a flow the forces at its times, shape (K, s).
        energy: $-\partial L_d/\partial h$, for a flow $v\cdot\partial L/\partial v - L$, shape (K,).
        constraint_residual: Largest $|F_j(q_k, q_{k+1})|$, of holonomic constraints $|\Phi_j(q_{k+1})|/h$; for a flow
            $|A^j(q) v|$, shape (K,).
        outcome: How the run ended.
        system: The system.
        time_step: h; None for a flow.
        save_every: Steps between saved states.
        events: Crossings of `events=`, an `EventLog`; None without.
        step: The number of the step of each state, counted from 0 at the start of the run, for all rows, shape (K,); of
            a state within a step the number of its beginning. Of a flow it is the number of the requested time.

    Example:
        >>> from nonholo.lagrange_dalembert import LagrangeDAlembert
        >>> spring = LagrangeDAlembert(lambda q, v: (v @ v - q @ q) / 2, None, dimension=1)
        >>> nh.simulate(nh.discretize(spring, 0.1), configuration=[1], body_velocity=[0], steps=10)
        <CoordinateOrbit: 11 states of 1 coordinates, time 0 to 1, successful>
    """

    _labels: ClassVar[Labels] = {
        "configuration": (("coordinate",), "coordinates"),
        "displacement": (("coordinate",), "change of the coordinates in one step"),
        "body_velocity": (("coordinate",), "velocity; of a discrete orbit displacement / time_step"),
        "momentum": (("coordinate",), "momentum at the start of the step; of a flow the Legendre transform"),
    }

    @property
    def coordinates(self) -> tuple[str, ...]:  # pyright: ignore[reportIncompatibleVariableOverride]
        """The names of the coordinates."""
        return self.system.coordinates

    space = coordinates


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class GroupOrbit(AbstractCoordinateOrbit):
    r"""A motion of a `GroupLagrangeDAlembert` at K saved states.

    Attributes:
        time: Times of the saved states, shape (K,).
        configuration: $g_k$, shape (K, N, N).
        displacement: $W_k = g_k^{-1}g_{k+1}$ of single steps, shape (K, N, N); None for a flow.
        body_velocity: The body velocity; for a discrete orbit $\log(W_k)/h$, shape (K, dim).
        momentum: $P_k = P(W_k)$, for a flow $\partial l/\partial\omega$, shape (K, dim).
        multipliers: Impulses $\lambda$ in $P_{k+1} - \mathrm{Ad}^*_{W_k}P_k = \sum_j\lambda_j a^j(g_{k+1})$ of the
            steps from the saved states but the last, shape (K - 1, s); NaN in steps with impacts, whose impulses act at
            the wall too, along other rows. For a flow the forces at its times, (K, s).
        energy: $-\partial l_d/\partial h$ at $W_k$, for a flow $\omega\cdot\partial l/\partial\omega - l$, shape (K,).
        constraint_residual: Largest $|F_j(g_k, W_k)|$, for a flow $|a^j(g)\omega|$, shape (K,).
        outcome: How the run ended.
        system: The system.
        time_step: h; None for a flow.
        save_every: Steps between saved states.
        events: Crossings of `events=`, an `EventLog`; None without.
        step: The number of the step of each state, counted from 0 at the start of the run, for all rows, shape (K,); of
            a state within a step the number of its beginning. Of a flow it is the number of the requested time.

    Example:
        >>> from nonholo.lagrange_dalembert import GroupLagrangeDAlembert, mass_tensor_lagrangian
        >>> free = GroupLagrangeDAlembert(nh.SO(3), mass_tensor_lagrangian(nh.SO(3), np.diag([1.0, 2.0, 3.0])), None)
        >>> nh.simulate(nh.discretize(free, 0.1), body_velocity=(1.0, 0.2, 0.0), steps=10)
        <GroupOrbit: 11 states of 3 x 3 matrices, time 0 to 1, successful>
    """

    _labels: ClassVar[Labels] = {
        "configuration": (("row", "column"), "pose"),
        "displacement": (("row", "column"), "displacement of a single step, seen from the body"),
        "body_velocity": (("component",), "body velocity; of a discrete orbit log(displacement) / time_step"),
        "momentum": (("component",), "body momentum at the start of the step; of a flow the Legendre transform"),
    }

    @property
    def group(self) -> AbstractMatrixGroup:  # type: ignore[override]
        """The group."""
        return self.system.group


ORBITS: dict[str, Any] = {orbit.__name__: orbit for orbit in (CoordinateOrbit, GroupOrbit)}


class CoordinateMotion:
    """A motion whose stores keep the numbers that its orbit tells."""

    system: Any
    time_step: float | None
    columns: ClassVar[tuple[str, ...]] = (*_ROWS[1:], "multipliers")

    def orbit(self, *, branch: str, **rows: Any) -> AbstractCoordinateOrbit:
        """Return the orbit of rows of the columns; those of multipliers that do not exist are left out.

        Raises:
            ValueError: Columns that are none of this system.
        """
        del branch
        system, last = self.system, None if self.time_step is None else -1
        impulses = rows["multipliers"] if system.constraints else rows["body_velocity"][:, :0]  # none are stored
        rows["multipliers"] = impulses if impulses is None else impulses[:last]
        shapes = {name: None if rows[name] is None else rows[name].shape[1:] for name in self.columns}
        q, v = system.shapes
        demand = {"configuration": q, "displacement": None if last is None else q, "body_velocity": v, "momentum": v}
        demand = dict.fromkeys(self.columns, ()) | demand | {"multipliers": (system.constraints,)}
        if shapes != demand:
            remedy = "The store was edited: copy it again from its source, or run it again."
            raise error("load_orbit(path=...)", f"hold the columns of {system.name!r}", f"shapes {shapes}", remedy)
        return ORBITS[system.orbits](**rows, system=system, time_step=self.time_step)


@dataclasses.dataclass(frozen=True, eq=False)
class CoordinateFlow(CoordinateMotion):
    """The flow of a system in coordinates or on a group, as the motion of its orbits.

    Attributes:
        system: The system.
        begins: The first time, where one is set.

    Example:
        >>> from nonholo.lagrange_dalembert import CoordinateFlow
        >>> CoordinateFlow(nh.examples.particle().system).columns[:2]
        ('time', 'configuration')
    """

    system: Any
    begins: float = dataclasses.field(default=0.0, repr=False, metadata={"stored": False})
    time_step: ClassVar[None] = None
    route_name: ClassVar[None] = None
    forces: ClassVar[None] = None
    starts: ClassVar[tuple[str, ...]] = ("body_velocity", "momentum")

    def first(self, start: Start, *, with_poses: bool) -> First:
        """Return the checked momentum, place and velocity of a start."""
        del with_poses
        refuse_table(f"{start.owner}(system=...)", self.system.table)
        state = room("_discretization").checked_state(
            self.system, start.configuration, {start.name: start.value}, self.begins, start.owner, project=start.project
        )
        return First((room("_start").momentum(self.system, *state), *state))

    def solve(self, first: First, times: Float[np.ndarray, "K"], rtol: float, *, reconstruct: bool) -> Any:
        """Return the orbit from a checked start, as far as it gets; an `rtol` of 0 is the default of its method."""
        del reconstruct
        return room("_flow").solve(self.system, first.numbers[1:], times, rtol or None)


AbstractMotion.register(CoordinateFlow)  # stores take both


@dataclasses.dataclass(frozen=True, eq=False)
class RecordedSystem(AbstractCoordinateSystem):
    """A system whose functions its store does not hold: the store describes it enough for pictures and tables.

    Attributes:
        record: Fields that could be restored, with what else was recorded.
        description: The class of the system and all of its fields, as in the store.

    Example:
        >>> from nonholo.lagrange_dalembert import RecordedSystem
        >>> system = RecordedSystem({"name": "Mine"}, ("LagrangeDAlembert", {"name": "Mine", "lagrangian": "callable"}))
        >>> system.name
        'Mine'
        >>> system.lagrangian
        Traceback (most recent call last):
        ValueError: `load_orbit(discrete=...)` must be the discretization. Got None: stores hold no functions. ...
    """

    has_functions: ClassVar[bool] = False
    record: Mapping[str, Any]
    description: tuple[str, dict[str, Any]]  # pyright: ignore[reportGeneralTypeIssues]

    def __getattr__(self, name: str) -> Any:
        """Return what was recorded; functions were not."""
        if name.startswith("__") or name == "record":  # asked by copies before there are fields
            raise AttributeError(name)
        if name not in self.record:
            remedy = "Pass the one that made the store to load_orbit, resume or extend: discrete=..."
            raise error("load_orbit(discrete=...)", "be the discretization", "None: stores hold no functions", remedy)
        return self.record[name]

    def parts(self, q: Any) -> tuple[()]:
        """Return no outline: it may be a function."""
        del q
        return ()

    def discrete_map(self, time_step: Any) -> Any:
        """Return the map of the store, which cannot run."""
        return room("_discretization").MAPS[self.orbits](self, time_step)
