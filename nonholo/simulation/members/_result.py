"""The result of `ensemble`: columns of the orbits of all members, decoded on access; events from their single steps."""

import dataclasses
import importlib
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from nonholo.base.checks import error, natural
from nonholo.base.numerics import applied
from nonholo.base.results import Outcome, result
from nonholo.base.types import Bool, Float, Int
from nonholo.groups import SE
from nonholo.orbit import AbstractEventLog, Crossings
from nonholo.simulation._event import Event
from nonholo.simulation._search import find_crossings, locate, values_of
from nonholo.simulation.members._members import Members, ScalarMembers, energies, in_lanes


@result
class MemberCrossings:
    """The crossings of one event in the members of an ensemble.

    Attributes:
        count: How many each member has, (M,).
        first: The states at the first one, an ensemble of one state each; NaN, also its time, if there is none. Its
            `steps_done` are the steps with their fractions.
        last: The states at the last one.
    """

    count: Int[np.ndarray, "M"]
    first: Any
    last: Any


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class MemberEvents(AbstractEventLog[MemberCrossings]):
    """The crossings of all events in the members of an ensemble, by name or position.

    Attributes:
        names: The names of the events.
        found: Their crossings.
        stopped_by: The position of the event that ended each member, -1 if it ran its full length, (M,).

    Example:
        >>> sleigh = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1)
        >>> batch = nh.ensemble(sleigh, restricted_velocity=[[0.1, -1], [0.1, 1]], steps=200, events=[nh.cusp])
        >>> batch.events["cusp"].count, batch.events["cusp"].first.time[:, 0].round(3)
        (array([1, 0]), array([7.169,   nan]))
    """

    names: tuple[str, ...]
    found: tuple[MemberCrossings, ...]
    stopped_by: Int[np.ndarray, "M"]

    def __repr__(self) -> str:
        each = zip(self.names, self.found, strict=True)
        counts = ", ".join(f"{name}: {crossings.count.sum()}" for name, crossings in each)
        return f"<MemberEvents of crossings: {counts}, {np.sum(self.stopped_by >= 0)} members stopped>"


