"""The interface of all orbits: what a motion tells, on a group or in coordinates. Nothing is decoded here."""

import abc
import dataclasses
import functools
import importlib
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, ClassVar, TypeVar, cast

import numpy as np

from nonholo.base.checks import LARGEST, array, assign, error, is_moderate, selection, shape_of, within_memory
from nonholo.base.html import table
from nonholo.base.memo import Keeper, memo
from nonholo.base.results import Outcome
from nonholo.base.types import Bool, Float, Int

_COLUMNS = {"time", "configuration", "body_velocity", "momentum", "energy"}  # in coordinates
_COLUMNS |= {"reduced_momentum", "cayley", "canonical_pose"}  # compact

_LOOKS = 8  # in a step of a flow, for events
_CANCELED, _ENDED = 2.0**-40, 2.0**-46  # relative: of the parts of a rate, of a change that ends a momentum

OrbitT = TypeVar("OrbitT")
SelfT = TypeVar("SelfT", bound="AbstractOrbit")


@functools.cache
def _bounds(kind: Any) -> tuple[tuple[str, float], ...]:
    """Return the columns of a class of orbits that have to be finite, and the largest numbers they may hold."""
    names = (field.name for field in dataclasses.fields(kind) if field.name in _COLUMNS)
    return tuple((name, LARGEST if "momentum" in name else np.inf) for name in names)


def times_within(span: tuple[float, float], times: Any) -> tuple[Float[np.ndarray, "K"], Int[np.ndarray, "K"]]:
    """Return checked times of a span, and the order in which the motion comes to them."""
    where, (first, last) = "Orbit.at(times=...)", span
    time = array(where, times, (None,) if shape_of(times) else (), "Pass times.").reshape(-1)
    outside = ~((time >= min(span)) & (time <= max(span)))
    if outside.any():
        got = f"{time[np.argmax(outside)]:.17g}"
        raise error(where, f"lie between {first:.17g} and {last:.17g}", got, "Ask the flow for later times.")
    return time, np.argsort(time if last >= first else -time, kind="stable")


def looked_at(ends: Sequence[float], unit: float = 1.0) -> Float[np.ndarray, "looks"]:
    """Return times at which events are evaluated, between the states too, because steps are long.

    Ends of steps are in another unit of time.
    """
    return np.interp(np.arange(_LOOKS * len(ends) - _LOOKS + 1) / _LOOKS, np.arange(len(ends)), ends) / unit


