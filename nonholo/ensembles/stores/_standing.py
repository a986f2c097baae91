"""The progress of a sweep, from the marks of its blocks; and its result."""

import collections
import math
from pathlib import Path
from typing import Any, NamedTuple

import xarray

from nonholo.base.checks import error
from nonholo.ensembles.stores._store import SweepStore, open_store
from nonholo.io import owner_of


class SweepStanding(NamedTuple):
    """The progress of a sweep.

    Attributes:
        done: Members of finished blocks.
        members: Members in total.
        outcomes: How many ended how, by name.
        rate: Members in a second of work of one worker; NaN before the first block.
        messages: Some of those for which the task raised, with what it said.
        owner: Who is writing the store, if anybody.
        finished: Whether the sweep came to its end.
    """

    done: int
    members: int
    outcomes: dict[str, int]
    rate: float
    messages: list[list[Any]]
    owner: str | None
    finished: bool

    @property
    def failed(self) -> int:
        """Members that did not succeed."""
        return self.done - self.outcomes.get("successful", 0)

    def __str__(self) -> str:
        return f"{self.done} of {self.members} members, {self.failed} of them failed"


def standing_of(path: str | Path) -> SweepStanding:
    """Say how far the sweep of a store came."""
    store = open_store(path)
    marks = [mark for _, mark in store.marks()]
    outcomes: collections.Counter[str] = collections.Counter()
    for mark in marks:
        outcomes.update(mark.outcomes)
    done, seconds = sum(mark.members for mark in marks), sum(mark.seconds for mark in marks)
    messages = [message for mark in marks for message in mark.messages]
    rate = done / seconds if seconds else math.nan
    owner = owner_of(store.path)
    return SweepStanding(done, math.prod(store.layout.sizes), dict(outcomes), rate, messages, owner, store.is_finished)


def opened_result(store: SweepStore) -> xarray.Dataset:
    """Return the result as a dataset that is loaded lazily, by the metadata of its arrays, which were checked."""
    try:
        dataset = xarray.open_zarr(store.path, chunks=None, consolidated=False)
    except Exception as failure:
        got = f"'{store.path}', where xarray cannot read them: {failure}"
        raise error("load_sweep(store=...)", "hold sound metadata", got, "Copy it again from its source.") from failure
    return _labeled(dataset[sorted(map(str, dataset.data_vars))])  # a disk lists files in any order


def _labeled(dataset: xarray.Dataset) -> xarray.Dataset:
    """Return a result whose components have names along their dimension, where all of a dimension have the same."""
    names: dict[str, set[tuple[str, ...]]] = {}
    for variable in dataset.data_vars.values():
        if components := variable.attrs.get("components"):
            names.setdefault(str(variable.dims[-1]), set()).add(tuple(components))
    own = {dim: list(*each) for dim, each in names.items() if len(each) == 1 and len(*each) == dataset.sizes[dim]}
    return dataset.assign_coords(own)
