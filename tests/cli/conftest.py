"""Every command runs in an empty folder and leaves the caches of this machine as they are."""

from pathlib import Path

import pytest
from commands import Command, Figures, json_of
from typer.testing import CliRunner

from nonholo.cli._app import app


@pytest.fixture(autouse=True)
def _empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / ".cache"))
    monkeypatch.setenv("MPLBACKEND", "agg")
    # commands are asked for files: tests/plot has the layout, which is half the time of a picture
    monkeypatch.setattr("matplotlib.layout_engine.ConstrainedLayoutEngine.execute", lambda *_: None)


@pytest.fixture
def nonholo() -> Command:
    """Run the command line in this process."""
    return lambda *arguments: CliRunner().invoke(app, [str(argument) for argument in arguments])


@pytest.fixture
def figures(nonholo: Command) -> Figures:
    """Run `simulate --json --no-plot` and return what it prints."""
    return lambda *arguments: json_of(nonholo("simulate", *arguments, "--json", "--no-plot"))
