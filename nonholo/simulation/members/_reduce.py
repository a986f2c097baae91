"""Joining what a user's reduction made of blocks of members."""

from collections.abc import Iterable
from typing import TypeAlias

import numpy as np

from nonholo.base.checks import error

Reduced: TypeAlias = np.ndarray | dict[str, np.ndarray]

_WHERE = "ensemble(reduce=...)"
_ONE = ""  # the name of an array that comes without one


def joined(members: int, blocks: Iterable[tuple[int, Reduced]]) -> Reduced:
    """Join the results of blocks, which come with their numbers of members, along the member axis.

    Each result is copied to its place when it comes, so that nothing else of its block is kept.

    Example:
        >>> joined(3, [(2, np.array([0.0, 1.0])), (1, np.array([2.0]))])
        array([0., 1., 2.])
    """
    whole: dict[str, np.ndarray] = {}
    begin = 0
    for count, made in blocks:
        rows = {name: _checked(count, value) for name, value in _named(made).items()}
        whole = whole or {name: np.empty((members, *value.shape[1:]), value.dtype) for name, value in rows.items()}
        _check_same(whole, rows)
        for name, value in rows.items():
            whole[name] = whole[name].astype(np.result_type(whole[name], value), copy=False)
            whole[name][begin : begin + count] = value
        begin += count
    return whole.get(_ONE, whole)


def _named(made: Reduced) -> dict[str, np.ndarray]:
    return made if isinstance(made, dict) else {_ONE: made}


def _check_same(whole: dict[str, np.ndarray], rows: dict[str, np.ndarray]) -> None:
    """Refuse a block with other names or shapes than the first one."""
    ours, first = ({name: value.shape[1:] for name, value in found.items()} for found in (rows, whole))
    if ours != first:
        raise error(_WHERE, "return one shape for all blocks", f"{ours} after {first}", "Pad with NaN.")


def _checked(count: int, made: object) -> np.ndarray:
    """Refuse what does not have one row for each member of the block."""
    rows = np.asarray(made)
    if rows.ndim == 0 or len(rows) != count:
        got = f"shape {rows.shape} for {count} members"
        raise error(_WHERE, "return arrays with a leading member axis", got, "Keep that axis.")
    return rows
