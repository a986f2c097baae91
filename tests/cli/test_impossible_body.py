"""An inertia tensor that no body has, in a scenario."""

from collections.abc import Callable
from pathlib import Path

from typer.testing import Result

SCENARIO = """
[body]
kind = "suslov"
inertia = [[5.0, 0.0, 0.0], [0.0, 3.1, 0.0], [0.0, 0.0, 1.5]]
[start]
restricted_velocity = [0.1, 0.2]
[run]
time_step = 0.1
steps = 5
"""


def test_it_is_told_once(nonholo: Callable[..., Result]) -> None:
    """The command says in its own words, and once, that there is no such body, and runs it."""
    Path("my.toml").write_text(SCENARIO)
    result = nonholo("simulate", "my.toml", "--no-plot")
    assert result.exit_code == 0, result.output
    assert result.stderr.count("the mass tensor has the eigenvalue -0.2") == 1
    assert "Warning: `SuslovTop.from_inertia(inertia=...)`" in result.stderr
