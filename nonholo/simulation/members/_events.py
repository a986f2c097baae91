"""Events of the members of an ensemble, from all single steps of a block of members."""

import dataclasses
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from nonholo.base.results import Outcome
from nonholo.base.types import Int
from nonholo.groups import SE
from nonholo.orbit import Crossings
from nonholo.simulation._event import Event
from nonholo.simulation._search import find_crossings, locate, values_of
from nonholo.simulation.members._members import Members
from nonholo.simulation.members._result import Ensemble, MemberCrossings, MemberEvents, stack_rows


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
        places = find_crossings(events, states, values, member - group[0], left, motion.after_parts)
        over = group[places.stopper >= 0]
        stopper[group], end[over] = places.stopper, places.end[places.stopper >= 0]
        for place, ((name, event), row, at) in enumerate(zip(events.items(), values, places.at, strict=True)):
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
    crossings = tuple(
        MemberCrossings(
            np.concatenate([part.count for part in column]),
            joined_blocks(whole, [part.first for part in column]),
            joined_blocks(whole, [part.last for part in column]),
        )
        for column in zip(*(log.found for log in logs), strict=True)
    )
    return MemberEvents(logs[0].names, crossings, np.concatenate([log.stopped_by for log in logs]))
