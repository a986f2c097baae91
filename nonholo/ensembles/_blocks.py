"""One piece of work: compute a block of a sweep and write it, unless it is there and sound."""

import functools
import os
import socket
import time
from typing import NamedTuple

import numpy as np

from nonholo import io
from nonholo.base.results import Outcome
from nonholo.ensembles._block import block_of
from nonholo.ensembles.stores import OUTCOME, RAISED, Mark, Results, SweepStore, Task, attempt, store_of
from nonholo.simulation import in_one_thread


class Work(NamedTuple):
    """The message to a worker: everything but the task is read from the store."""

    store: SweepStore
    task: Task


class Done(NamedTuple):
    """The report of a worker on a block: its mark, what was wrong with an older one, the versions it works with."""

    block: int
    mark: Mark
    damage: str | None
    versions: str


def do_block(work: Work, block: int) -> Done:
    """Make sure that a block is in the store."""
    store = store_of(work.store)
    mark, damage = _standing(store, block)
    piece, begin = store.layout.piece(block), time.perf_counter()
    if mark is not None and mark.members == piece.count:  # or the sweep has grown
        return Done(block, mark, None, _versions())
    members, draws = block_of(store.design, piece.first, piece.count), store.design.drawn
    outputs = {name: output for name, output in store.outputs.items() if name not in draws}
    with in_one_thread():
        outcome = attempt(work.task, members, outputs)
    results = Results({name: members[name] for name in draws} | outcome.arrays, outcome.messages)
    mark = _mark(results, piece.count, time.perf_counter() - begin)
    store.write(piece, results, mark)
    return Done(block, mark, damage, _versions())


def _standing(store: SweepStore, block: int) -> tuple[Mark | None, str | None]:
    """Return the mark of a block that is finished and sound, and what is wrong with one that is not."""
    try:
        return (None if store.mark(block) is None else store.sound(block)), None
    except io.DamagedError as flaw:
        return None, str(flaw)


@functools.cache
def _versions() -> str:
    """Return the versions of what computes here, which do not change; looking them up takes longer than a mark."""
    return io.versions_text()


def outcome_name(code: int) -> str:
    """Return the name of an outcome of a member, also of one of the task's own."""
    if code == RAISED:
        return "raised"
    return Outcome(code).name if code in list(Outcome) else str(code)


def _mark(results: Results, members: int, seconds: float) -> Mark:
    codes, counts = np.unique(results.arrays[OUTCOME], return_counts=True)
    outcomes = {outcome_name(int(code)): int(count) for code, count in zip(codes, counts, strict=True)}
    writer = f"{socket.gethostname()}:{os.getpid()}"
    return Mark(members, outcomes, seconds, time.time(), writer, [list(message) for message in results.messages])
