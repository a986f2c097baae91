"""Stores of the schemas before 0.3.0 are refused by one sentence, which says what to do; from then on they are read."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import nonholo as nh
from nonholo.ensembles import sweep_to_csv
from nonholo.io import store_to_csv
from nonholo.io.blocks import edit_attributes
from nonholo.io.places import SCHEMAS

SLEIGH = nh.discretize(nh.ChaplyginSleigh(1.3, 0.7, 0.5, b=0.3), 0.1)
REFUSAL = (
    r"must have schema {now}, the one that this version reads\. Got schema {schema}, of before 0\.3\.0, from which on "
    r"later versions read stores\. Read it with the version that wrote it, .*\"nonholo\": \"0\.2\.0\".*, and save "
    r"it as CSV, or repeat the run\."
)


def _orbit(path: Path) -> None:
    nh.simulate(SLEIGH, restricted_velocity=(0.3, -1.0), steps=9, store=path, checkpoint_every=4)


def _sweep(path: Path) -> None:
    task = nh.EnsembleTask(SLEIGH, steps=9, restricted_velocity=(0.3, -1.0))
    nh.sweep(task, nh.Grid({"b": [0.0, 0.3]}), path).close()


def _save_as_schema(path: Path, schema: int) -> None:
    versions = json.dumps({"nonholo": "0.2.0", "numpy": "2.2.0"})
    edit_attributes(path, {"schema": schema, "versions": versions})


MADE = {"nonholo.orbit": _orbit, "nonholo.sweep": _sweep}
EARLIER = [(MADE[kind], newest, schema) for kind, newest in SCHEMAS.items() for schema in range(1, newest)]
EARLIER_NAMES = [f"{make.__name__[1:]}-{schema}" for make, _, schema in EARLIER]


@pytest.mark.profile("faults", keep=["*-1", "*-3"])
@pytest.mark.parametrize(("make", "now", "schema"), EARLIER, ids=EARLIER_NAMES)
def test_every_earlier_schema_is_refused(make: Callable[[Path], None], now: int, schema: int, tmp_path: Path) -> None:
    """Whoever reads, resumes, extends or exports it reads its schema, that of this version, and what to do."""
    path = tmp_path / "run.zarr"
    make(path)
    _save_as_schema(path, schema)
    poses = tmp_path / "poses.csv"
    of_both: dict[Any, list[Callable[[Path], Any]]] = {
        _orbit: [nh.load_orbit, lambda path: nh.extend(path, 3), lambda path: store_to_csv(path, poses)],
        _sweep: [nh.load_sweep, lambda path: sweep_to_csv(path, poses)],
    }
    for opened in (nh.resume, *of_both[make]):
        with pytest.raises(ValueError, match=REFUSAL.format(now=now, schema=schema)):
            opened(path)
    assert not poses.exists()
