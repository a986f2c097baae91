"""The look of every picture: one palette, one style sheet, new axes, and what callers ask of it. Nothing is drawn here.

Colors are from the palette of Okabe and Ito, legible to color-blind readers, and lighter ones of the same hues where
the background is dark; the sheet is applied while drawing. `theme.INK` and the other colors are those of the picture
that is being drawn.
"""

import contextvars
import dataclasses
import functools
import inspect
import io
import re
import weakref
from collections.abc import Callable
from pathlib import Path
from typing import Any, ParamSpec, TypedDict, TypeVar

import matplotlib
import matplotlib.patheffects
import matplotlib.style
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import ListedColormap, Normalize, is_color_like, to_rgb, to_rgba
from matplotlib.figure import Figure
from matplotlib.text import Text

from nonholo.base.checks import error, flag, instance, pair, positive, shown, text
from nonholo.base.progress import setting
from nonholo.base.types import Float
from nonholo.orbit import AbstractOrbit, Orbit


def _shades(first: float, last: float) -> ListedColormap:
    return ListedColormap(matplotlib.colormaps["viridis"](np.linspace(first, last, 256)), name="nonholo_time")


_COLORS: dict[str, tuple[Any, Any]] = {  # on a light and on a dark background
    "STABLE": ("#1a1a1a", "#f2f2f2"),
    "UNSTABLE": ("#d55e00", "#ff8c42"),
    "DISCRETE": ("#0072b2", "#56b4e9"),
    "CONTINUOUS": ("#e69f00", "#e69f00"),
    "COMPONENTS": (
        ("#0072b2", "#cc79a7", "#009e73", "#d55e00", "#56b4e9", "#1a1a1a"),
        ("#56b4e9", "#e0a3c7", "#2fc496", "#ff8c42", "#f0e442", "#f2f2f2"),
    ),
    "LEVEL": ("#c3c8d0", "#7d8590"),
    "INK": ("#222222", "#ececec"),
    "QUIET": ("#555a62", "#b4bac4"),
    "MUTED": ("#8a8f98", "#9aa0aa"),
    "INSIDE": ("#dbe9f3", "#1d3447"),
    "TIME": (_shades(0.0, 0.93), _shades(0.5, 1.0)),
}
_COMMANDS, _SIGNS = re.compile(r"\\[A-Za-z]+"), re.compile(r"[${}_^]")  # of formulas
_PAPERS = "white", "#101216"  # of new figures
_DARK = 0.18  # luminance from which black is easier to read than white
_SETTLED = 0.01  # part of the largest momentum
_NARROW = 3.7  # inches, at the usual size of fonts
_RAISED = 24.0  # of a title above a legend, in points
_SMALLEST = 0.8  # of the usual size of fonts
_SETTINGS: Any = matplotlib.rcParams
_USUAL: Any = matplotlib.rcParamsDefault
_SHEET = Path(__file__).with_name("nonholo.mplstyle")
_P = ParamSpec("_P")
_R = TypeVar("_R")


class Look(TypedDict, total=False):
    """The keywords of every picture beside its own arguments; None means that one is left out.

    Attributes:
        title: Instead of the picture's own title; "" for none. A title that the axes have, or get later, also takes
            the place of the picture's own.
        label: Name in the legend of the orbit; of the principal value, the section or the counts where it is these
            that are drawn.
        color: The color of the same, any of matplotlib's; orbits have the colors of time by default.
        legend: Whether there is a legend.
        annotate: Whether there are words inside the axes.
        size: Width and height of a new figure in inches, with which its fonts grow. By default from the settings of
            matplotlib, where they have one, else one that suits the picture.
        dark: Whether colors are for a dark background; by default as the axes are, or the settings of matplotlib.
    """

    title: str | None
    label: str | None
    color: Any
    legend: bool | None
    annotate: bool | None
    size: tuple[float, float] | None
    dark: bool | None


