"""Events of the members of an ensemble, from all single steps of a block of members."""

import dataclasses
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np

from nonholo.base.results import Outcome
from nonholo.base.types import Float, Int
from nonholo.groups import SE
from nonholo.orbit import Crossings, Orbit
from nonholo.simulation.events import Event, Part, changes, located, values_at
from nonholo.simulation.members._event_log import MemberCrossings, MemberEvents
from nonholo.simulation.members._members import Members
from nonholo.simulation.members._result import Ensemble, stacked


class Flat(NamedTuple):
    """Single steps of some members, one member after another, and what of their crossings is left.

    Attributes:
        states: All their states, as one orbit.
        member: The member of each state.
        number: The step of each state.
        values: Values of the events, (E, states).
        at: For every event the states before its crossings.
        part: Gives the states after parts of steps of a member.
    """

    states: Orbit
    member: Int[np.ndarray, "K"]
    number: Int[np.ndarray, "K"]
    values: Float[np.ndarray, "E K"]
    at: list[Int[np.ndarray, "C"]]
    part: Part


def watched_block(events: dict[str, Event], block: Ensemble, every: int | None) -> Ensemble:
    """Return what an ensemble that keeps every n-th state has, with events, of one that kept every single step."""
    end, stopped = np.array(block.steps_done), np.full(len(block), -1)
    counts = np.zeros((len(events), len(block)), dtype=np.int64)
    firsts, lasts = ([_nowhere(block) for _ in events] for _ in range(2))
    for flat in _flats(events, block):
        flat = _stopped(events, flat, end, stopped)
        for event, at in enumerate(flat.at):
            counts[event] += np.bincount(flat.member[at], minlength=len(block))
            first, last = _firsts(flat, at), _firsts(flat, at[::-1])
            outer = np.union1d(first, last)
            found = _located(events, flat, event, outer)
            for states, which in ((firsts[event], first), (lasts[event], last)):
                _fill(states, flat, found.chosen(np.searchsorted(outer, which)), which)
    crossings = (MemberCrossings(*found) for found in zip(counts, firsts, lasts, strict=True))
    log = MemberEvents(tuple(events), tuple(crossings), stopped)
    return dataclasses.replace(_thinned(block, every, end, stopped >= 0), events=log)


def _flats(events: dict[str, Event], block: Ensemble) -> Iterator[Flat]:
    """Give all members at once, or one after another where parameters differ."""
    members = np.arange(len(block))
    good = np.isfinite(block.reduced_momentum[..., 0])
    planar = block.canonical_pose is not None and block.members.discrete.system.group == SE(2)
    headings = block.heading if planar else None
    for chosen in members[:, None] if block.members.parameters else [members]:
        states, member, number = _flat_states(block, headings, chosen, good[chosen])
        values = [values_at(name, event, states) if len(states) else np.empty(0) for name, event in events.items()]
        joined = member[1:] == member[:-1]
        at = [np.flatnonzero(changes(event, row) & joined) for event, row in zip(events.values(), values, strict=True)]
        rows = np.array(values).reshape(len(events), len(states))
        yield Flat(states, member, number, rows, at, block.members.of(int(chosen[0])).after_parts)


def _flat_states(
    block: Ensemble, headings: np.ndarray | None, chosen: np.ndarray, good: np.ndarray
) -> tuple[Orbit, np.ndarray, np.ndarray]:
    """Return the good states of some members as one orbit, with their members and steps."""
    row, number = np.nonzero(good)
    member, discrete = chosen[row], block.members.of(int(chosen[0]))
    pose = None if block.canonical_pose is None else block.canonical_pose[member, number]
    turned = None if headings is None else headings[member, number]
    momenta, charts = block.reduced_momentum[member, number], block.cayley[member, number]
    time = discrete.time_step * number
    return Orbit(discrete, time, momenta, charts, pose, turned=turned, step=number), member, number


def _stopped(events: dict[str, Event], flat: Flat, end: np.ndarray, stopped: np.ndarray) -> Flat:
    """Leave out crossings after those that end a member; note in arrays of all members where they end, and by which."""
    ending = [at[_rank(flat, at) == event.last - 1] for event, at in zip(events.values(), flat.at, strict=True)]
    limit = np.full(len(end), len(flat.member))
    for at in ending:
        np.minimum.at(limit, flat.member[at], at)
    kept, moment = [at[at <= limit[flat.member[at]]] for at in flat.at], np.full(len(end), np.inf)
    within = [at[at == limit[flat.member[at]]] for at in kept]  # in the steps in which members end
    parts = [_located(events, flat, event, at) for event, at in enumerate(within)]
    gone = [part.step - flat.number[at] + part.fraction for part, at in zip(parts, within, strict=True)]
    for event, (at, part) in enumerate(zip(within, gone, strict=True)):
        ends = np.isin(at, ending[event]) & (part < moment[flat.member[at]])
        who = flat.member[at[ends]]
        moment[who], stopped[who] = part[ends], event
        end[who] = flat.number[at[ends]] + (part[ends] == 1)
    late = [at[part > moment[flat.member[at]]] for at, part in zip(within, gone, strict=True)]
    return flat._replace(at=[np.setdiff1d(at, out) for at, out in zip(kept, late, strict=True)])


