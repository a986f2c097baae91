"""`export`: poses as CSV on standard output or in a file."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from commands import Command, assert_ends
from stopping import stopped_at

import nonholo as nh

SLEIGH = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1)
START = {"body_velocity": (1.0, 0.3, 0.0)}


@pytest.fixture
def store() -> Path:
    """A finished run of 51 states."""
    nh.simulate(SLEIGH, steps=50, store="run.zarr", checkpoint_every=20, **START)
    return Path("run.zarr")


def test_standard_output_is_the_file(store: Path, nonholo: Command) -> None:
    """Without -o the rows go to standard output and nothing else does; with it the path does."""
    shown = assert_ends(nonholo("export", store), 0)
    assert shown.stderr == ""
    kept = nonholo("export", store, "-o", "poses.csv")
    assert kept.stdout == "poses.csv\n"
    nh.load_orbit(store).to_csv("orbit.csv")
    assert shown.stdout == Path("poses.csv").read_text() == Path("orbit.csv").read_text()


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
    result = assert_ends(nonholo("export", *arguments), 2)
    assert result.stdout == ""


@pytest.mark.profile("faults", instead="test_standard_output_is_the_file")
def test_reader_that_stops_is_no_error() -> None:
    """A pipe that is closed after the first rows, as `head` does, ends the command without a word."""
    nh.simulate(SLEIGH, steps=20_000, store="run.zarr", **START)  # a megabyte of text, more than a pipe holds
    read, write = os.pipe()
    command = [sys.executable, "-c", "from nonholo.cli._app import main; main()", "export", "run.zarr"]
    with subprocess.Popen(command, stdout=write, stderr=subprocess.PIPE, text=True) as process:  # noqa: S603
        os.close(write)
        with os.fdopen(read) as rows:
            assert rows.readline() == "t,x,y,theta\n"
        assert process.communicate()[1] == ""
    assert process.returncode == 0
