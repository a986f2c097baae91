"""`nonholo plot`: every kind of picture of a run, and what is asked of it."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from commands import Command, assert_ends
from matplotlib.figure import Figure
from PIL import Image

import nonholo as nh
from nonholo.cli.screen.pictures import figure_of, kinds


def _sleigh(**options: Any) -> nh.Orbit:
    return nh.simulate(nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.5), body_velocity=(0.3, -1, 0), **options)


def _top() -> nh.Orbit:
    top = nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]])
    return nh.simulate(nh.discretize(top, 0.1), body_velocity=(0.4, 0.9, 0.0), steps=20)


def _free() -> nh.Orbit:
    return nh.simulate(nh.discretize(nh.RigidBody(np.diag([1.0, 3.0, 2.0])), 0.1), body_velocity=(0.1, 0, 1), steps=20)


def test_every_kind_of_picture() -> None:
    """Each function that draws a run is a kind, named with hyphens, and gives a figure with the title that is asked."""
    functions = {name.replace("_", "-") for name in nh.plot.__all__ if name.islower()}
    assert set(kinds()) == functions - {"animate", "comparison", "convergence", "curvature", "sweep-map"}
    sleigh = _sleigh(steps=20, events=[nh.cusp])
    others = {"body-axis-track": _top(), "momentum-sphere": _free()}
    for kind in kinds():
        names = {"across": "body_velocity.0", "up": "heading"} if kind == "section" else {}
        figure = figure_of(kind, others.get(kind, sleigh), {"title": "Mine"}, **names)
        assert isinstance(figure, Figure)
        axes = figure.axes[0]
        title = figure.texts[0].get_text() if kind == "overview" else axes.get_title(loc="left")
        assert title == "Mine", kind
        if kind == "section":
            assert (axes.get_xlabel(), axes.get_ylabel()) == ("body velocity.0", "heading")


def test_options_of_pictures(nonholo: Command) -> None:
    """Kind, title, size, dots per inch and background of the picture are what the options say."""
    nh.save_orbit(_sleigh(steps=20), "a.zarr")
    options = ("--kind", "blade-track", "--size", "8x4.5", "--dpi", 40, "--dark", "--title", "Mine")
    assert_ends(nonholo("plot", "a.zarr", *options), 0)
    with Image.open("a.png") as picture:
        assert picture.size == (320, 180)
        assert max(picture.convert("RGB").getpixel((0, 0))) < 40
    assert nonholo("plot", "a.zarr", *options, "-o", "a.svg").exit_code == 0
    assert ">Mine</text>" in Path("a.svg").read_text()


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--kind", "portrait"), "--kind must be one of overview, "),
        (("--size", "16"), "--size must be width and height in inches, 1 to 100, as 16x9. Got '16'"),
        (("--size", "0x9"), "--size must be width and height"),
        (("--kind", "branches", "--gif"), "Leave --kind out"),
        (("--x", "momentum.0"), "--x and --y for --kind section too"),
    ],
)
def test_refusals(options: tuple[str, ...], words: str, nonholo: Command) -> None:
    """Unknown kinds, sizes and contradictions are refused before the store is read."""
    nh.save_orbit(_sleigh(steps=2), "a.zarr")
    assert_ends(nonholo("plot", "a.zarr", *options), 2, words)


def test_what_a_section_needs(nonholo: Command) -> None:
    """A run without events has no section, and its refusal says what has one; so does a quantity that is none."""
    nh.save_orbit(_sleigh(steps=2), "a.zarr")
    ended = nonholo("plot", "a.zarr", "--kind", "section", "--x", "heading", "--y", "time")
    assert_ends(ended, 1, "must hold crossings of an event")
    with pytest.raises(ValueError, match=r"needs --x and --y like body_velocity.0. Got 'speed' to run across"):
        figure_of("section", _sleigh(steps=20, events=[nh.cusp]), {}, across="speed", up="time")
