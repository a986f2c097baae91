"""Kinds of map beside those of tests/matrix: in memory, in stores, block by block, extended, with events in each."""

import dataclasses
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matrix.abilities import assert_same, joined
from matrix.kinds import brake

import nonholo as nh

BODY = [[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]]
TOP = nh.SuslovTop(BODY)
STEPS, MORE, H = 14, 5, 0.1


def _of_body(system: Any, **how: Any) -> Callable[[], tuple[Any, dict[str, Any]]]:
    run = {name: how.pop(name) for name in ("branch", "backend") if name in how}
    return lambda: (nh.discretize(system, H, **how), {"restricted_velocity": (0.6, -0.4), **run})


KINDS = {
    "smallest": _of_body(TOP, branch="smallest"),
    "table": _of_body(nh.Forced(TOP, force=np.random.default_rng(0).normal(size=(40, 3)))),
    "force in Python, fixed in space": _of_body(nh.Forced(nh.VeselovaTop(BODY), force=brake)),
    "by the definition": _of_body(TOP, backend="jax"),
}
COMPILED_FOR_LONG = ("force in Python, fixed in space", "by the definition")
WITHOUT_PARTS = ("smallest",)
EVERY_KIND = pytest.mark.parametrize("kind", KINDS)
HERE = pytest.mark.profile("routes", cases=COMPILED_FOR_LONG)


@HERE
@EVERY_KIND
def test_memory_store_and_blocks_are_one_run(kind: str, tmp_path: Path) -> None:
    """The states are the same to the last bit, thinned too, and an extended store is the longer run."""
    discrete, run = KINDS[kind]()
    for every, block in ((1, 4), (3, 6)):
        how, path = {**run, "save_every": every}, tmp_path / f"{every}.zarr"
        whole = nh.simulate(discrete, steps=STEPS, **how)
        assert len(whole) == 1 + STEPS // every
        assert np.array_equal(whole.step, every * np.arange(len(whole)))
        assert_same(nh.simulate(discrete, steps=STEPS, store=path, checkpoint_every=block, **how), whole)
        assert_same(joined(list(nh.iterate(discrete, steps=STEPS, block_steps=block, **how))), whole)
        longer = nh.simulate(discrete, steps=STEPS + MORE, **how)
        assert_same(nh.extend(path, MORE, discrete=discrete), longer)
        assert np.array_equal(longer.rows()["time"][: len(whole)], whole.time)


@HERE
@EVERY_KIND
def test_events_are_found_wherever_a_run_goes(kind: str, tmp_path: Path) -> None:
    """Crossings have the same bits in memory, in a store, block by block and in the orbit; other rules have none."""
    discrete, run = KINDS[kind]()
    plain = nh.simulate(discrete, steps=STEPS, **run)
    values = plain.configuration.reshape(len(plain), -1)
    entry = int(np.argmax(np.abs(values[-1] - values[0])))
    middle = (values[STEPS // 2, entry] + values[STEPS // 2 + 1, entry]) / 2
    event = nh.Event(lambda orbit: orbit.configuration.reshape(len(orbit), -1)[:, entry] - middle, name="middle")
    if kind in WITHOUT_PARTS:
        with pytest.raises(ValueError, match="only the principal branch has them"):
            nh.simulate(discrete, steps=STEPS, events=[event], **run)
        return
    found = nh.simulate(discrete, steps=STEPS, events=[event], **run).events["middle"]
    assert len(found) > 0
    assert np.abs(event.function(found.states)).max() < 1e-13
    stored = nh.simulate(discrete, steps=STEPS, events=[event], store=tmp_path / "a.zarr", checkpoint_every=4, **run)
    blocks = list(nh.iterate(discrete, steps=STEPS, events=[event], block_steps=4, **run))
    for other in (
        stored.events["middle"].states,
        joined([block.events["middle"].states for block in blocks]),
        nh.crossings(dataclasses.replace(plain, events=None), event).states,
    ):
        assert np.array_equal(other.time, found.time)
        assert np.array_equal(other.configuration, found.states.configuration)
