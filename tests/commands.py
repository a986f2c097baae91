"""Commands of `nonholo` in this process: how they end, in which words, and the JSON that they print."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeAlias

import pytest
from typer.testing import Result

from nonholo.cli.scenario.files import parse_setting
from nonholo.cli.scenario.sections import ScenarioError

Command: TypeAlias = Callable[..., Result]
Figures: TypeAlias = Callable[..., dict[str, Any]]


def words_of(result: Result) -> str:
    """Return what was printed on the standard error, without the frames and line ends of boxes."""
    return " ".join(result.stderr.replace("│", " ").split())


def assert_ends(result: Result, code: int, *words: str) -> Result:
    """Compare the exit code of a command, and find words on the standard error; return the result."""
    assert result.exit_code == code, result.output
    assert "Traceback" not in result.output
    for each in words:
        assert each in words_of(result), result.output
    return result


def output_of(result: Result) -> str:
    """Return the standard output of a command that succeeds."""
    return assert_ends(result, 0).stdout


def assert_shows(result: Result, *words: str) -> None:
    """Find words on the standard output of a command that succeeds, wherever lines end."""
    text = " ".join(output_of(result).replace("│", " ").split())
    for each in words:
        assert each in text, text


def json_of(result: Result) -> dict[str, Any]:
    """Return the object that a command prints which succeeds."""
    return json.loads(output_of(result))


def scenario_of(load: Callable[..., Any], text: str, *settings: str) -> Any:
    """Return a scenario, which is written to my.toml, under settings of the command line."""
    Path("my.toml").write_text(text)
    return load("my.toml", [parse_setting(setting) for setting in settings]).scenario


def problems_of(load: Callable[..., object], text: str, *settings: str) -> list[str]:
    """Return what is wrong with a scenario, which is written to my.toml, under settings of the command line."""
    with pytest.raises(ScenarioError) as caught:
        scenario_of(load, text, *settings)
    return [str(problem) for problem in caught.value.problems]
