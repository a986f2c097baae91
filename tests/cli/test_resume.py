"""`resume`, `extend`, `export`, and what `info` says of a run that is not finished."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from commands import Command, assert_ends, assert_shows, json_of
from stopping import failing_at, stopped_at

import nonholo as nh
from nonholo.io.places import write_lock
from nonholo.simulation import _run, _stored

SLEIGH = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1)
START = {"body_velocity": (1.0, 0.3, 0.0)}


@pytest.fixture(autouse=True)
def _short_blocks(monkeypatch: pytest.MonkeyPatch) -> None:
    """Blocks of 16 states, so that small runs take several."""
    monkeypatch.setattr(_run, "_ROWS", 16)


@pytest.fixture
def stopped() -> Path:
    """A run of 500 steps that Ctrl-C stopped in its sixth block of 40."""
    with stopped_at(5):
        nh.simulate(SLEIGH, steps=500, store="run.zarr", checkpoint_every=40, **START)
    return Path("run.zarr")


def test_info_says_how_far_a_run_came(stopped: Path, nonholo: Command) -> None:
    """`info` of an unfinished run says how far it came and how to resume, as a table and as JSON."""
    assert_shows(nonholo("info", stopped), "199 of 500, 39.8 %", "nonholo resume run.zarr")
    report = json_of(nonholo("info", stopped, "--json"))
    assert report["unfinished"] == {"done": 199, "steps": 500, "owner": None}


def test_resume_finishes_a_run(stopped: Path, nonholo: Command) -> None:
    """`resume` ends with the undisturbed run and its invariants."""
    report = json_of(nonholo("resume", stopped, "--json"))
    assert (report["steps"], report["outcome"]) == (500, "successful")
    assert np.array_equal(nh.load_orbit(stopped).pose, nh.simulate(SLEIGH, steps=500, **START).pose)
    assert "unfinished" not in json_of(nonholo("info", stopped, "--json"))


def test_extend_that_was_stopped_is_asked_again(stopped: Path, nonholo: Command) -> None:
    """`extend` adds steps; the same call after one that was stopped does what is left, and after that adds anew."""
    nh.resume(stopped)
    command = ("extend", stopped, "--steps", 100)
    with failing_at(13):
        assert nonholo(*command).exit_code == 1
    for steps in (600, 700):
        assert_ends(nonholo(*command), 0)
        assert np.array_equal(nh.load_orbit(stopped).pose, nh.simulate(SLEIGH, steps=steps, **START).pose)


def test_extend_that_is_refused_changes_nothing(tmp_path: Path) -> None:
    """A table of forces that ends too early is noticed before the store says that it has more to do."""
    forced = nh.Forced(nh.ChaplyginSleigh(1.0, 1.0, 0.5), force=np.ones((20, 3)))
    nh.simulate(nh.discretize(forced, 0.1), steps=20, store=tmp_path / "run.zarr", **START)
    with pytest.raises(ValueError, match="25"):
        nh.extend(tmp_path / "run.zarr", 5, discrete=nh.discretize(forced, 0.1))
    assert len(nh.load_orbit(tmp_path / "run.zarr")) == 21


def test_simulate_that_was_stopped_is_asked_again(nonholo: Command) -> None:
    """The same command continues where it was stopped, draws what it lacks, and then refuses as always."""
    command = ("simulate", "sleigh", "--steps", 60, "-o", "run.zarr")
    with failing_at(3):
        assert nonholo(*command).exit_code == 1
    assert "Choose another path" in nonholo(*command, "--time-step", 0.05).stderr
    assert_ends(nonholo(*command), 0)
    assert Path("run.png").exists()
    whole = json_of(nonholo("simulate", "sleigh", "--steps", 60, "--no-plot", "--json"))["store"]
    assert np.array_equal(nh.load_orbit("run.zarr").pose, nh.load_orbit(whole).pose)
    assert 'kind = "sleigh"' in nonholo("info", "run.zarr", "--scenario").stdout
    assert nonholo(*command).exit_code == 2


def test_picture_that_a_kill_has_cost_is_drawn(nonholo: Command) -> None:
    """A run that was killed between its store and its picture is not run again: its picture is drawn."""
    command = ("simulate", "sleigh", "--steps", 20, "-o", "run.zarr")
    assert nonholo(*command).exit_code == 0
    Path("run.png").unlink()
    things = Path("run.zarr/zarr.json").stat().st_mtime_ns
    assert nonholo(*command).exit_code == 0
    assert Path("run.png").exists()
    assert Path("run.zarr/zarr.json").stat().st_mtime_ns == things


def test_damage_is_told_on_standard_error(stopped: Path, nonholo: Command) -> None:
    """A damaged chunk is named in a warning, and the run is whole again."""
    nh.resume(stopped)
    (stopped / "canonical" / "pose" / "c" / "2" / "0").unlink()
    assert_ends(nonholo("resume", stopped), 0, "Warning: The store", "chunk c/2/0 of the array canonical/pose")


def test_ctrl_c_ends_in_a_sentence(stopped: Path, nonholo: Command) -> None:
    """Not in a traceback; a damaged chunk is named even if Ctrl-C comes before its block is whole again."""
    with failing_at(5):
        assert_ends(nonholo("resume", stopped), 1, "Stopped at step 199 of 500")
    (stopped / "canonical" / "pose" / "c" / "2" / "0").unlink()
    with failing_at(2):
        assert_ends(nonholo("resume", stopped), 1, "chunk c/2/0 of the array canonical/pose")


def test_locked_and_foreign_stores_are_refused(stopped: Path, nonholo: Command) -> None:
    """A store that another process writes and one that does not exist end in a sentence and exit code 2."""
    with write_lock(stopped):
        (stopped / "run" / "lock.json").write_text('{"pid": 1, "host": "elsewhere", "since": "today"}')
        assert_ends(nonholo("resume", stopped), 2, "process 1 on elsewhere since today")
        assert_shows(nonholo("info", stopped), "written by process 1 on elsewhere")
    assert nonholo("extend", "nothing.zarr", "--steps", 3).exit_code == 2


def test_long_run_replaces_a_store_only_when_told(nonholo: Command) -> None:
    """A store of several blocks is refused and replaced like any other, and the next number is taken without -o."""
    command = ("simulate", "sleigh", "--no-plot", "--steps")
    assert nonholo(*command, 50, "-o", "run.zarr").exit_code == 0
    assert_ends(nonholo(*command, 70, "-o", "run.zarr"), 2, "--overwrite")
    assert nonholo(*command, 70, "-o", "run.zarr", "--overwrite").exit_code == 0
    assert len(nh.load_orbit("run.zarr")) == 71
    for number in (1, 2):
        assert nonholo(*command, 50, "-q").stdout == f"runs/sleigh-00{number}.zarr\n"


def test_older_store_stays_where_nothing_replaces_it(nonholo: Command) -> None:
    """A start without a principal root keeps nothing, and --overwrite takes nothing away for it."""
    command = ("simulate", "suslov", "--no-plot", "-o", "run.zarr", "--steps", 50)
    assert nonholo(*command).exit_code == 0
    assert_ends(nonholo(*command, "--overwrite", "--time-step", 1.2), 1, "Nothing to keep")
    assert len(nh.load_orbit("run.zarr")) == 51


def test_figures_of_the_last_block_say_so(nonholo: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where an orbit is too large to be loaded the steps are all of them, and the figures say what they are of."""
    monkeypatch.setattr(_stored, "_LOADED", 100)
    command = ("simulate", "sleigh", "--steps", 100, "--no-plot")
    assert_shows(nonholo(*command), "100 of 100", "the last 5 states; the store has all")
    assert json_of(nonholo(*command, "--json"))["steps"] == 100