class AbstractOrbit(Keeper, abc.ABC):
    """A motion at K saved states, of any system: times, configurations, momenta, energies, and how it ended.

    Attributes:
        system: The system.
        time: Times of the saved states, shape (K,).
        step: The number of the step of each state, counted from 0 at the start of the run, for all rows; of a state
            within a step the number of its beginning. Of a flow and of given poses: numbers of times and rows. Shape
            (K,).
        configuration: Matrices (K, N, N) on a group, (K, n) in coordinates.
        body_velocity: Velocities.
        momentum: Momenta.
        restricted_momentum: Momenta along admissible directions, which follow the flow to second order.
        tangent: Derivatives of the states by those before them.
        energy: Energies, shape (K,).
        work: Work of forces, and of what drives it, on the motion since the first state, shape (K,).
        multipliers: Impulses or forces of constraint.
        outcome: How the run ended.
        motion: The rule of motion: a discretization or a flow.
        save_every: Steps between saved states.
        branch: How the values of the map were chosen.
        time_step: h; None where there is none.
        span: The first and the last time between which `at` knows all states; None if saved states are all there is.
        coordinates: The names of the coordinates; none on a group.
        has_poses: Whether it has configurations.
        is_discrete: Whether it has displacements: a flow has none.
        is_compact: Whether it is made of compact states that its motion decodes, or of the numbers that it tells.
        is_measured: Whether configurations were given, and everything else follows from them.
        conserves_energy: Whether its map conserves the energy exactly; None for a flow, and where there is no map.
        events: Crossings of `events=`, an `EventLog`; None without.
        turned: Heading without ambiguity of full turns, where the run knows it, shape (K,).
        group: The group that configurations are matrices of; None in coordinates.
        momenta: The columns that an impact changes, the momentum first.
    """

    system: Any
    time: Float[np.ndarray, "K"]
    step: Int[np.ndarray, "K"]
    configuration: Float[np.ndarray, "K ..."]
    body_velocity: Float[np.ndarray, "K n"]
    momentum: Float[np.ndarray, "K n"]
    restricted_momentum: Float[np.ndarray, "K k"]
    tangent: Float[np.ndarray, "L d d"]
    energy: Float[np.ndarray, "K"]
    work: Float[np.ndarray, "K"]
    multipliers: Float[np.ndarray, "L s"]
    outcome: Outcome
    motion: Any
    save_every: int
    branch: str
    time_step: float | None
    span: tuple[float, float] | None
    coordinates: tuple[str, ...] = ()
    has_poses: bool
    is_discrete: bool
    is_compact: bool
    is_measured: bool
    conserves_energy: bool | None
    events: Any
    turned: Float[np.ndarray, "K"] | None = None
    group: Any = None
    momenta: ClassVar[tuple[str, ...]]

    def __post_init__(self) -> None:
        """Number the rows of a whole run; let no orbit be successful with a number that is not finite.

        Nor with a momentum whose square overflows, or a pose that has left its group.
        """
        if self.outcome == Outcome.successful:
            columns = ((getattr(self, name), most) for name, most in _bounds(type(self)))
            good = all(rows is None or is_moderate(rows, most) for rows, most in columns)
            if not (good and (self.is_measured or self.states_on_group == len(self))):
                assign(self, outcome=Outcome.nonfinite)
        if self.step is None or len(self.step) != len(self.time):
            assign(self, step=np.arange(0, self.save_every * len(self.time), self.save_every))
        if self.events is not None:
            self._mark_impacts()

    @classmethod
    def of_run(cls: type[SelfT], steps: range, **fields: Any) -> SelfT:
        """Return the orbit with these numbers of steps and its known outcome, without another check."""
        orbit = object.__new__(cls)
        vars(orbit).update(fields, steps=steps)
        return orbit

    if not TYPE_CHECKING:  # which would take every name for one of an orbit

        def __getattr__(self, name: str) -> Any:
            """Compute the numbers of steps of a run, or its times, when they are first read."""
            own, key = vars(self), f"{name}.of_run"  # has a dot, which no name of a field has
            if name not in ("step", "time") or "steps" not in own:
                return object.__getattribute__(self, name)  # raises what it raised before
            if key not in own:
                number = np.arange(own["steps"].start, own["steps"].stop, own["steps"].step)
                own[key] = number if name == "step" else self.motion.time_step * number
            return own[key]

    @property
    def states_on_group(self) -> int:
        """How many of the first states precede one whose pose has left its group by rounding."""
        group = self.group
        if group is None or not (group.has_drift and self.has_poses):
            return len(self)
        return int(group.leading_elements(self.configuration))

    def on_group(self: SelfT) -> SelfT:
        """Return the states before the first whose pose has left its group, by which the motion then has ended."""
        count = max(1, self.states_on_group)
        if count >= len(self):
            return self
        return dataclasses.replace(cast(Any, self.chosen(slice(0, count))), outcome=Outcome.nonfinite)

    def _mark_impacts(self) -> None:
        """Mark what steps with impacts do not have."""

    @abc.abstractmethod
    def as_start(self) -> Any:
        """Return what a run begins with that begins at the first state."""

    @abc.abstractmethod
    def beside(self: SelfT, offsets: Float[np.ndarray, "K dim"]) -> SelfT:
        """Return the states at places beside theirs, by coordinates, on a group by body directions."""

    @abc.abstractmethod
    def with_step(self: SelfT, ahead: SelfT, outcome: Outcome) -> SelfT:
        """Return one state with the step of a run that began there, as a state of that run, and what became of it."""

    def reflection(self: SelfT, normal: Float[np.ndarray, "dim"], bounce: float, direction: int) -> SelfT | None:
        r"""Return one state after the impulse of a wall along a covector, which reverses its speed along that.

        Args:
            normal: The derivative of the gap.
            bounce: Which part of the speed is left.
            direction: That of the gap on the way through the wall.

        Returns:
            None where the motion is not toward the wall.
        """
        rate = self.rate_along(normal)
        return self.push(normal, -(1 + bounce) * rate) if rate * direction > 0 else None

    @abc.abstractmethod
    def push(self: SelfT, normal: Float[np.ndarray, "dim"], change: float) -> SelfT:
        """Return one state after the impulse along a covector, that of a gap, which changes the rate of the gap."""

    @abc.abstractmethod
    def rate_along(self, normal: Float[np.ndarray, "dim"]) -> float:
        """Return the rate of a gap in the first state, whose derivative is a covector; zero if it is rounding."""

    @staticmethod
    def sum_of_rates(parts: Float[np.ndarray, "k"]) -> float:
        """Return the sum of the parts of a rate; zero if what they leave is rounding."""
        rate = float(parts.sum())
        return rate if abs(rate) > _CANCELED * np.abs(parts).sum() else 0.0

    @staticmethod
    def after_impulse(momentum: np.ndarray, change: np.ndarray) -> np.ndarray:
        """Return a momentum after a change; zero where what this leaves is rounding."""
        after = momentum + change
        return np.where(np.abs(after) <= _ENDED * np.abs(change), 0.0, after)

    def refuse_reset(self, where: str) -> None:
        """Refuse impacts of motions that have no reflection in the energy."""

    @property
    def space(self) -> Any:
        """Where it moves: a group, or the names of coordinates."""
        return self.group

    @abc.abstractmethod
    def at(self, times: Any) -> "AbstractOrbit":
        """Return the states at any times of the span."""

    @abc.abstractmethod
    def rows(self) -> dict[str, np.ndarray]:
        """Return the arrays with a row for each state; impulses that are not known are NaN."""

    def of_rows(self: SelfT, rows: dict[str, np.ndarray]) -> SelfT:
        """Return the orbit of other rows."""
        return dataclasses.replace(cast(Any, self), **rows)

    def chosen(self: SelfT, states: slice | np.ndarray) -> SelfT:
        """Return some of the states, by a slice, a mask or their numbers, each with the same `save_every` as before."""
        at = selection(f"{type(self).__name__}.chosen(states=...)", states, len(self))
        return self.of_rows({name: rows[at] for name, rows in self.rows().items()})

    def __getitem__(self: SelfT, states: slice) -> SelfT:
        """Return the orbit at a forward slice of its states."""
        if not isinstance(states, slice):
            raise TypeError(f"`Orbit[...]` takes slices. Got {states!r}. Index an array instead: orbit.momentum[0].")
        stride = states.indices(len(self))[2]
        if stride < 1:
            raise ValueError(f"`Orbit[...]` must be sliced forwards. Got stride {stride}. Reverse the arrays instead.")
        return dataclasses.replace(cast(Any, self.chosen(states)), save_every=self.save_every * stride)

    def joined(self: SelfT, others: Sequence[SelfT]) -> SelfT:
        """Return the states with those of other parts of the same motion after them."""
        parts = [part.rows() for part in (self, *others)]
        first, *logs = {id(part.events): part.events for part in (self, *others)}.values()
        whole = self.of_rows({name: np.concatenate([part[name] for part in parts]) for name in parts[0]})
        return dataclasses.replace(cast(Any, whole), events=first.joined(logs)) if logs else whole

    def with_headings(self: SelfT, before: float | None) -> SelfT:
        """Return the states with headings that continue from the given one, where there are any."""
        del before
        return self

    @abc.abstractmethod
    def to_dataset(self) -> Any:
        """Return the orbit as a labeled `xarray.Dataset`."""

    @memo
    def has_every_step(self) -> bool:
        """Whether each state but the first is one step after the one before, without an impact between them."""
        h, is_next = self.time_step, bool((np.diff(self.step) == 1).all())
        return is_next and not self.has_impacts.any() and (h is None or np.allclose(np.diff(self.time), h))

    @memo
    def has_impacts(self) -> Bool[np.ndarray, "K"]:
        """Whether there was an impact in the step from each state, after it and up to the end of the step."""
        return np.isin(self.step, [] if self.events is None else self.events.impact_steps)

    @property
    @abc.abstractmethod
    def lacks_forces(self) -> bool:
        """Whether a table has forces of steps between the states."""

    def with_every_step(self: SelfT) -> SelfT:
        """Return the motion at every step from the first state to the last; those left out are computed again.

        Raises:
            ValueError: States between two steps or not in their order, a motion whose steps cannot be repeated, or more
                steps than memory holds.
        """
        where, gaps, remedy = "Orbit.work", np.diff(self.step), "Take states of the run in their order."
        if (gaps < 0).any() or not np.allclose(np.diff(self.time), gaps * (self.time_step or np.nan)):
            got = "others, under a force for each step"
            raise error(where, "have states at steps of one run, in their order", got, remedy)
        size = sum(each.nbytes for each in self.rows().values()) / len(self)
        within_memory(where, 2.0 * size * gaps.sum(), "Pass a part of the orbit.")
        last, parts = self.chosen(slice(0, -1)), []
        for count in range(1, gaps.max(initial=1)):
            last, gaps = last.chosen(gaps > count), gaps[gaps > count]
            last = self.motion.after_parts(last, np.ones(len(last)))
            parts.append(last)
        whole = self.joined(parts)
        return whole.chosen(np.unique(whole.step, return_index=True)[1])

    @property
    def known_work(self) -> Float[np.ndarray, "K"]:
        """The work; NaN where it is not known without computing steps again, or without poses."""
        try:
            return np.full(len(self), np.nan) if self.lacks_forces else self.work
        except ValueError:
            return np.full(len(self), np.nan)

    def __len__(self) -> int:
        return len(getattr(self, self.momenta[0]))

    def _repr_html_(self) -> str:
        rows = [("system", repr(self.system)), ("states", f"{len(self):,}")]
        if len(self):
            energy = f"{self.energy[0]:.6g} at first, between extremes {np.ptp(self.energy):.2g}"
            rows += [("time", f"{self.time[0]:g} to {self.time[-1]:g}"), ("energy", energy)]
        return table(type(self).__name__, [*rows, ("outcome", self.outcome.name)])

    def to_pandas(self) -> Any:
        """Return the orbit as a `pandas.DataFrame` with one column for each number of `to_dataset`, indexed by time."""
        return importlib.import_module("nonholo.io").orbit_to_pandas(self)

    def to_csv(self, path: Any, *, overwrite: bool = False) -> None:
        """Write the times and configurations to a new CSV file; `nonholo.io.orbit_to_csv` names its columns."""
        importlib.import_module("nonholo.io").orbit_to_csv(self, path, overwrite=overwrite)

    def plot(self, path: str | None = None, *, overwrite: bool = False) -> Any:
        """Draw the overview picture of the orbit; return the matplotlib figure, saved to a new `path` if given."""
        return importlib.import_module("nonholo.plot").overview(self, path, overwrite=overwrite)

    def to_html(self, path: Any, *, overwrite: bool = False) -> None:
        """Write the live page of the orbit to a new HTML file, which runs in any browser; see `nh.explore`."""
        importlib.import_module("nonholo.explorer").orbit_to_html(self, path, overwrite=overwrite)
