"""An unfinished store is continued in the columns that its metadata name, whatever a later version would write."""

import json
from pathlib import Path
from typing import Any

import pytest
from stopping import stopped_at

import nonholo as nh
from nonholo.io import orbits

SLEIGH = nh.discretize(nh.ChaplyginSleigh(1.1, 0.7, 0.3, 0.1), 0.1)
RUN: dict[str, Any] = {"body_velocity": (0.3, -1.0, 0.0), "steps": 60}
CHOSEN = orbits.stored_variables


def _without_energy(*args: Any) -> Any:
    return {name: variable for name, variable in CHOSEN(*args).items() if name != "energy"}


@pytest.mark.profile("faults", keep=["given"])
@pytest.mark.parametrize("given", [False, True], ids=["restored", "given"])
def test_a_column_added_later_breaks_no_unfinished_store(
    given: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Begun without a column that is written now, a run is resumed, repaired and extended to the bits of one run."""
    path = tmp_path / "run.zarr"
    monkeypatch.setattr(orbits, "stored_variables", _without_energy)
    with stopped_at(3):
        nh.simulate(SLEIGH, **RUN, checkpoint_every=10, store=path)
    monkeypatch.undo()
    (path / "x" / "c" / "1").unlink()
    with pytest.warns(RuntimeWarning, match="chunk c/1 of the array x. Block 1 is computed again"):
        found = nh.resume(path, discrete=SLEIGH if given else None)
    assert found.to_dataset().identical(nh.simulate(SLEIGH, **RUN).to_dataset())
    longer = nh.extend(path, 25)
    assert longer.to_dataset().identical(nh.simulate(SLEIGH, **RUN | {"steps": 85}).to_dataset())
    assert "energy" not in json.loads(json.loads((path / "zarr.json").read_text())["attributes"]["arrays"])
    assert not (path / "energy").exists()
