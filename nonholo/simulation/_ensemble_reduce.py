"""Joining what a user's reduction made of blocks of members."""

from typing import TypeAlias

import numpy as np

from nonholo._checks import error

Reduced: TypeAlias = np.ndarray | dict[str, np.ndarray]


def joined(blocks: list[tuple[int, Reduced]]) -> Reduced:
    """Join the results of blocks along the member axis, given the numbers of members.

    Example:
        >>> joined([(2, np.array([0.0, 1.0])), (1, np.array([2.0]))])
        array([0., 1., 2.])
    """
    first = blocks[0][1]
    if not isinstance(first, dict):
        return np.concatenate([_checked(count, made) for count, made in blocks])
    return {name: np.concatenate([_checked(count, made[name]) for count, made in blocks]) for name in first}


def _checked(count: int, made: object) -> np.ndarray:
    """Refuse what does not have one row for each member of the block."""
    rows = np.asarray(made)
    if rows.ndim == 0 or len(rows) != count:
        got = f"shape {rows.shape} for {count} members"
        raise error("ensemble(reduce=...)", "return arrays with a leading member axis", got, "Keep that axis.")
    return rows
