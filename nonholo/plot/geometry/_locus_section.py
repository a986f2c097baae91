"""A plane section of the momentum locus."""

import dataclasses
from typing import Any, Unpack, cast

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PathCollection
from matplotlib.contour import QuadContourSet

from nonholo.analysis import MomentumLocus
from nonholo.base.checks import array, error, instance
from nonholo.base.types import Array, Float
from nonholo.plot import theme
from nonholo.plot.sheets import AbstractSheet, sheet_of

_GRID = 501
_WHISKER = 3.0  # how far whiskers are followed, in lengths of their segments
_MARGIN = 0.06


@dataclasses.dataclass(frozen=True)
class LocusSection:
    """The artists of `locus_section`; None where there was nothing to draw.

    Attributes:
        axes: The axes.
        curve: The section, where the polynomial of the locus vanishes.
        plane: Two orthonormal rows: the directions across and up.
        crossings: Points where the section crosses itself: of the double segments.
        isolated: Points where the polynomial vanishes alone: of the whiskers.
    """

    axes: Axes
    curve: QuadContourSet
    plane: Float[np.ndarray, "2 3"]
    crossings: PathCollection | None
    isolated: PathCollection | None


@theme.styled
def locus_section(
    locus: MomentumLocus,
    normal: Array = (0.0, 0.0, 1.0),
    offset: Array = 0.0,
    axes: Axes | None = None,
    **look: Unpack[theme.Look],
) -> LocusSection:
    r"""Draw the section of the momentum locus by the plane $n\cdot P = $ `offset`, n the unit vector along `normal`.

    A double segment that meets the plane gives a crossing, a whisker an isolated point, which belongs to the zeros of
    the polynomial but not to the locus.

    Args:
        locus: What `nh.momentum_locus` returned.
        normal: Three components of the body momentum, not all zero.
        offset: The component of the momentum along the normal.
        axes: Where to draw; a new figure by default.
        **look: Title, label, color and more: `nh.plot.Look`.

    Raises:
        ValueError: No locus, a normal that is zero, an offset that is no number.

    Example:
        >>> top = nh.discretize(nh.SuslovTop(np.diag([1.0, 2.0, 3.0])), 0.5)
        >>> section = nh.plot.locus_section(nh.momentum_locus(top), normal=(0, 0, 1), offset=0.5)
        >>> len(section.crossings.get_offsets())
        1
    """
    where = "plot.locus_section"
    instance(f"{where}(locus=...)", locus, MomentumLocus, "be a locus", "Pass what `nh.momentum_locus` returned.")
    n = array(f"{where}(normal=...)", normal, (3,), "Pass three components.")
    if not np.any(n):
        raise error(f"{where}(normal=...)", "not be zero", "0, 0, 0", "Pass a direction.")
    n = n / np.linalg.norm(n)
    height = float(array(f"{where}(offset=...)", offset, (), "Pass one number."))
    plane = _directions(n)
    axes = theme.axes_or_new(axes, (6.0, 5.6))
    curve = _curve(axes, locus, plane, height * n)
    crossings = _meeting(axes, locus.double_lines, plane, n, height, color=theme.UNSTABLE, label="crosses itself")
    outside = locus.whiskers(_WHISKER)
    empty: Any = {"facecolors": theme.PAPER, "edgecolors": theme.UNSTABLE, "linewidths": 1.5}
    isolated = _meeting(axes, outside, plane, n, height, label="equation alone", **empty)
    _dress(axes, locus, plane, n, height)
    return LocusSection(axes, curve, plane, crossings, isolated)


def _directions(n: Float[np.ndarray, "3"]) -> Float[np.ndarray, "2 3"]:
    """Return the coordinate direction least along the normal, made orthogonal, and the one that completes the frame."""
    first = np.eye(3)[np.argmin(np.abs(n))]
    first = first - (first @ n) * n
    first /= np.linalg.norm(first)
    return np.stack([first, np.cross(n, first)])


def _curve(axes: Axes, locus: MomentumLocus, plane: np.ndarray, foot: np.ndarray) -> QuadContourSet:
    flat = locus.momentum.reshape(-1, 3) @ plane.T
    low, high = flat.min(axis=0), flat.max(axis=0)
    room = _MARGIN * (high - low)
    across, up = (np.linspace(*ends, _GRID) for ends in zip(low - room, high + room, strict=True))
    x, y = np.meshgrid(across, up)
    own = theme.named(theme.DISCRETE)
    axes.plot([], [], **own)
    values = locus.implicit(foot + np.stack([x, y], axis=-1) @ plane)
    return axes.contour(x, y, values, levels=[0.0], colors=[own["color"]], linewidths=1.8, zorder=2)


def _meeting(
    axes: Axes, segments: Float[np.ndarray, "L 2 3"], plane: np.ndarray, n: np.ndarray, height: float, **look: Any
) -> PathCollection | None:
    """Mark the points where segments meet the plane."""
    first, last = segments[:, 0] @ n - height, segments[:, 1] @ n - height
    meets = first * last < 0
    if not np.any(meets):
        return None
    part = (first / np.where(meets, first - last, 1.0))[meets, None]
    points = segments[meets, 0] + part * (segments[meets, 1] - segments[meets, 0])
    return axes.scatter(*(points @ plane.T).T, s=40, zorder=4, **look)


def _dress(axes: Axes, locus: MomentumLocus, plane: np.ndarray, n: np.ndarray, height: float) -> None:
    names = cast(AbstractSheet, sheet_of(locus.discrete.system)).component_names
    across, up, normal = (_words(row, names) for row in (*plane, n))
    axes.set(xlabel=across, ylabel=up)
    theme.write_title(axes, f"Section  {normal} = {height:g}")
    axes.set_aspect("equal", adjustable="datalim")
    theme.legend_above(axes)


def _words(row: Float[np.ndarray, "3"], names: tuple[str, ...]) -> str:
    """Return a linear combination of the momentum's components in words."""
    terms = []
    for x, name in zip(row, names, strict=True):
        if abs(x) > 1e-12:
            size = "" if abs(abs(x) - 1) < 1e-12 else f"{abs(x):.2g}\\,"
            terms.append(f"{'-' if x < 0 else '+'} {size}{name}")
    text = " ".join(terms)
    return f"${text.removeprefix('+ ')}$"
