"""The bar of progress: where it is written and what it says."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import nonholo as nh
from nonholo.base.progress import progress_bar


@pytest.fixture(autouse=True)
def _terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let standard error pass for a terminal without colors."""
    for name, value in {"TERM": "xterm", "FORCE_COLOR": "1", "NO_COLOR": "1"}.items():
        monkeypatch.setenv(name, value)


def _shown(capsys: pytest.CaptureFixture[str], wanted: bool = True) -> tuple[str, str]:
    """Tell of half of a task, in two parts; return what is on standard output and on standard error."""
    with progress_bar("states", wanted) as report:
        report(10, 40)
        report(20, 40)
    written = capsys.readouterr()
    return written.out, written.err


def test_bar_shows_what_is_done_of_the_whole(capsys: pytest.CaptureFixture[str]) -> None:
    """Each report says how much is done so far, not how much more; nothing of it is on standard output."""
    out, err = _shown(capsys)
    assert not out
    assert "states" in err
    assert "50%" in err
    assert "75%" not in err


def test_no_bar_unless_wanted(capsys: pytest.CaptureFixture[str]) -> None:
    """Where no bar is wanted reports are taken and nothing is written."""
    assert _shown(capsys, wanted=False) == ("", "")


def test_waiting_says_for_how_long(capsys: pytest.CaptureFixture[str]) -> None:
    """Where there is nothing to count, what is being done and the time that has passed are shown, if wanted."""
    for wanted in (True, False):
        with progress_bar("measuring", wanted):
            pass
        written = capsys.readouterr()
        assert not written.out
        assert ("measuring" in written.err and "0:00:00" in written.err) is wanted


def _sweep(folder: Path, **options: Any) -> object:
    task = nh.EnsembleTask(SLEIGH, steps=20, restricted_velocity=(0.3, -1.0))
    return nh.sweep(task, nh.Grid({"a": [0.1, 0.2]}), folder / f"{len(options)}.zarr", **options)


def _obstruction(_: Path, **options: Any) -> object:
    return nh.flow_obstruction(nh.discretize(nh.ChaplyginSleigh(1.0, 0.2, 1.0), 1.0), 1.125, samples=2, **options)


def _flow(_: Path, **options: Any) -> object:
    return nh.flow(SLEIGH.system, times=(0.0, 5.0), restricted_velocity=(0.3, -1.0), **options)


SLEIGH = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1)


@pytest.mark.parametrize(
    ("run", "message"),
    [(_sweep, ("trying a member", "members", "100%")), (_obstruction, ("orbits", "100%")), (_flow, ("time", "100%"))],
    ids=["sweep", "flow_obstruction", "flow"],
)
def test_long_work_shows_what_it_does(
    run: Callable[..., object], message: tuple[str, ...], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Sweeps, also while their first member is tried, and long questions show progress if wanted, else nothing."""
    run(tmp_path)
    assert capsys.readouterr().err == ""
    run(tmp_path, progress=True)
    written = capsys.readouterr().err
    for word in message:
        assert word in written, word
