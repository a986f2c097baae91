"""The starts of the members of an ensemble task: one for all, varied whole, or by components, some or all of them."""

from collections.abc import Sequence
from typing import Any, TypeAlias

import numpy as np

from nonholo.base.checks import error, shown
from nonholo.base.types import Float
from nonholo.discrete import Discretization
from nonholo.ensembles._block import MemberBlock
from nonholo.ensembles._names import STARTS, start_component

Start: TypeAlias = tuple[str, Float[np.ndarray, "n"]]


def check_starts(discrete: Discretization, start: Start | None, names: Sequence[str]) -> None:
    """Refuse a design that varies several starts, components that the start does not have, or leaves none."""
    whole = [name for name in names if name in STARTS]
    if len(whole) > 1:
        raise error("sweep(design=...)", "vary one start", " and ".join(whole), "Choose one.")
    varied = {name: part for name in names if (part := start_component(name))}
    if not whole and start is None:
        _check_all(discrete, varied)
    else:
        _check_components(None if whole else start, varied)


def _check_components(start: Start | None, varied: dict[str, tuple[str, int]]) -> None:
    """Refuse components of another start than that of the task, whole or not, and those that it does not have."""
    for name, (owner, component) in varied.items():
        if start is None or start[0] != owner:
            remedy = f"Pass EnsembleTask(..., {owner}=...) with what the other components are, or vary each of them."
            raise error("sweep(design=...)", "vary components of the start of the task", shown(name), remedy)
        if component >= len(start[1]):
            got = f"{name!r} of a start with {len(start[1])}"
            raise error("sweep(design=...)", "vary components that there are", got, "They are counted from 0.")


def rows_of_starts(start: Start | None, block: MemberBlock) -> dict[str, Float[np.ndarray, "count n"]]:
    """Return the start of each member of a block, by its name."""
    varied = {name: part for name in block if (part := start_component(name))}
    whole = [name for name in block if name in STARTS]
    if whole:
        name, value = whole[0], block[whole[0]]
    elif start is not None:
        name, value = start
    else:
        name, value = next(iter(varied.values()))[0], np.zeros(len(varied))
    rows = np.broadcast_to(value, (block.count, np.shape(value)[-1])).copy()
    for given, (_, component) in varied.items():
        rows[:, component] = block[given]
    return {name: rows}


def _check_all(discrete: Discretization, varied: dict[str, tuple[str, int]]) -> None:
    """Refuse components that are not all of one start, where the task has none."""
    owners = {owner for owner, _ in varied.values()}
    if not owners:
        raise error("sweep(task=...)", "have a start", "none", "Pass body_velocity=..., or vary it in the design.")
    if len(owners) > 1:
        raise error("sweep(design=...)", "vary components of one start", " and ".join(varied), "Choose one.")
    (owner,) = owners
    k, dim = discrete.system.rank, discrete.system.group.dim
    lengths: dict[str, Any] = {"body_velocity": (dim,), "restricted_velocity": (k,), "momentum": (k, dim)}
    given = sorted(component for _, component in varied.values())
    if not any(given == list(range(length)) for length in lengths[owner]):
        wanted = " or ".join(dict.fromkeys(map(str, lengths[owner])))
        remedy = f"Vary {owner}_0 to the last one, or pass EnsembleTask(..., {owner}=...) with what the others are."
        requirement = f"vary all {wanted} components of a start that is not given"
        raise error("sweep(design=...)", requirement, str(given), remedy)