@dataclasses.dataclass
class _Drawing:
    """A picture that is being drawn: what its caller asks for, its background, the words that its axes had before."""

    look: Look
    is_dark: bool = False
    paper: Any = _PAPERS[0]
    words: dict[Axes, list[Any]] = dataclasses.field(default_factory=dict)


_NOTHING = _Drawing(Look())
_DRAWING: contextvars.ContextVar[_Drawing] = contextvars.ContextVar("drawing", default=_NOTHING)
_TITLES: weakref.WeakKeyDictionary[Axes, str] = weakref.WeakKeyDictionary()  # that are not the caller's
_ASKED: weakref.WeakSet[Axes] = weakref.WeakSet()  # whose title was asked for, which later pictures keep
_LEGENDS: weakref.WeakSet[Any] = weakref.WeakSet()  # above axes


def __getattr__(name: str) -> Any:
    """Return a color for the background of the picture that is being drawn."""
    drawing = _DRAWING.get()
    if name == "PAPER":
        return drawing.paper
    if name == "HALO":
        return (matplotlib.patheffects.withStroke(linewidth=3, foreground=drawing.paper),)
    if name not in _COLORS:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return _COLORS[name][drawing.is_dark]


def is_dark() -> bool:
    """Return whether the background is dark."""
    return _DRAWING.get().is_dark


def option(name: str, otherwise: Any) -> Any:
    """Return what the caller asks for under a name of `Look`, or something else."""
    return _DRAWING.get().look.get(name, otherwise)


def own_look(color: Any, label: str | None = None) -> dict[str, Any]:
    """Return the color and the name of what the caller may color and name, else these."""
    return {"color": option("color", color), "label": option("label", label)}


def in_style(draw: Callable[_P, _R]) -> Callable[_P, _R]:
    """Run a drawing function under the style sheet and the keywords of `Look`, and restore all settings afterwards.

    Where pictures are parts of another one, they inherit its options, but for title and size.
    """
    own = inspect.signature(draw).parameters
    names = Look.__annotations__ if "look" in own else {}

    @functools.wraps(draw)
    def under_sheet(*arguments: _P.args, **keywords: _P.kwargs) -> _R:
        unknown = [name for name in keywords if name not in own and name not in Look.__annotations__]
        if names and unknown:
            raise TypeError(f"{draw.__name__}() got an unexpected keyword argument {unknown[0]!r}")
        outer = {name: value for name, value in _DRAWING.get().look.items() if name not in ("title", "size")}
        choices: Any = {name: keywords.pop(name) for name in names if name in keywords}
        look = _valid_look(draw.__name__, {name: value for name, value in choices.items() if value is not None})
        drawing = _Drawing(Look(**{**outer, **look}))
        with matplotlib.style.context(_SHEET), setting(_DRAWING, drawing):
            _settle(_SETTINGS["axes.facecolor"])
            _set_fonts(_scale())
            result = draw(*arguments, **keywords)
            _choose_words(drawing)
            return result

    return under_sheet


def _valid_look(owner: str, look: dict[str, Any]) -> dict[str, Any]:
    checks = dict.fromkeys(("title", "label"), text) | dict.fromkeys(("legend", "annotate", "dark"), flag)
    for name in checks.keys() & look.keys():
        checks[name](f"{owner}({name}=...)", look[name])
    if "size" in look:
        where, remedy = f"{owner}(size=...)", "Pass width and height in inches."
        look["size"] = tuple(float(positive(where, side, remedy)) for side in pair(where, look["size"]))
    if "color" in look:
        if not is_color_like(look["color"]):
            remedy = 'Pass a name as "C1", or "#56b4e9".'
            raise error(f"{owner}(color=...)", "be a color of matplotlib", shown(look["color"]), remedy)
        look["color"] = to_rgba(look["color"])
    return look


