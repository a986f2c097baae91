"""Every command runs in an empty folder and leaves the caches of this machine as they are."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner, Result

from nonholo.cli._app import app


@pytest.fixture(autouse=True)
def _empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / ".cache"))
    monkeypatch.setenv("MPLBACKEND", "agg")
    # commands are asked for files: tests/plot has the layout, which is half the time of a picture
    monkeypatch.setattr("matplotlib.layout_engine.ConstrainedLayoutEngine.execute", lambda *_: None)


@pytest.fixture
def nonholo() -> Callable[..., Result]:
    """Run the command line in this process."""
    return lambda *arguments: CliRunner().invoke(app, [str(argument) for argument in arguments])


@pytest.fixture
def figures(nonholo: Callable[..., Result]) -> Callable[..., dict[str, Any]]:
    """Run `simulate --json --no-plot` and return what it prints."""

    def run(*arguments: object) -> dict[str, Any]:
        result = nonholo("simulate", *arguments, "--json", "--no-plot")
        assert result.exit_code == 0, result.output
        return json.loads(result.stdout)

    return run
