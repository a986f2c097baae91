"""`resume`, `extend`, and what `info` says of a run that is not finished."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from stopping import stopped_at
from typer.testing import Result

import nonholo as nh
from nonholo.io import Stream

Command = Callable[..., Result]
SLEIGH = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1)
START = {"body_velocity": (1.0, 0.3, 0.0)}


@pytest.fixture
def stopped() -> Path:
    """A run of 500 steps that Ctrl-C stopped in its sixth block of 40."""
    with stopped_at(5):
        nh.simulate(SLEIGH, steps=500, store="run.zarr", checkpoint_every=40, **START)
    return Path("run.zarr")


def test_info_says_how_far_a_run_came(stopped: Path, nonholo: Command) -> None:
    """`info` of an unfinished run says how far it came and how to go on, as a table and as JSON."""
    shown = nonholo("info", stopped)
    assert shown.exit_code == 0
    assert "199 of 500, 39.8 %" in shown.stdout
    assert "nonholo resume run.zarr" in shown.stdout
    told = json.loads(nonholo("info", stopped, "--json").stdout)
    assert told["unfinished"] == {"done": 199, "steps": 500, "owner": None}


def test_resume_finishes_a_run(stopped: Path, nonholo: Command) -> None:
    """`resume` ends with the undisturbed run and its invariants."""
    told = json.loads(nonholo("resume", stopped, "--json").stdout)
    assert told["steps"] == 500
    assert told["outcome"] == "successful"
    whole = nh.simulate(SLEIGH, steps=500, **START)
    assert np.array_equal(nh.load_orbit(stopped).pose, whole.pose)
    assert "unfinished" not in json.loads(nonholo("info", stopped, "--json").stdout)


def test_extend_goes_past_the_end(stopped: Path, nonholo: Command) -> None:
    """`extend` adds steps to a run."""
    nh.resume(stopped)
    result = nonholo("extend", stopped, "--steps", 100)
    assert result.exit_code == 0, result.output
    assert np.array_equal(nh.load_orbit(stopped).pose, nh.simulate(SLEIGH, steps=600, **START).pose)


def test_damage_is_told_on_standard_error(stopped: Path, nonholo: Command) -> None:
    """A damaged chunk is named in a warning, and the run is whole again."""
    nh.resume(stopped)
    (stopped / "pose" / "c" / "2" / "0").unlink()
    result = nonholo("resume", stopped)
    assert result.exit_code == 0
    assert "Warning: The store" in result.stderr
    assert "chunk c/2/0 of the array pose" in result.stderr


def test_ctrl_c_says_how_to_go_on(stopped: Path, nonholo: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    """Ctrl-C ends the command with a sentence, not a traceback."""

    def interrupted(*_: Any) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(Stream, "write", interrupted)
    result = nonholo("resume", stopped)
    assert result.exit_code == 1
    assert "Stopped at step 199 of 500" in result.stderr


def test_ctrl_c_does_not_hide_damage(stopped: Path, nonholo: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    """A damaged chunk is named even if Ctrl-C ends the command before its block is whole again."""

    def interrupted(*_: Any) -> None:
        raise KeyboardInterrupt

    (stopped / "pose" / "c" / "2" / "0").unlink()
    monkeypatch.setattr(Stream, "write", interrupted)
    result = nonholo("resume", stopped)
    assert result.exit_code == 1
    assert "chunk c/2/0 of the array pose" in result.stderr


def test_locked_and_foreign_stores_are_refused(stopped: Path, nonholo: Command) -> None:
    """A store that another process writes and one that does not exist end in a sentence and exit code 2."""
    (stopped / "run" / "lock.json").write_text('{"pid": 1, "host": "elsewhere", "since": "today"}')
    refused = nonholo("resume", stopped)
    assert refused.exit_code == 2
    assert "process 1 on elsewhere since today" in refused.stderr
    assert "written by process 1 on elsewhere" in nonholo("info", stopped).stdout.replace("\n", " ")
    assert nonholo("extend", "nothing.zarr", "--steps", 3).exit_code == 2
