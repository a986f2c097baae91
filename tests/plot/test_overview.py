"""The overview: its panels for every kind of orbit, its files, and that no settings leak."""

from pathlib import Path

import matplotlib as mpl
import numpy as np
import pytest
from PIL import Image
from plot.runs import MASS_TENSOR

import nonholo as nh


def test_series_are_the_velocities(top_orbit: nh.Orbit, sleigh_orbit: nh.Orbit) -> None:
    """The panels of velocity hold the free components; those of the sleigh its heading over pi and its speed."""
    lines = nh.plot.overview(top_orbit).axes[2].lines
    assert np.array_equal(lines[0].get_ydata(), top_orbit.body_velocity[:, 0])
    assert np.array_equal(lines[1].get_ydata(), top_orbit.body_velocity[:, 1])
    figure = nh.plot.overview(sleigh_orbit)
    heading = next(axes for axes in figure.axes if "heading" in axes.get_ylabel())
    speed = next(axes for axes in figure.axes if "speed" in axes.get_ylabel())
    assert np.allclose(heading.lines[0].get_ydata() * np.pi, sleigh_orbit.heading)
    assert np.array_equal(speed.lines[0].get_ydata(), sleigh_orbit.body_velocity[:, 1])


def test_words_name_system_step_and_outcome(sleigh_orbit: nh.Orbit) -> None:
    """The head of the figure tells the parameters, the number and size of steps, and why a run stopped."""
    words = " ".join(text.get_text() for text in nh.plot.overview(sleigh_orbit).texts)
    assert "Chaplygin sleigh" in words
    assert "$a$ = 0.5,  $b$ = 0.3" in words
    assert "200 steps of $h$ = 0.1" in words
    discrete = nh.discretize(nh.SuslovTop(MASS_TENSOR), 1.0)
    stopped = nh.simulate(discrete, body_velocity=(0.4, 0.9, 0.0), steps=40, throw=False)
    assert any("stopped: no_real_branch" in text.get_text() for text in nh.plot.overview(stopped).texts)


@pytest.mark.profile("paper", keep=["png"])
@pytest.mark.parametrize("suffix", ["png", "svg", "pdf"])
def test_files(suffix: str, sleigh_orbit: nh.Orbit, tmp_path: Path) -> None:
    """The suffix chooses the format, and `Orbit.plot` is the same picture."""
    path = tmp_path / f"picture.{suffix}"
    sleigh_orbit.plot(str(path))
    assert path.stat().st_size > 10_000
    if suffix == "png":
        with Image.open(path) as picture:
            assert picture.size == (1950, 1140)
    if suffix == "svg":
        assert ">Chaplygin sleigh</text>" in path.read_text()


def test_refuses_other_suffixes(sleigh_orbit: nh.Orbit, tmp_path: Path) -> None:
    """A suffix that is no picture format is refused before anything is drawn."""
    with pytest.raises(ValueError, match=r"`overview\(path=...\)` must end in a picture format"):
        nh.plot.overview(sleigh_orbit, tmp_path / "picture.zarr")


@pytest.mark.parametrize("draw", ["plot", "animate"])
def test_older_pictures_are_kept(draw: str, sleigh_orbit: nh.Orbit, tmp_path: Path) -> None:
    """A picture at the path is kept unless it is to be replaced; a folder is never replaced."""
    path = tmp_path / ("a.gif" if draw == "animate" else "a.png")
    functions = {
        "plot": lambda **options: sleigh_orbit.plot(str(path), **options),
        "animate": lambda **options: nh.plot.animate(sleigh_orbit, path, frames=2, **options),
    }
    path.write_text("mine")
    with pytest.raises(FileExistsError, match=r"must be new\. Got .* or pass overwrite=True"):
        functions[draw]()
    assert path.read_text() == "mine"
    functions[draw](overwrite=True)
    assert path.read_bytes() != b"mine"
    path.unlink()
    path.mkdir()
    with pytest.raises(FileExistsError, match="not a file"):
        functions[draw](overwrite=True)


def test_global_settings_are_unchanged(sleigh_orbit: nh.Orbit, tmp_path: Path) -> None:
    """Drawing and saving leave matplotlib's settings as they were."""
    before = dict(mpl.rcParams)
    nh.plot.overview(sleigh_orbit, tmp_path / "picture.png")
    assert dict(mpl.rcParams) == before
