"""The gallery script on turning sleighs: what it quotes, and the picture made of it."""

from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
import xarray
from scripts import script


@pytest.fixture(scope="module", name="script")
def gallery_script() -> ModuleType:
    """Return the script as a module."""
    return script("docs/gallery/sleigh_turning.py")


@pytest.fixture(scope="module")
def found(script: ModuleType) -> xarray.Dataset:
    """The sweep on a coarse grid."""
    return script.swept(16)


def test_members_are_lost_above_the_curve_only(script: ModuleType, found: xarray.Dataset) -> None:
    """None below, most above."""
    below, above = script.lost(found)
    assert below == 0
    assert above > 0.8


def test_the_curve_has_no_kink(script: ModuleType) -> None:
    """Both closed forms agree where they meet, J = 2 m a^2, to first order."""
    bounds = script.bound(2 + np.array([-1e-4, 0.0, 1e-4]))
    assert abs(bounds[1] - np.sqrt(4.5)) < 1e-14
    assert abs(np.diff(bounds, 2)[0]) < 1e-8


def test_the_picture(script: ModuleType, found: xarray.Dataset, tmp_path: Path) -> None:
    """A map with the curve, and rows with the leading term."""
    figure = script.draw(found)
    assert [len(axes.get_lines()) for axes in figure.axes[:2]] == [1, 4]
    figure.savefig(tmp_path / "picture.png")
    assert (tmp_path / "picture.png").stat().st_size > 10_000
