"""What callers ask of pictures: titles, names, colors, words, sizes, backgrounds; all of it of every picture."""

import inspect
from collections.abc import Callable
from pathlib import Path
from typing import Any

import matplotlib as mpl
import matplotlib.style
import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure
from matplotlib.text import Text
from plot.runs import MASS_TENSOR, run_of, sleigh_run, top_run
from refusals import refusals

import nonholo as nh
import nonholo.plot.geometry._locus
from nonholo.lagrange_dalembert import CoordinateOrbit, LagrangeDAlembert
from nonholo.plot import theme

_SLEIGH = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5, 0.3), 0.5)
_TOP = nh.discretize(nh.SuslovTop(MASS_TENSOR), 0.5)
_IN_SPACE = nh.discretize(nh.RigidBody(np.diag([1.0, 2.0, 3.0, 1.0]), nh.SE(3)), 0.1)
_NOTHING: dict[str, Any] = {"title": "", "legend": False, "annotate": False}
_START = nh.SE(2).exp(np.array([0.3, -0.6, 0.0]))


def _short() -> nh.Orbit:
    return sleigh_run((0.1, -1.0, 0.0), steps=120)


def _run(discrete: nh.Discretization) -> nh.Orbit:
    return nh.simulate(discrete, body_velocity=(0.3, 0.5, 0.0), steps=4)


def _crossings() -> nh.Crossings:
    return nh.crossings(_short(), nh.Event(lambda states: states.body_velocity[:, 1]))


def speed(states: nh.Orbit) -> np.ndarray:
    """Return the speed along the blade."""
    return states.body_velocity[:, 1]


PICTURES: dict[str, Callable[..., Any]] = {
    "blade_track": lambda **look: nh.plot.blade_track(_short(), **look),
    "body_axis_track": lambda **look: nh.plot.body_axis_track(top_run((0.4, 0.9, 0.0), steps=40), **look),
    "branch_counts": lambda **look: nh.plot.branch_counts(_SLEIGH, _run(_SLEIGH), **look),
    "branch_tree": lambda **look: nh.plot.branch_tree(_SLEIGH, nh.branch_tree(_SLEIGH, _START, 2), **look),
    "branches": lambda **look: nh.plot.branches(_SLEIGH, displacement=_START, **look),
    "energy_error": lambda **look: nh.plot.energy_error(_short(), **look),
    "invariant_curves": lambda **look: nh.plot.invariant_curves(_SLEIGH, _run(_SLEIGH), energies=[1.0], **look),
    "locus_section": lambda **look: nh.plot.locus_section(nh.momentum_locus(_TOP, 12), offset=0.5, **look),
    "momentum_locus": lambda **look: nh.plot.momentum_locus(nh.momentum_locus(_TOP, 12), _run(_TOP), **look),
    "momentum_sphere": lambda **look: nh.plot.momentum_sphere(run_of(nh.RigidBody(np.diag([1.0, 3.0, 2.0]))), **look),
    "phase_portrait": lambda **look: nh.plot.phase_portrait(_short().system, _short(), **look),
    "point_track": lambda **look: nh.plot.point_track(_short(), **look),
    "section": lambda **look: nh.plot.section(_crossings(), speed, lambda states: states.heading, **look),
}


@pytest.fixture(autouse=True)
def _coarse(monkeypatch: pytest.MonkeyPatch) -> None:
    """Sections of a locus need not be smooth here."""
    monkeypatch.setattr(nonholo.plot.geometry._locus, "_GRID", 31)


def _axes(drawn: Any) -> Any:
    return drawn.axes if hasattr(drawn, "axes") else drawn.plane


def _titles(axes: Axes) -> set[str]:
    return {axes.get_title(place) for place in ("left", "center", "right")} - {""}


def _words(axes: Axes) -> list[str]:
    return [text.get_text() for text in axes.texts if text.get_visible() and text.get_text()]


def _contrast(color: Any, paper: Any) -> float:
    low, high = sorted(theme.luminance(one) for one in (color, paper))
    return (high + 0.05) / (low + 0.05)


def test_every_picture_takes_the_same_keywords() -> None:
    """All functions that draw take `Look`, refuse what it does not have, and have an entry in `PICTURES`."""
    functions = {name for name in nh.plot.__all__ if inspect.isfunction(getattr(nh.plot, name))}
    others = {"overview", "animate", "sweep_map", "comparison", "convergence", "curvature"}
    assert functions - others == set(PICTURES), "add the picture to PICTURES"
    for name in functions:
        assert "look" in inspect.signature(getattr(nh.plot, name)).parameters, name
    assert _titles(PICTURES["energy_error"](**dict.fromkeys(theme.Look.__annotations__)).axes) == {"Energy error"}
    with pytest.raises(TypeError, match=r"blade_track\(\) got an unexpected keyword argument 'tint'"):
        nh.plot.blade_track(_short(), tint="red")


