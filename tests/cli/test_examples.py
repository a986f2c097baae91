"""Every scenario under examples/ runs and has the motion its title promises."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import nonholo as nh

_FOLDER = Path(__file__).parents[2] / "examples"
_FILES = sorted(_FOLDER.glob("*.toml"))


@pytest.mark.parametrize("path", _FILES, ids=lambda path: path.stem)
def test_example_runs(path: Path, figures: Callable[..., dict[str, Any]]) -> None:
    """Each example succeeds, with energy kept to rounding where the discretisation promises it."""
    told = figures(path, *(["--steps", 20] if path.stem == "logarithmic_difference" else []))
    assert told["outcome"] == "successful"
    assert told["energy_drift"] < (1e-3 if path.stem == "logarithmic_difference" else 1e-12)
    assert told["constraint_residual"] < 1e-14


def test_balanced_sleigh_moves_on_a_circle(figures: Callable[..., dict[str, Any]]) -> None:
    """The balanced sleigh keeps one distance from one point."""
    position = nh.load_orbit(figures(_FOLDER / "balanced_sleigh.toml")["store"]).position
    x, y = position.T
    centre = np.linalg.lstsq(np.column_stack([2 * x, 2 * y, np.ones_like(x)]), x**2 + y**2, rcond=None)[0][:2]
    assert np.ptp(np.linalg.norm(position - centre, axis=1)) < 1e-12