def luminance(color: Any) -> float:
    """Return the relative luminance of a color, 0 for black and 1 for white (WCAG 2)."""
    light = np.asarray(to_rgb(color))
    linear = np.where(light <= 0.04045, light / 12.92, ((light + 0.055) / 1.055) ** 2.4)
    return float(linear @ [0.2126, 0.7152, 0.0722])


def _settle(paper: Any) -> None:
    """Choose the colors for a background; one that is not dark or light enough is replaced."""
    drawing = _DRAWING.get()
    is_dark_paper = luminance(paper) < _DARK
    drawing.is_dark = option("dark", is_dark_paper)
    drawing.paper = paper if is_dark_paper == drawing.is_dark else _PAPERS[drawing.is_dark]
    ink, gray = (_COLORS[name][drawing.is_dark] for name in ("INK", "MUTED"))
    settings = dict.fromkeys(("figure.facecolor", "axes.facecolor"), drawing.paper) if paper != drawing.paper else {}
    settings |= dict.fromkeys(("text.color", "axes.labelcolor", "xtick.labelcolor", "ytick.labelcolor"), ink)
    settings |= dict.fromkeys(("axes.edgecolor", "xtick.color", "ytick.color"), gray)
    _SETTINGS.update(settings)


def _set_fonts(scale: float) -> None:
    """Set the sizes of fonts, in units of the usual one."""
    sizes = {"font.size": 10, "axes.titlesize": 11, "legend.fontsize": 9, "xtick.labelsize": 9, "ytick.labelsize": 9}
    _SETTINGS.update({name: scale * points for name, points in sizes.items()})


def _scale() -> float:
    return _SETTINGS["font.size"] / _USUAL["font.size"]


class _Picture(Figure):
    """A figure whose text stays text in files; in SVG, where a halo would make it curves, without one."""

    def _repr_png_(self) -> bytes:
        """Return the picture that a notebook shows."""
        self.savefig(file := io.BytesIO(), format="png")
        return file.getvalue()

    def savefig(self, fname: Any, **options: Any) -> None:
        is_svg = "svg" in (options.get("format"), Path(str(fname)).suffix[1:].lower())
        words = [(word, word.get_path_effects()) for word in (self.findobj(Text) if is_svg else ())]
        try:
            for word, _ in words:
                word.set_path_effects([])
            with matplotlib.rc_context({"svg.fonttype": "none", "pdf.fonttype": 42}):
                Figure.savefig(self, fname, **options)
        finally:
            for word, halo in words:
                word.set_path_effects(halo)


def new_figure(size: tuple[float, float], layout: Any = "constrained") -> Figure:
    """Return a figure that no window manager knows, of the given size; fonts grow with it."""
    own = tuple(_SETTINGS["figure.figsize"])
    inches = option("size", size if own == tuple(_USUAL["figure.figsize"]) else own)
    if _SETTINGS["font.size"] == _USUAL["font.size"]:
        _set_fonts(max(_SMALLEST, min(inches[0] / size[0], inches[1] / size[1])))
    return _Picture(figsize=inches, layout=layout)


def axes_or_new(axes: Axes | None, size: tuple[float, float] = (6.0, 5.0), projection: str | None = None) -> Axes:
    """Return the given axes, or those of a new figure that no window manager knows."""
    if axes is None:
        axes = new_figure(size).add_subplot(projection=projection)
    instance("plot(axes=...)", axes, Axes, "be axes of matplotlib", "Pass axes, or None.")
    begin(axes)
    return axes


def begin(axes: Axes) -> None:
    """Take note of axes that are drawn on: of their background, and of the words that they have."""
    figure: Any = axes.get_figure(root=False)
    front, back = to_rgba(axes.get_facecolor()), to_rgb(figure.get_facecolor())
    paper = tuple(front[3] * over + (1 - front[3]) * under for over, under in zip(front, back, strict=False))
    _settle(paper)
    _DRAWING.get().words[axes] = list(axes.texts)