@pytest.mark.parametrize("name", PICTURES)
def test_title_name_and_color(name: str) -> None:
    """The title is the caller's; the name stands in the legend, and its handle has the color."""
    axes = _axes(PICTURES[name](title="Mine", label="this one", color="#123456"))
    assert _titles(axes) == {"Mine"}
    owner = axes.figure.axes[1] if name == "branch_tree" else axes
    handles, labels = owner.get_legend_handles_labels()
    assert labels.count("this one") == 1
    assert "this one" in [text.get_text() for text in owner.get_legend().get_texts()]
    handle = handles[labels.index("this one")]
    color = handle.get_color() if hasattr(handle, "get_color") else handle.get_facecolor()
    assert np.allclose(
        to_rgba(np.reshape(color, -1)[:4] if not isinstance(color, str) else color)[:3], to_rgba("#123456")[:3]
    )


@pytest.mark.parametrize("name", PICTURES)
def test_without_legend_and_words(name: str) -> None:
    """No legend, no words inside the axes and no title, where none are wanted; names of axes stay."""
    axes = _axes(PICTURES[name](legend=False, annotate=False, title=""))
    assert axes.get_legend() is None
    assert not _words(axes)
    assert not _titles(axes)


@pytest.mark.profile("paper", keep=["branches", "blade_track", "momentum_sphere", "section"])
@pytest.mark.parametrize("name", PICTURES)
def test_dark_colors_are_legible(name: str) -> None:
    """On a dark background words have a contrast of 4.5 or more, in a style of matplotlib as by keyword."""
    with mpl.style.context("dark_background"):
        styled = PICTURES[name]()
    for drawn in (styled, PICTURES[name](dark=True)):
        axes = _axes(drawn)
        paper = axes.figure.get_facecolor()
        assert theme.luminance(paper) < 0.01
        for text in axes.findobj(lambda one: isinstance(one, Text) and one.get_visible() and one.get_text()):
            assert _contrast(text.get_color(), paper) >= 4.5, text
        for line in (line for line in axes.lines if len(line.get_xdata())):
            assert _contrast(line.get_color(), paper) >= 4.5, line


def test_dark_palette() -> None:
    """Every color that lines, dots and words can have on a dark background has a contrast of 4.5 or more."""
    colors: list[Any] = []

    @theme.in_style
    def collect(axes: Axes) -> None:
        theme.begin(axes)
        names = ("STABLE", "UNSTABLE", "DISCRETE", "CONTINUOUS", "LEVEL", "INK", "QUIET", "MUTED")
        colors.extend(getattr(theme, name) for name in names)
        colors.extend([*theme.COMPONENTS, *theme.TIME(np.linspace(0, 1, 20)), *theme.component_colors(20)])
        assert to_rgba("#101216")[:3] == theme.PAPER

    figure = Figure(facecolor="#101216")
    collect(figure.add_subplot(facecolor="none"))
    assert len(colors) == 54
    assert (theme.component_colours, theme.end_colours) == (theme.component_colors, theme.end_colors)  # former names
    assert min(_contrast(color, "#101216") for color in colors) >= 4.5
    assert theme.INK == "#222222"


@pytest.mark.profile("paper", keep=["False-center"])
@pytest.mark.parametrize("place", ["left", "center"])
@pytest.mark.parametrize("before", [True, False])
def test_a_title_of_the_caller_replaces_ours(place: str, before: bool, sleigh_orbit: nh.Orbit) -> None:
    """Whether it comes before or after, the title is the only one, and a legend beside it does not cover it."""
    axes = Figure(layout="constrained").add_subplot()
    words = "A title of my own, not short"
    if before:
        axes.set_title(words, loc=place)
    nh.plot.phase_portrait(sleigh_orbit.system, sleigh_orbit, axes=axes)
    axes.set_title(words, loc=place) if not before else None
    assert _titles(axes) == {words}
    axes.figure.draw_without_rendering()
    title = axes.title if place == "center" else axes._left_title
    assert not title.get_window_extent().overlaps(axes.get_legend().get_window_extent())
    nh.plot.phase_portrait(sleigh_orbit.system, sleigh_orbit, axes=axes)
    assert _titles(axes) == {words}