_OF_FRAME = ("configuration", "pose", "position", "displacement")
_COUNTED = ("step", "time")  # which follow from the steps done


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class Ensemble:
    r"""Motions of M members at K saved states, from `ensemble`: arrays as in an `Orbit`, with a leading member axis.

    With `save_every=None` K = 1, and the state is the last good one of each member, after `steps_done` steps. Otherwise
    row j is the state after j `save_every` steps; of flows that at the j-th time. A member that ends early has NaN in
    its later rows. A member that cannot start has only NaN. `outcome` tells them apart.

    Attributes:
        members: The system, and the parameters.
        steps: Number of steps N; of flows the number of times after the first.
        save_every: Steps between saved states; None if only the last one is kept.
        columns: The arrays of the orbits by name, shapes (M, K, ...): `reduced_momentum` and others of bodies, what
            an orbit tells in coordinates.
        outcome: How each member ended, values of `Outcome`, shape (M,).
        steps_done: Good steps of each member, shape (M,); of states at crossings with the fraction of the last one.
        first_momentum: Momenta of the starts, of bodies compact ones in the canonical frame, shape (M, k).
        first_pose: Compact poses of the starts of bodies, canonical frame, places in coordinates, shape (M, ...).
        events: Crossings of `events=`, a `MemberEvents`: by name or position how many crossings each member
            has, and the states at the first and the last. None without `events=`.
        branch: The branch rule of the steps, as in `Orbit`.

    Example:
        >>> sleigh = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1)
        >>> batch = nh.ensemble(sleigh, restricted_velocity=[[1, 0], [0, 1], [9, -9]], steps=100)
        >>> batch.momentum.shape, batch.steps_done, str(batch.orbit(2).outcome)
        ((3, 1, 3), array([100, 100,   0]), 'no_real_branch')

        Flows know full turns:

        >>> flows = nh.ensemble(sleigh.system, restricted_velocity=[[1, 0], [0, 1]], times=(0.0, 5.0))
        >>> flows.heading.round(6)
        array([[0.      , 3.036242],
               [0.      , 0.      ]])
    """

    members: Members
    steps: int
    save_every: int | None
    columns: dict[str, Float[np.ndarray, "M K ..."]]
    outcome: Int[np.ndarray, "M"]
    steps_done: Int[np.ndarray, "M"] | Float[np.ndarray, "M"]
    first_momentum: Float[np.ndarray, "M k"]
    first_pose: Float[np.ndarray, "M ..."]
    events: MemberEvents | None = None
    branch: str = "principal"

    def __len__(self) -> int:
        return len(self.members)

    def __repr__(self) -> str:
        counts = zip(*np.unique(self.outcome, return_counts=True), strict=True)
        ends = ", ".join(f"{count} {Outcome(int(code))}" for code, count in counts)
        kind = type(self.members.discrete.system).__name__
        return f"<Ensemble of {kind}: {len(self)} members, {self._good.shape[1]} states each, {ends}>"

    def orbit(self, member: int) -> Any:
        """Return the good states of one member as an orbit."""
        member = natural("Ensemble.orbit(member=...)", member, "Pass the number of a member, from 0.")
        if member >= len(self):
            raise error("Ensemble.orbit(member=...)", f"be below {len(self)}", str(member), "Members count from 0.")
        return self._orbit(member, self._good[member])

    def _orbit(self, member: int, rows: Bool[np.ndarray, "K"]) -> Any:
        numbers = self._step_numbers[member][rows]
        about = {"save_every": self.save_every or self.steps or 1, "step": np.nan_to_num(numbers).astype(np.int64)}
        outcome = Outcome(int(self.outcome[member]))
        return self._states(self.members.of(member), (member, rows), outcome=outcome, **about)

    def _states(self, motion: Any, rows: Any, **about: Any) -> Any:
        """Return some rows of the states as an orbit."""
        columns = {"time": self.time[rows]} | {name: column[rows] for name, column in self.columns.items()}
        return motion.orbit(branch=self.branch, **{name: columns.get(name) for name in motion.columns}, **about)

    @property
    def _good(self) -> Bool[np.ndarray, "M K"]:
        """Where members have states: there the first column is finite."""
        lead = next(iter(self.columns.values()))
        return np.asarray(np.isfinite(lead.reshape(*lead.shape[:2], -1)).all(-1))

    @property
    def _step_numbers(self) -> Int[np.ndarray, "M K"] | Float[np.ndarray, "M K"]:
        """How many steps lead to each state."""
        if self.save_every is None:
            return self.steps_done[:, None]
        lead = next(iter(self.columns.values()))
        return np.broadcast_to(self.save_every * np.arange(lead.shape[1]), lead.shape[:2])

    @property
    def reduced_momentum(self) -> Float[np.ndarray, "M K k"]:
        """Compact momenta of bodies, canonical frame."""
        return self._decode("reduced_momentum")

    @property
    def cayley(self) -> Float[np.ndarray, "M K m"]:
        """Chart coordinates of the displacements of bodies, canonical frame; refused of flows, which have none."""
        return self._decode("canonical_chart" if "cayley" not in self.columns else "cayley")

    @property
    def canonical_pose(self) -> Float[np.ndarray, "M K size"] | None:
        """Compact poses of bodies, canonical frame; None if not reconstructed."""
        return self.columns.get("canonical_pose")

    @property
    def turned(self) -> Float[np.ndarray, "M K"] | None:
        """Headings on SE(2), unwrapped, where they are known without saved states: of flows."""
        return self.columns.get("turned")

    @property
    def orbits(self) -> tuple[Any, ...]:
        """The good states of each member as an orbit."""
        return tuple(self.orbit(member) for member in range(len(self)))

    @property
    def parameters(self) -> dict[str, Float[np.ndarray, "M ..."]]:
        """Values in which members differ, by name."""
        return self.members.parameters

    @property
    def time(self) -> Float[np.ndarray, "M K"]:
        """Times of the states; with `save_every=None` that of each member's last good one."""
        column = self.columns.get("time")
        return self.members.time_step[:, None] * self._step_numbers if column is None else column

    @property
    def times(self) -> Float[np.ndarray, "K"]:
        """Times of the states of the first member, of flows those of all."""
        return self.time[0]

    @property
    def restricted_momentum(self) -> Float[np.ndarray, "M K k"]:
        """Momenta along admissible directions, of bodies along the rows of the constraint subspace.

        Spatial ones for a right-invariant constraint.
        """
        if not in_lanes(self.members):
            return self._decode("restricted_momentum")
        return applied(np.linalg.inv(ScalarMembers(self.members).frame_map)[:, None], self.reduced_momentum)

    @property
    def energy(self) -> Float[np.ndarray, "M K"]:
        """Energies; of bodies reduced constrained ones."""
        if not in_lanes(self.members):
            return self._decode("energy")
        return energies(ScalarMembers(self.members), self.reduced_momentum)

    @property
    def first_energy(self) -> Float[np.ndarray, "M"]:
        """Reduced constrained energies of the starts of bodies."""
        if in_lanes(self.members):
            return energies(ScalarMembers(self.members), self.first_momentum)
        if "reduced_momentum" not in self.columns:
            got, remedy = type(self.members.discrete.system).__name__, "Save every state, and take energy[:, 0]."
            raise error("Ensemble.first_energy", "be read from bodies on a group", got, remedy)
        rows = {"reduced_momentum": self.first_momentum[:, None], "canonical_pose": self.first_pose[:, None]}
        rows = {name: column for name, column in rows.items() if column.shape[2]}
        return dataclasses.replace(self, columns=rows, save_every=1).energy[:, 0]

    @property
    def momentum(self) -> Float[np.ndarray, "M K dim"]:
        """Momenta, of bodies in the body; decoded member by member where parameters differ, some 50 us each."""
        return self._decode("momentum")

    @property
    def body_velocity(self) -> Float[np.ndarray, "M K dim"]:
        """Admissible velocities whose momenta along the constraint are those of the states.

        In coordinates those of the steps from the states.
        """
        return self._decode("body_velocity")

    @property
    def displacement(self) -> Float[np.ndarray, "M K ..."]:
        """Displacements of single steps at the saved states, of bodies matrices W_k."""
        return self._decode("displacement")

    @property
    def configuration(self) -> Float[np.ndarray, "M K ..."]:
        """Poses as matrices (M, K, N, N), or coordinates (M, K, n)."""
        return self._decode("configuration")

    @property
    def multipliers(self) -> Float[np.ndarray, "M K s"]:
        """Impulses of constraint in the steps from the states, forces of flows; NaN where a step was not taken."""
        return self._decode("multipliers")

    @property
    def constraint_residual(self) -> Float[np.ndarray, "M K"]:
        """Largest residuals of the constraint in coordinates."""
        if not self.members.in_coordinates:
            got, remedy = type(self.members.discrete.system).__name__, "Take nh.invariants(batch.orbit(member))."
            raise error("Ensemble.constraint_residual", "be read from systems in coordinates", got, remedy)
        return self._decode("constraint_residual")

    @property
    def pose(self) -> Float[np.ndarray, "M K size"] | None:
        """Compact poses of the group in the user's body frame; None if not reconstructed."""
        if self.canonical_pose is None or not in_lanes(self.members) or self._is_shared("pose"):
            return None if self.canonical_pose is None else self._decode("pose")
        group = self.members.discrete.system.group
        frames = group.matrix_from_pose(ScalarMembers(self.members).pose)[:, None]
        if np.array_equal(frames, np.broadcast_to(group.identity, frames.shape)):
            return self.canonical_pose
        sound = np.asarray(np.isfinite(self.canonical_pose).all(-1))
        poses = group.matrix_from_pose(self.canonical_pose) @ group.inverse(frames)
        return _spread(group.pose_from_matrix(poses[sound]), sound)

    @property
    def position(self) -> Float[np.ndarray, "M K n"]:
        """Translation parts of the poses; for groups of motions."""
        return self._decode("position")

    @property
    def heading(self) -> Float[np.ndarray, "M K"]:
        """Angles of the body on SE(2): between saved states the shorter turn is assumed, from 0 at the start.

        Flows know full turns. With `save_every=None` nothing is known of them, and the angle is between -pi and pi.
        """
        group = self.members.discrete.system.group
        if group != SE(2) or self.canonical_pose is None:
            got = f"{group}" if group != SE(2) else "reconstruct=False"
            raise error("Ensemble.heading", "have poses in the plane", got, "Use configuration, or reconstruct=True.")
        if self.turned is not None:
            return self.turned
        return np.unwrap(np.arctan2(self.canonical_pose[..., 1], self.canonical_pose[..., 0]), axis=1)

    def to_dataset(self) -> Any:
        """Return the states as a labeled `xarray.Dataset` with dimensions `member` and `step`."""
        every = self.save_every or self.steps
        none = self._states(self.members.discrete, np.zeros_like(self._good), save_every=every)
        return importlib.import_module("nonholo.simulation.members._dataset").ensemble_to_dataset(self, none)

    def to_pandas(self) -> Any:
        """Return the tables of the orbits, one below the other, as a `pandas.DataFrame` by member and time."""
        import pandas

        return pandas.concat([orbit.to_pandas() for orbit in self.orbits], keys=range(len(self)), names=["member"])

    def _decode(self, name: str) -> np.ndarray:
        """Return a quantity of orbits, NaN after a member's end; at once where it is the same function for all."""
        if name in self.columns:
            return self.columns[name]
        good = self._good
        if self._is_shared(name):
            return _spread(getattr(self._states(self.members.discrete, good), name), good)
        each = (getattr(self._orbit(member, good[member]), name) for member in range(len(self)))
        return np.stack([_spread(values, rows) for values, rows in zip(each, good, strict=True)])

    def _is_shared(self, name: str) -> bool:
        """Return whether a quantity is the same function of the state for all members."""
        motion = self.members.discrete
        if name == "multipliers" or motion.forces is not None:
            return False
        is_composition = name == "displacement" and getattr(self.members.route, "order", 2) > 2
        same = set() if name == "momentum" or is_composition else {"time_step"}
        joint = self.members.joint_system
        if name in _OF_FRAME and not is_composition and joint is not None:
            same |= self.members.of_system if np.all(joint.frame == motion.system.frame) else set()
        return self.members.parameters.keys() <= same