def _choose_words(drawing: _Drawing) -> None:
    """Hide new words inside axes if none are wanted, and those that the axes have already, there or elsewhere."""
    for axes, before in drawing.words.items():
        texts = {old.get_text() for old in before}
        places = {old.get_position() for old in before if old.get_transform() is axes.transAxes}
        for new in axes.texts[len(before) :]:
            hides = new.get_transform() is axes.transAxes and new.get_position() in places
            if new.get_text() and (hides or new.get_text() in texts or not drawing.look.get("annotate", True)):
                new.set_visible(False)


def write_title(axes: Axes, words: str, **look: Any) -> None:
    """Write the title of a picture at the left, unless the caller has one; one that comes later replaces it."""
    own = option("title", None)
    others = (axes.get_title(place) not in ("", _TITLES.get(axes)) for place in ("left", "center", "right"))
    if own is None and (axes in _ASKED or any(others)):
        return
    if axes not in _TITLES:
        reference = weakref.ref(axes)
        axes.title.add_callback(lambda _: _withdraw(reference()))
    if own is not None:
        _ASKED.add(axes)
        axes.set_title("", loc="center")
    _TITLES[axes] = words if own is None else own
    axes.set_title(_TITLES[axes], loc="left", **look)


def _withdraw(axes: Axes | None) -> None:
    """Take the picture's title away when there is one of the caller's in the middle."""
    if axes is None or not axes.get_title() or _TITLES.pop(axes, None) != axes.get_title("left"):
        return
    axes.set_title("", loc="left")
    if axes.get_legend() in _LEGENDS:
        with matplotlib.style.context(_SHEET):
            legend_above(axes)


def time_scale(orbit: AbstractOrbit) -> Normalize:
    """Return the map from times of an orbit to the colors of `TIME`.

    The colors are spent on the transition and as long again, so that they do not fade in the uniform motion of a long
    run; earlier and later times have the colors of the ends.
    """
    first, last = float(orbit.time.min()), float(orbit.time.max())
    momentum = orbit.reduced_momentum if isinstance(orbit, Orbit) else orbit.body_velocity
    near = _SETTLED * np.abs(momentum).max(initial=0.0)
    left = np.flatnonzero(np.abs(momentum - momentum[0]).max(axis=1, initial=0.0) > near)
    moving = np.flatnonzero(np.abs(momentum - momentum[-1]).max(axis=1, initial=0.0) > near)
    if len(left) and len(moving) and left[0] <= moving[-1]:
        begin, end = sorted((float(orbit.time[left[0]]), float(orbit.time[moving[-1]])))
        half = (end - begin) / 2
        first, last = max(first, begin - half), min(last, end + half)
    return Normalize(first, last if last > first else first + 1.0, clip=True)


def time_colors(orbit: AbstractOrbit, time: Float[np.ndarray, "K"]) -> Float[np.ndarray, "K 4"]:
    """Return the colors of an orbit at these times: of time, or the given one."""
    shades = __getattr__("TIME")(time_scale(orbit)(time))
    return np.broadcast_to(to_rgba(option("color", None)), shades.shape).copy() if option("color", None) else shades


def component_colors(count: int) -> list[Any]:
    """Return colors for this many lines: the palette, or shades from one end to the other if they are too many."""
    if count <= len(colors := __getattr__("COMPONENTS")):
        return list(colors[:count])
    ends = (0.55, 1.0) if is_dark() else (0.0, 0.88)
    return [tuple(shade) for shade in matplotlib.colormaps["plasma"](np.linspace(*ends, count))]


def end_colors(orbit: AbstractOrbit) -> list[tuple[float, float, float, float]]:
    """Return the colors of the first and the last state."""
    return list(map(tuple, time_colors(orbit, orbit.time[[0, -1]])))


component_colours, end_colours = component_colors, end_colors  # names they had, which still work