@pytest.mark.parametrize("draw", [nh.plot.blade_track, nh.plot.point_track, nh.plot.energy_error])
def test_several_orbits_in_one_axes(draw: Callable[..., Any]) -> None:
    """All of each orbit is within the limits, each has its name once, words are written once, nothing is enlarged."""
    axes = Figure().add_subplot()
    axes.plot([-9.0], [30.0], label="before")
    for number, start in enumerate([(0.1, -1.0, 0.0), (0.5, -2.0, 0.0), (0.3, 3.0, 0.0)]):
        draw(sleigh_run(start, steps=120), axes=axes, label=f"start {number}", color=f"C{number}")
    axes.plot([80.0], [-40.0], label="after")
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    for collection in axes.collections:
        points = collection.get_offsets()
        if collection.get_transform() is not axes.transData and len(points) and len(collection.get_paths()):
            assert (points.min(axis=0) >= [left, low]).all()
            assert (points.max(axis=0) <= [right, high]).all()
    assert left <= -9.0 <= 80.0 <= right
    assert low <= -40.0 <= 30.0 <= high
    labels = [text.get_text() for text in axes.get_legend().get_texts()]
    assert len(labels) == len(set(labels))
    assert {"start 0", "start 1", "start 2"} <= set(labels)
    assert len(_words(axes)) == len(set(_words(axes)))
    assert not axes.child_axes


def test_several_paths_in_space() -> None:
    """The box holds all paths."""
    axes = Figure().add_subplot(projection="3d")
    for turn in (0.0, 0.4):
        orbit = nh.simulate(_IN_SPACE, body_velocity=(0.3, 0.1, 1.0, 1.0, 0.0, 3 * turn), steps=20)
        nh.plot.point_track(orbit, axes=axes)
        nh.plot.point_track(orbit[:3], axes=axes)
        for side, values in zip("xyz", orbit.position.T, strict=True):
            low, high = getattr(axes, f"get_{side}lim")()
            assert low <= values.min() <= values.max() <= high
    assert _titles(axes) == {"Reference point"}


def test_a_path_in_space_fills_its_box() -> None:
    """A path along one direction is drawn in a flat box, whose sides have one scale."""
    axes = nh.plot.point_track(nh.simulate(_IN_SPACE, body_velocity=(0.3, 0, 0, 1.0, 0, 0), steps=40)).axes
    sides = np.array([np.ptp(getattr(axes, f"get_{side}lim")()) for side in "xyz"])
    assert sides[0] > 2.5 * sides[1]
    assert np.allclose(axes._box_aspect / axes._box_aspect[0], sides / sides[0])


def test_size_and_fonts(sleigh_orbit: nh.Orbit) -> None:
    """A new figure has the size of the keyword, of the settings, or its own; fonts grow with it or are the caller's."""
    own = nh.plot.energy_error(sleigh_orbit).axes
    large = nh.plot.energy_error(sleigh_orbit, size=(12.0, 5.2)).axes
    assert own.figure.get_size_inches().tolist() == [6.0, 2.6]
    assert large.figure.get_size_inches().tolist() == [12.0, 5.2]
    assert large.xaxis.label.get_size() == 2 * own.xaxis.label.get_size()
    with mpl.rc_context({"figure.figsize": (16, 9), "font.size": 15}):
        figure = nh.plot.overview(sleigh_orbit, title="")
        assert figure.get_size_inches().tolist() == [16.0, 9.0]
        assert figure.axes[0].xaxis.label.get_size() == 15.0
    axes = Figure(figsize=(3, 3)).add_subplot()
    assert nh.plot.energy_error(sleigh_orbit, axes=axes, size=(12.0, 5.2)).axes.figure.get_size_inches()[0] == 3.0


def _on_a_spring() -> CoordinateOrbit:
    spring = LagrangeDAlembert(lambda q, v: (v @ v - q @ q) / 2, None, dimension=2, coordinates=("x", "y"))
    return nh.simulate(nh.discretize(spring, 0.1), configuration=(1, 0), body_velocity=(0, 1), steps=40)


@pytest.mark.profile("paper", keep=["group"])
@pytest.mark.parametrize(
    ("run", "titles"),
    [
        (_short, ["Track of the blade", "Phase portrait", "Heading and speed", "Energy error"]),
        (_on_a_spring, ["Path", "Coordinates", "Velocity", "Energy error"]),
    ],
    ids=["group", "coordinates"],
)
def test_the_overview_obeys(run: Callable[[], Any], titles: list[str]) -> None:
    """The title replaces the name of the system, panels keep theirs; words and legends go, colors are the caller's."""
    orbit = run()
    figure = nh.plot.overview(orbit, title="Mine", legend=False, annotate=False, color="C3", dark=True)
    assert [text.get_text() for text in figure.texts] == ["Mine"]
    assert [_titles(axes).pop() for axes in figure.axes if _titles(axes)] == titles
    named = nh.plot.overview(orbit, label="this one").axes[0].get_legend().get_texts()
    assert "this one" in [text.get_text() for text in named]
    assert not any(_words(axes) or axes.get_legend() for axes in figure.axes)
    assert np.allclose(figure.axes[0].collections[0].get_facecolor(), to_rgba("C3"))
    assert theme.luminance(figure.get_facecolor()) < 0.01


