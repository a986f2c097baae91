"""The comparison of discretizations: its figures on short runs, and the picture made of them."""

from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

import nonholo as nh

pytestmark = pytest.mark.profile("paper", instead="test_the_page_quotes_what_the_script_prints")


SCRIPT = "docs/gallery/compare_discretisations.py"


def test_matrix_and_skew_keep_everything(script: ModuleType) -> None:
    """Energy and the way back to rounding, order two."""
    result = script.measured("matrix", "skew", 50)
    assert np.ptp(result.energy) < 1e-14
    assert result.reversal < 1e-13
    assert abs(result.order - 2) < 0.1


def test_naive_keeps_nothing(script: ModuleType) -> None:
    """A tenth of the energy is lost in ten steps, the way back is refused, the order is one."""
    result = script.measured("matrix", "naive", 20)
    assert result.energy[-1] < -0.1
    assert np.isnan(result.reversal)
    assert abs(result.order - 1) < 0.1


def test_the_four_constraints_differ(script: ModuleType) -> None:
    """The body's subspace belongs to no symmetric pair, and its exponential is no Cayley image."""
    system = script.body()
    assert not nh.is_symmetric_pair(system.group, system.constraint_subspace)
    assert script.discretized("matrix", "exponential").variety.exponential


def test_the_published_pair(script: ModuleType) -> None:
    """Both maps of the Suslov top are of order two; the energy is kept by the one that is not consistent."""
    drifts = script.published_drift(10)
    consistent, other = drifts.values()
    assert consistent > 1e-5
    assert other < 1e-14
    for errors in script.published(4).values():
        assert abs(np.log2(errors[-2] / errors[-1]) - 2) < 0.05


def test_the_picture(script: ModuleType, tmp_path: Path) -> None:
    """Six panels with their curves, written as a file."""
    energy = np.zeros(5)
    table = {(a, b): script.Figures(energy, 0.0, 2.0) for a in script.DIFFERENCES for b in script.CONSTRAINTS}
    orbit = nh.simulate(script.discretized("matrix", "skew"), restricted_velocity=script.VELOCITY, steps=5)
    errors = {label: np.geomspace(1e-3, 1e-5, 4) for label in script.PUBLISHED}
    orbits = dict.fromkeys((*script.PATHS, "flow"), orbit)
    figure = script.draw(table, orbits, errors, dict.fromkeys(script.PUBLISHED, 1e-4))
    assert [len(axes.get_lines()) for axes in figure.axes] == [4, 4, 4, 3, 3, 3]
    figure.savefig(tmp_path / "picture.png")
    assert (tmp_path / "picture.png").stat().st_size > 10_000
