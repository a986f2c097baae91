"""Comparisons of orbits, flows and members by the names of what is read of them; derivatives by differences."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

STATE = ("time", "reduced_momentum", "cayley", "canonical_pose")


def assert_same(one: Any, other: Any, *names: str) -> None:
    """Compare bits: of the states, or of what is named."""
    for name in names or STATE:
        assert np.array_equal(getattr(one, name), getattr(other, name), equal_nan=True), name


def assert_near(one: Any, other: Any, tolerance: float, *names: str) -> None:
    """Compare what is named: no number differs by the tolerance."""
    for name in names or STATE:
        assert np.abs(getattr(one, name) - getattr(other, name)).max(initial=0.0) < tolerance, name


def assert_same_run(one: Any, other: Any, every: int = 1) -> None:
    """Compare bytes of a run with another, which keeps every n-th of its states: these, ends and crossings."""
    _assert_same_states(one[::every], other)
    for a, b in zip(one.events.found, other.events.found, strict=True) if one.events else ():
        assert_same(a, b, "step", "fraction", "direction")
        _assert_same_states(a.states, b.states)
        assert (a.after is None) == (b.after is None)
        if a.after is not None:
            _assert_same_states(a.after, b.after)
    logs = [(run.events.names, run.events.stopped_by) if run.events else () for run in (one, other)]
    assert (one.outcome, logs[0]) == (other.outcome, logs[1])
    assert one.save_every * every == other.save_every


def _assert_same_states(one: Any, other: Any) -> None:
    for name in (*STATE, "turned"):
        mine, theirs = getattr(one, name), getattr(other, name)
        assert mine is theirs is None or (mine.shape, mine.tobytes()) == (theirs.shape, theirs.tobytes()), name


def assert_member(batch: Any, member: int, alone: Any, *names: str) -> None:
    """Compare bits of a member with those of a run or flow alone."""
    for name in names or STATE:
        assert np.array_equal(getattr(batch, name)[member], getattr(alone, name)), name


def assert_joined(blocks: Sequence[Any], whole: Any, *names: str) -> None:
    """Compare bits of blocks, one after another, with those of the whole."""
    for name in names or STATE:
        assert np.array_equal(np.concatenate([getattr(block, name) for block in blocks]), getattr(whole, name)), name


def derivatives(function: Callable[[np.ndarray], np.ndarray], at: np.ndarray, offset: float = 4e-3) -> np.ndarray:
    """Return derivatives at a point by central differences of order 6, a column for each coordinate."""
    offsets, weights = offset * np.arange(1, 4), np.array([45.0, -9.0, 1.0]) / (60 * offset)
    columns = [weights @ [function(at + x * e) - function(at - x * e) for x in offsets] for e in np.eye(len(at))]
    return np.transpose(columns)