def test_pages_of_comparisons_obey() -> None:
    """The title is that of the page, panels keep theirs; words and legends go, colors and background are asked for."""
    sleigh, start = nh.ChaplyginSleigh(1.0, 1.0, 0.5, 0.3), {"body_velocity": (0.5, -2.0, 0.0)}
    orbits = [nh.simulate(nh.discretize(sleigh, 4 / steps), **start, steps=steps) for steps in (100, 200)]
    flow = nh.flow(sleigh, **start, times=(0.0, 4.0))
    one, order = nh.compare(orbits[0], flow), nh.compare(orbits, flow)
    figure = nh.plot.comparison(one, title="Mine", label="this one", color="C3", dark=True, size=(5, 6))
    assert figure.texts[0].get_text() == "Mine"
    assert [_titles(axes).pop() for axes in figure.axes] == ["Pose", "Momentum along admissible directions", "Energy"]
    assert all(to_rgba(axes.lines[0].get_color()) == to_rgba("C3") for axes in figure.axes)
    assert all(axes.get_legend().get_texts()[0].get_text() == "this one" for axes in figure.axes)
    assert theme.luminance(figure.get_facecolor()) < 0.01
    assert figure.get_size_inches().tolist() == [5.0, 6.0]
    named = nh.plot.convergence(order, label="this one").axes[0].get_legend().get_texts()
    assert named[0].get_text() == "this one pose: order 2.00"
    for figure in (nh.plot.comparison(one, **_NOTHING), nh.plot.convergence(order, **_NOTHING)):
        assert not any(_words(axes) or axes.get_legend() for axes in figure.axes)
        assert [text.get_text() for text in figure.texts] == [""]


def test_text_stays_text_in_svg(sleigh_orbit: nh.Orbit, tmp_path: Path) -> None:
    """All words of a picture are text elements of the file, those with a halo too, which other formats keep."""
    axes = nh.plot.blade_track(sleigh_orbit).axes
    axes.figure.savefig(tmp_path / "a.svg")
    written = (tmp_path / "a.svg").read_text()
    for word in ("Track of the blade", "start", "end", "cusp", "discrete orbit"):
        assert f">{word}</text>" in written
    assert all(text.get_path_effects() for text in axes.texts)


def test_axes_have_names() -> None:
    """Sections have the names of their functions; panels of components say what they are."""
    axes = PICTURES["section"]().axes
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("speed", "up")
    figure = nh.plot.overview(run_of(_IN_SPACE.system, steps=5))
    assert [axes.get_ylabel() for axes in figure.axes[1:3]] == ["momentum", "velocity"]


# What is no title, flag, size or color is refused before anything is drawn.
test_looks_are_refused = refusals(
    ({"title": 3}, r"title=...\)` must be a text"),
    ({"legend": "no"}, r"legend=...\)`"),
    ({"size": (0, 3)}, r"size=...\)` must be positive. Got 0"),
    ({"color": "no color"}, r"color=...\)` must be a color of matplotlib. Got 'no color'"),
    ask=lambda look: nh.plot.energy_error(_short(), **look),
    begin=r"`energy_error\(",
)

_HEAVIER = nh.ChaplyginSleigh(2.0, 1.0, 0.5, 0.3)
_LOST = sleigh_run((0.1, -1.0, 0.0), steps=3, reconstruct=False)
# What a picture cannot show, and where it cannot be written, is refused in words.
test_other_subjects_are_refused = refusals(
    (lambda: nh.plot.energy_error(_short()[:0]), "must have a state to draw. Got none. `orbit.outcome` has"),
    (lambda: nh.plot.overview(_short(), "picture.zarr"), r"`overview\(path=...\)` must end in a picture format"),
    (lambda: nh.plot.phase_portrait(_HEAVIER, _short()), r"`phase_portrait\(orbit=...\)` must be an orbit of the"),
    (lambda: nh.plot.phase_portrait(_short()), "must be a system on a group. .* Pass `orbit.system` first"),
    (lambda: nh.plot.phase_portrait(_TOP.system, energies=[1.0, -1.0]), r"energies=...\)` must be positive. Got -1"),
    (lambda: nh.plot.animate(_short(), "a.avi"), r"`animate\(path=...\)` must end in .gif, .mp4 or .webm"),
    (lambda: nh.plot.animate(_short(), "a.gif", frames=0), r"`animate\(frames=...\)` must be a positive .* Got 0"),
    (lambda: nh.plot.animate(_LOST, "a.gif"), "must have poses"),
)
