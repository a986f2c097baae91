"""Ensembles in coordinates: members run one after another, each as `simulate` runs it, so with the same bits."""

import dataclasses
import math
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np

from nonholo.base.checks import array, count, error, natural, shown
from nonholo.base.limits import within_memory
from nonholo.base.progress import progress_bar
from nonholo.base.results import Outcome
from nonholo.base.types import Float, Int
from nonholo.orbit import Crossings, First
from nonholo.simulation._run import Run, ended
from nonholo.simulation.events import watched
from nonholo.simulation.members._event_log import MemberCrossings, MemberEvents
from nonholo.simulation.members._members import STEP, refused
from nonholo.simulation.members._reduce import joined
from nonholo.systems import AbstractCoordinateDiscretization, Start, one_start

_BLOCK = 1 << 23  # numbers in a block of members that is reduced, 64 MiB
_ONE = "Pass one row for each member; `simulate` runs a single one."


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class CoordinateEnsemble:
    """Motions of M members in coordinates at K saved states: the arrays of their orbits, with a leading member axis.

    With `save_every=None` K = 1, and the state is the last good one of each member, after `steps_done` steps. Otherwise
    row j is the state after j `save_every` steps; a member that ends early has NaN in its later rows.

    Attributes:
        orbits: The good states of each member, a `CoordinateOrbit` or `GroupOrbit`.
        steps: Number of steps N that were asked for.
        save_every: Steps between saved states; None if only the last one is kept.
        steps_done: Good steps of each member, shape (M,); of states at crossings with the fraction of the last one.
        parameters: Values in which members differ, by name.
        events: What `events=` of the run found, a `MemberEvents`; None without.

    Example:
        >>> particle = nh.discretize(nh.examples.particle().system, 0.1)
        >>> starts = [[1.0, 1.0, 0.0], [2.0, 1.0, 0.0]]
        >>> batch = nh.ensemble(particle, configuration=(0, 0, 0), body_velocity=starts, steps=50)
        >>> batch.configuration.shape, batch.steps_done, batch.orbit(1)
        ((2, 1, 3), array([50, 50]), <CoordinateOrbit: 1 states of 3 coordinates, time 5 to 5, successful>)
    """

    orbits: tuple[Any, ...]
    steps: int
    save_every: int | None
    steps_done: Int[np.ndarray, "M"] | Float[np.ndarray, "M"]
    parameters: dict[str, Float[np.ndarray, "M"]]
    events: MemberEvents | None = None

    def __len__(self) -> int:
        return len(self.orbits)

    def __repr__(self) -> str:
        counts = zip(*np.unique(self.outcome, return_counts=True), strict=True)
        ended = ", ".join(f"{number} {Outcome(int(code))}" for code, number in counts)
        return f"<CoordinateEnsemble: {len(self)} members, {self._states} states each, {ended}>"

    def orbit(self, member: int) -> Any:
        """Return the good states of one member as an orbit."""
        member = natural("Ensemble.orbit(member=...)", member, "Pass the number of a member, from 0.")
        if member >= len(self):
            raise error("Ensemble.orbit(member=...)", f"be below {len(self)}", str(member), "Members count from 0.")
        return self.orbits[member]

    @property
    def outcome(self) -> Int[np.ndarray, "M"]:
        """Values of `Outcome`: how each member ended."""
        return np.array([int(orbit.outcome) for orbit in self.orbits])

    @property
    def time(self) -> Float[np.ndarray, "M K"]:
        """Times of the states."""
        return self._stacked("time")

    @property
    def configuration(self) -> Float[np.ndarray, "M K ..."]:
        """Coordinates (M, K, n), or matrices (M, K, N, N) of a group."""
        return self._stacked("configuration")

    @property
    def displacement(self) -> Float[np.ndarray, "M K ..."]:
        """Displacements of single steps."""
        return self._stacked("displacement")

    @property
    def body_velocity(self) -> Float[np.ndarray, "M K n"]:
        """Velocities of the steps from the states."""
        return self._stacked("body_velocity")

    @property
    def momentum(self) -> Float[np.ndarray, "M K n"]:
        """Momenta."""
        return self._stacked("momentum")

    @property
    def restricted_momentum(self) -> Float[np.ndarray, "M K n"]:
        """Momenta along admissible directions."""
        return self._stacked("restricted_momentum")

    @property
    def multipliers(self) -> Float[np.ndarray, "M K s"]:
        """Impulses of constraint in the steps from the states; NaN where a step was not taken."""
        return self._stacked("multipliers")

    @property
    def energy(self) -> Float[np.ndarray, "M K"]:
        """Energies."""
        return self._stacked("energy")

    @property
    def constraint_residual(self) -> Float[np.ndarray, "M K"]:
        """Largest residuals of the constraint."""
        return self._stacked("constraint_residual")

    def to_dataset(self) -> Any:
        """Return the states as a labeled `xarray.Dataset` with dimensions `member` and `step`."""
        import xarray

        one = self.orbits[0].to_dataset()
        variables: dict[str, Any] = {
            name: (("member", *one[name].dims), self._stacked(str(name)), one[name].attrs)
            for name in (*one.data_vars, "time")
        }
        variables["outcome"] = "member", self.outcome, {"long_name": "how the member ended, a nonholo.Outcome"}
        variables["steps_done"] = "member", self.steps_done, {"long_name": "good steps"}
        for name, values in self.parameters.items():
            variables[name] = "member", values, {"long_name": "parameter of the member"}
        return xarray.Dataset(variables, one.drop_vars("time").coords).set_coords("time")

    @property
    def _states(self) -> int:
        return 1 if self.save_every is None else 1 + self.steps // self.save_every

    def _stacked(self, name: str) -> np.ndarray:
        """Return the rows of all members in one array, NaN where a member has none."""
        rows = [getattr(orbit, name) for orbit in self.orbits]
        filled = np.full((len(rows), self._states, *rows[0].shape[1:]), np.nan)
        for place, own in zip(filled, rows, strict=True):
            place[: len(own)] = own
        return filled