def color_key(axes: Axes, mappable: Any, name: str, **look: Any) -> Any:
    """Put the key to the colors beside the axes."""
    figure: Any = axes.get_figure(root=False)
    bar = figure.colorbar(mappable, ax=axes, label=name, pad=0.02, **look)
    bar.outline.set_visible(False)
    return bar


def mark_time(axes: Axes, orbit: AbstractOrbit) -> None:
    """Lay the colors of time along the bottom of axes whose abscissa is time: the key to the other panels."""
    if len(orbit) < 2 or option("color", None):
        return
    times = time_scale(orbit).inverse(np.linspace(0.0, 1.0, 129))
    ends = np.unique(np.concatenate([orbit.time[[0, -1]], times]))
    ground = np.stack([ends, np.zeros_like(ends)], axis=-1)
    look: Any = {"linewidth": 4, "capstyle": "butt", "clip_on": False, "zorder": 5}
    strip = LineCollection(pieces(ground), transform=axes.get_xaxis_transform())
    strip.set(colors=time_colors(orbit, (ends[:-1] + ends[1:]) / 2), **look)
    axes.add_collection(strip, autolim=False)


def pieces(points: Float[np.ndarray, "K 2"]) -> list[Float[np.ndarray, "2 2"]]:
    """Return the pieces of a polygon, from each point to the next, for a `LineCollection`."""
    return list(np.stack([points[:-1], points[1:]], axis=1))


def dot_size(states: int) -> float:
    """Return the area of the dots of a discrete orbit: the fewer, the larger."""
    return 20.0 if states <= 100 else 10.0


def is_narrow(axes: Axes) -> bool:
    """Return whether axes are too narrow for a title and a legend in one line."""
    box = axes.get_window_extent()
    is_square = axes.get_aspect() == 1.0 and axes.get_adjustable() == "box"
    side = min(box.width, box.height) if is_square else box.width
    return side < _NARROW * axes.figure.dpi * _scale()


def legend_above(axes: Axes, title: str | None = None) -> None:
    """Write a title, if there is one, and a one-line legend at its right above the axes; inside narrow axes instead.

    Where both do not fit into one line the title moves up; of one that is the caller's the legend keeps clear inside.
    """
    if title is not None:
        write_title(axes, title)
    labels = list(dict.fromkeys(axes.get_legend_handles_labels()[1]))
    if not labels or not option("legend", True):
        return
    ours = axes.get_title(loc="left") + axes.get_title()
    fits = _fits(axes, labels)
    if is_narrow(axes) or (not fits and _TITLES.get(axes) != ours):
        legend(axes, loc="best", fontsize="small", frameon=True, framealpha=0.8, edgecolor="none")
    else:
        close = {"handlelength": 0.8, "columnspacing": 0.7} if len(labels) > 3 else {}
        if not fits:
            axes.set_title(ours, loc="left", pad=_RAISED)
        legend(axes, loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=len(labels), **close)
    _LEGENDS.add(axes.get_legend())


def _fits(axes: Axes, labels: list[str]) -> bool:
    """Return whether a title, at the left or in the middle, and a legend in one line do not meet."""
    left, middle = axes.get_title(loc="left"), axes.get_title()
    width = axes.get_window_extent().width / axes.figure.dpi / _scale()
    plain = (_SIGNS.sub("", _COMMANDS.sub("x", label)) for label in labels)
    beside = (2 if middle else 1) * sum(0.067 * len(label) + 0.3 for label in plain)
    return not left + middle or 0.085 * len(left + middle) <= width - beside


def legend(axes: Axes, **look: Any) -> None:
    """Write the legend, if one is wanted: each name once, where several pictures share the axes."""
    handles = {}
    for handle, label in zip(*axes.get_legend_handles_labels(), strict=True):
        handles.setdefault(label, handle)
    if handles and option("legend", True):
        axes.legend(list(handles.values()), list(handles), **look)