def _spread(values: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """Return what belongs to the first of the rows in its place among all of them, NaN in the others."""
    whole = np.full((*rows.shape, *values.shape[1:]), np.nan)
    places = tuple(numbers[: len(values)] for numbers in np.nonzero(rows))
    whole[places] = values
    return whole


def stack_rows(orbits: Sequence[Any], states: int) -> dict[str, np.ndarray]:
    """Return the rows of the orbits of all members, column by column in one array, NaN where a member has none."""
    rows = [orbit.rows() for orbit in orbits]
    shapes = {name: own.shape[1:] for each in rows for name, own in each.items() if name not in _COUNTED}
    whole = {name: np.full((len(rows), states, *shape), np.nan) for name, shape in shapes.items()}
    for name, column in whole.items():
        for place, each in zip(column, rows, strict=True):
            if (own := each.get(name)) is not None:
                place[: len(own)] = own
    return whole


def watched_block(events: dict[str, Event], block: Ensemble, every: int | None) -> Ensemble:
    """Return what an ensemble that keeps every n-th state has, with events, of one that kept every single step."""
    end, stopper = np.array(block.steps_done), np.full(len(block), -1)
    counts = np.zeros((len(events), len(block)), dtype=np.int64)
    ends = [(_nowhere(block), _nowhere(block)) for _ in events]
    columns, limits = _step_columns(block), np.array([event.last for event in events.values()])
    for group in np.arange(len(block))[:, None] if block.parameters else [np.arange(len(block))]:
        motion = block.members.of(int(group[0]))
        states, member = _flat(motion, columns, group)
        values, left = values_of(events, states), np.repeat(limits[:, None], len(group), axis=1)
        places, stops, last_steps = find_crossings(events, states, values, member - group[0], left, motion.after_parts)
        stopper[group], end[group[stops >= 0]] = stops, last_steps[stops >= 0]
        for place, ((name, event), row, at) in enumerate(zip(events.items(), values, places, strict=True)):
            counts[place] += np.bincount(member[at], minlength=len(block))
            first, last = (each[np.unique(member[each], return_index=True)[1]] for each in (at, at[::-1]))
            outer = np.union1d(first, last)
            crossings = locate(name, event, states, row, outer, motion.after_parts)
            for end_of, which in zip(ends[place], (first, last), strict=True):
                _fill(end_of, member[which], crossings.chosen(np.searchsorted(outer, which)))
    each = (MemberCrossings(count, *end_of) for count, end_of in zip(counts, ends, strict=True))
    log = MemberEvents(tuple(events), tuple(each), stopper)
    return dataclasses.replace(_thin(block, every, end, stopper >= 0), events=log)


def _step_columns(block: Ensemble) -> dict[str, np.ndarray | None]:
    """Return the columns of every step; headings of the plane continue from step to step."""
    turns = block.canonical_pose is not None and block.members.discrete.system.group == SE(2)
    return {"canonical_pose": None, **block.columns, "turned": block.heading if turns else None}


def _flat(motion: Any, columns: dict[str, Any], group: Int[np.ndarray, "m"]) -> tuple[Any, Int[np.ndarray, "K"]]:
    """Return the good states of members that have one motion, one member after another, and the member of each."""
    row, number = np.nonzero(np.isfinite(columns["reduced_momentum"][group, :, 0]))
    member = group[row]
    rows = {name: None if column is None else column[member, number] for name, column in columns.items()}
    return motion.orbit(time=motion.time_step * number, step=number, **rows), member


def _nowhere(block: Ensemble) -> Ensemble:
    """Return one state of each member, still unknown."""
    unknown = {name: np.full((len(block), 1, column.shape[2]), np.nan) for name, column in block.columns.items()}
    return dataclasses.replace(block, save_every=None, columns=unknown, steps_done=np.full(len(block), np.nan))


def _fill(states: Ensemble, who: Int[np.ndarray, "m"], crossings: Crossings) -> None:
    """Write crossings into the states of their members."""
    rows = crossings.states.rows()
    for name, column in states.columns.items():
        column[who, 0] = rows[name]
    states.steps_done[who] = crossings.step + crossings.fraction


def _thin(block: Ensemble, every: int | None, end: np.ndarray, is_stopped: np.ndarray) -> Ensemble:
    """Return the states that are kept of members that end with certain steps."""
    if every is None:
        columns = {name: np.take_along_axis(rows, end[:, None, None], axis=1) for name, rows in block.columns.items()}
    else:
        late = every * np.arange(block.cayley[:, ::every].shape[1]) > end[:, None]
        columns = {name: np.where(late[..., None], np.nan, rows[:, ::every]) for name, rows in block.columns.items()}
    outcome = np.where(is_stopped, int(Outcome.successful), block.outcome)
    return dataclasses.replace(block, save_every=every, columns=columns, outcome=outcome, steps_done=end)


def log_of(batch: Ensemble, orbits: Sequence[Any]) -> MemberEvents:
    """Return what the runs of members found."""
    logs = [orbit.events for orbit in orbits]
    names, each = logs[0].names, zip(*(log.found for log in logs), strict=True)
    crossings = (MemberCrossings(np.array([len(x) for x in own]), *_ends(batch, own)) for own in each)
    stopper = [names.index(log.stopped_by) if log.stopped_by else -1 for log in logs]
    return MemberEvents(names, tuple(crossings), np.array(stopper))


def _ends(batch: Ensemble, own: tuple[Crossings, ...]) -> Iterator[Ensemble]:
    """Give the first crossings of members, and the last ones."""
    for one in (slice(0, 1), slice(-1, None)):
        moments = np.array([(x.step + x.fraction)[one].sum() if len(x) else np.nan for x in own])
        columns = stack_rows([x.states.chosen(one) for x in own], 1)
        yield dataclasses.replace(batch, save_every=None, columns=columns, steps_done=moments)


def joined_blocks(whole: Members, blocks: Sequence[Ensemble]) -> Ensemble:
    """Return the ensemble of all members from blocks of them."""
    names = ("outcome", "steps_done", "first_momentum", "first_pose")
    arrays = {name: np.concatenate([getattr(block, name) for block in blocks]) for name in names}
    columns = {name: np.concatenate([block.columns[name] for block in blocks]) for name in blocks[0].columns}
    logs = [block.events for block in blocks if block.events is not None]
    log = _joined_log(whole, logs) if logs else None
    return dataclasses.replace(blocks[0], members=whole, columns=columns, **arrays, events=log)


def _joined_log(whole: Members, logs: Sequence[MemberEvents]) -> MemberEvents:
    crossings = []
    for column in zip(*(log.found for log in logs), strict=True):
        ends = (joined_blocks(whole, [getattr(part, end) for part in column]) for end in ("first", "last"))
        crossings.append(MemberCrossings(np.concatenate([part.count for part in column]), *ends))
    return MemberEvents(logs[0].names, tuple(crossings), np.concatenate([log.stopped_by for log in logs]))