class Plan(NamedTuple):
    """What all members have in common: the map, the steps and those between saved states, and what is looked for."""

    discrete: AbstractCoordinateDiscretization
    steps: int
    every: int | None
    events: Any


def ensemble_in_coordinates(
    discrete: AbstractCoordinateDiscretization,
    *,
    configuration: Any,
    steps: Any,
    save_every: Any,
    parameters: Any,
    reduce: Callable[[Any], Any] | None,
    events: Any,
    progress: bool,
    **starts: Any,
) -> Any:
    """Run many members of a system in coordinates, or return what a function makes of them block by block."""
    steps = count("ensemble(steps=...)", steps, "Pass the number of steps.")
    if save_every is not None:
        save_every = count("ensemble(save_every=...)", save_every, "Pass the steps between saved states, or None.")
    rows = _rows(discrete, configuration, one_start("ensemble", **starts), starts, parameters)
    members = len(rows[next(iter(rows))])
    if events is not None:
        watched("ensemble", discrete.stepper(posed=True), events)
    plan = Plan(discrete, steps, save_every, events)
    most = 4 * sum(map(math.prod, discrete.system.shapes)) * (1 if save_every is None else 1 + steps // save_every)
    within_memory("ensemble(steps=...)", 8.0 * most * (members if reduce is None else 1), "Raise save_every.")
    with progress_bar("members", progress) as report:
        done = lambda more: report(more, members)  # noqa: E731
        if reduce is None:
            return _run(plan, rows, range(members), done)
        size = max(1, _BLOCK // most)
        parts = [range(begin, min(begin + size, members)) for begin in range(0, members, size)]
        return joined(members, ((len(part), reduce(_run(plan, rows, part, done))) for part in parts))


def _rows(
    discrete: AbstractCoordinateDiscretization, configuration: Any, name: str, starts: dict[str, Any], parameters: Any
) -> dict[str, np.ndarray]:
    """Return what members start with, by name, as arrays with a row for each member or with one for all."""
    pose, velocity = discrete.system.shapes
    shapes = {"configuration": pose, name: pose if name == "displacement" else velocity, STEP: ()}
    given = {"configuration": configuration, name: starts[name], **_parameters(parameters)}
    given = {key: value for key, value in given.items() if value is not None}
    several = [key for key, value in given.items() if np.ndim(value) != len(shapes[key])]
    shapes |= {key: (None, *shapes[key]) for key in several}
    rows = {key: array(f"ensemble({key}=...)", value, shapes[key], _ONE) for key, value in given.items()}
    members = _common({key: len(rows[key]) for key in several})
    return {key: x if key in several else np.broadcast_to(x, (members, *x.shape)) for key, x in rows.items()}


def _common(lengths: dict[str, int]) -> int:
    """Return the number of members, refused if there is none or several."""
    if not lengths or not all(lengths.values()):
        raise error("ensemble(...)", "have a row for each member", "no rows" if lengths else "one start", _ONE)
    if len(set(lengths.values())) > 1:
        got = ", ".join(f"{length} of {key}" for key, length in lengths.items())
        raise error("ensemble(...)", "have one number of rows", got, "Pass one row for each member, or one for all.")
    return next(iter(lengths.values()))


def _parameters(parameters: Any) -> dict[str, Any]:
    """Return the parameters of members, refused with names other than that of the time step."""
    given = {} if parameters is None else dict(parameters)
    for name in given.keys() - {STEP}:
        remedy = "A Lagrangian is a function, whose constants cannot be varied: run an ensemble for each, or a sweep."
        raise error("ensemble(parameters=...)", f"name {STEP!r} alone for a system in coordinates", shown(name), remedy)
    return given


def _run(plan: Plan, rows: dict[str, np.ndarray], part: range, report: Callable[[int], None]) -> CoordinateEnsemble:
    """Run some members, after checking the starts of all of them."""
    runs, found = [_opened(plan, rows, member) for member in part], []
    for member, run in zip(part, runs, strict=True):
        found.append(ended(*run, whole=plan.every is not None))
        report(member + 1)
    orbits, steps_done = zip(*found, strict=True)
    own = {STEP: rows[STEP][part.start : part.stop]} if STEP in rows else {}
    ensemble = CoordinateEnsemble(orbits, plan.steps, plan.every, np.array(steps_done), own)
    return ensemble if plan.events is None else dataclasses.replace(ensemble, events=_log(ensemble))


def _opened(plan: Plan, rows: dict[str, np.ndarray], member: int) -> tuple[Run, First]:
    """Return the run of a member, and its checked start."""
    start = {key: values[member] for key, values in rows.items()}
    discrete: Any = plan.discrete
    try:
        discrete = dataclasses.replace(discrete, time_step=start.pop(STEP, discrete.time_step))
        stepper = discrete.stepper(posed=True)
        watch = watched("ensemble", stepper, plan.events)
        first = discrete.first(Start.of("simulate", allowed=discrete.starts, **start), posed=True)
    except ValueError as failure:
        raise refused(member, failure) from None
    return Run(stepper, plan.steps, plan.every or plan.steps, watch, throw=False, progress=False), first


def _log(ensemble: CoordinateEnsemble) -> MemberEvents:
    """Return what the runs of members found, as the ensembles of first and last crossings."""
    logs = [orbit.events for orbit in ensemble.orbits]
    names, each = logs[0].names, zip(*(log.found for log in logs), strict=True)
    found = (MemberCrossings(np.array([len(x) for x in own]), *_ends(ensemble, own)) for own in each)
    stopped = [names.index(log.stopped_by) if log.stopped_by else -1 for log in logs]
    return MemberEvents(names, tuple(found), np.array(stopped))


def _ends(ensemble: CoordinateEnsemble, own: tuple[Crossings, ...]) -> Iterator[CoordinateEnsemble]:
    """Give the first crossings of members, and the last ones."""
    for one in (slice(0, 1), slice(-1, None)):
        done = np.array([(x.step + x.fraction)[one].sum() if len(x) else np.nan for x in own])
        orbits = tuple(x.states.chosen(one) for x in own)
        yield dataclasses.replace(ensemble, orbits=orbits, save_every=None, steps_done=done)