def _rank(flat: Flat, at: np.ndarray) -> np.ndarray:
    """Return how many crossings of an event the same member has before each."""
    member = flat.member[at]
    return np.arange(len(at)) - np.searchsorted(member, member)


def _firsts(flat: Flat, at: np.ndarray) -> np.ndarray:
    """Return the first crossing of each member in a list of crossings."""
    return at[np.unique(flat.member[at], return_index=True)[1]]


def _located(events: dict[str, Event], flat: Flat, event: int, at: np.ndarray) -> Crossings:
    name = tuple(events)[event]
    return located(name, events[name], flat.states, flat.values[event], at, flat.part)


def _nowhere(block: Ensemble) -> Ensemble:
    """Return one state of each member, still unknown."""
    unknown = {name: np.full((len(block), 1, column.shape[2]), np.nan) for name, column in block.columns.items()}
    return dataclasses.replace(block, save_every=None, columns=unknown, steps_done=np.full(len(block), np.nan))


def _fill(states: Ensemble, flat: Flat, found: Crossings, at: np.ndarray) -> None:
    """Write crossings into the states of their members."""
    who, rows = flat.member[at], found.states.rows()
    for name, column in states.columns.items():
        column[who, 0] = rows[name]
    states.steps_done[who] = found.step + found.fraction


def _thinned(block: Ensemble, every: int | None, end: np.ndarray, stopped: np.ndarray) -> Ensemble:
    """Return the states that are kept of members that end with certain steps."""
    if every is None:
        kept = {name: np.take_along_axis(rows, end[:, None, None], axis=1) for name, rows in block.columns.items()}
    else:
        late = every * np.arange(block.cayley[:, ::every].shape[1]) > end[:, None]
        kept = {name: np.where(late[..., None], np.nan, rows[:, ::every]) for name, rows in block.columns.items()}
    outcome = np.where(stopped, int(Outcome.successful), block.outcome)
    return dataclasses.replace(block, save_every=every, columns=kept, outcome=outcome, steps_done=end)


def log_of(batch: Ensemble, orbits: Sequence[Any]) -> MemberEvents:
    """Return what the runs of members found."""
    logs = [orbit.events for orbit in orbits]
    names, each = logs[0].names, zip(*(log.found for log in logs), strict=True)
    found = (MemberCrossings(np.array([len(x) for x in own]), *_ends(batch, own)) for own in each)
    stopped = [names.index(log.stopped_by) if log.stopped_by else -1 for log in logs]
    return MemberEvents(names, tuple(found), np.array(stopped))


def _ends(batch: Ensemble, own: tuple[Crossings, ...]) -> Iterator[Ensemble]:
    """Give the first crossings of members, and the last ones."""
    for one in (slice(0, 1), slice(-1, None)):
        done = np.array([(x.step + x.fraction)[one].sum() if len(x) else np.nan for x in own])
        columns = stacked([x.states.chosen(one) for x in own], 1)
        yield dataclasses.replace(batch, save_every=None, columns=columns, steps_done=done)


def joined_blocks(whole: Members, blocks: Sequence[Ensemble]) -> Ensemble:
    """Return the ensemble of all members from blocks of them."""
    names = ("outcome", "steps_done", "first_momentum", "first_pose")
    arrays = {name: np.concatenate([getattr(block, name) for block in blocks]) for name in names}
    columns = {name: np.concatenate([block.columns[name] for block in blocks]) for name in blocks[0].columns}
    logs = [block.events for block in blocks if block.events is not None]
    log = _joined_log(whole, logs) if logs else None
    return dataclasses.replace(blocks[0], members=whole, columns=columns, **arrays, events=log)


def _joined_log(whole: Members, logs: Sequence[MemberEvents]) -> MemberEvents:
    found = tuple(
        MemberCrossings(
            np.concatenate([part.count for part in column]),
            joined_blocks(whole, [part.first for part in column]),
            joined_blocks(whole, [part.last for part in column]),
        )
        for column in zip(*(log.found for log in logs), strict=True)
    )
    return MemberEvents(logs[0].names, found, np.concatenate([log.stopped_by for log in logs]))