@pytest.fixture
def store() -> Path:
    """A finished run of 51 states."""
    nh.simulate(SLEIGH, steps=50, store="run.zarr", checkpoint_every=20, **START)
    return Path("run.zarr")


def test_standard_output_is_the_file(store: Path, nonholo: Command) -> None:
    """Without -o the rows go to standard output and nothing else does; with it the path does."""
    text = assert_ends(nonholo("export", store), 0)
    assert text.stderr == ""
    assert nonholo("export", store, "-o", "poses.csv").stdout == "poses.csv\n"
    nh.load_orbit(store).to_csv("orbit.csv")
    assert text.stdout == Path("poses.csv").read_text() == Path("orbit.csv").read_text()


def test_unfinished_run_is_told_on_standard_error(nonholo: Command) -> None:
    """The finished blocks of a stopped run are exported, and standard error says how far they go."""
    with stopped_at(2):
        nh.simulate(SLEIGH, steps=50, store="run.zarr", checkpoint_every=20, **START)
    result = nonholo("export", "run.zarr")
    result = assert_ends(result, 0, "Warning: The run in 'run.zarr' is not finished: its poses go up to step 39 of 50")
    assert len(result.stdout.splitlines()) == 41


@pytest.mark.parametrize("arguments", [("nothing.zarr",), ("run.zarr", "--every", 0)], ids=["no store", "every 0"])
@pytest.mark.usefixtures("store")
def test_wrong_usage_is_refused(arguments: tuple[object, ...], nonholo: Command) -> None:
    """What can be seen to be wrong before any work has exit code 2."""
    assert assert_ends(nonholo("export", *arguments), 2).stdout == ""


@pytest.mark.profile("faults", instead="test_standard_output_is_the_file")
def test_reader_that_stops_is_no_error() -> None:
    """A pipe that is closed after the first rows, as `head` does, ends the command without a word."""
    nh.simulate(
        SLEIGH, steps=20_000, store="run.zarr", checkpoint_every=10_000, **START
    )  # a megabyte of text, more than a pipe holds
    read, write = os.pipe()
    command = [sys.executable, "-c", "from nonholo.cli._app import main; main()", "export", "run.zarr"]
    with subprocess.Popen(command, stdout=write, stderr=subprocess.PIPE, text=True) as process:  # noqa: S603
        os.close(write)
        with os.fdopen(read) as rows:
            assert rows.readline() == "t,x,y,theta\n"
        assert process.communicate()[1] == ""
    assert process.returncode == 0
