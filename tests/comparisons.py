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
