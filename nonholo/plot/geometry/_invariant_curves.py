"""The variety of displacements, foliated by its energy levels: a projective plane for a top, a Moebius band else."""

import dataclasses
from typing import Any, Unpack, cast

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PathCollection

from nonholo.analysis import invariant_curve
from nonholo.analysis.planar import planar_map
from nonholo.base.checks import energies as checked_energies
from nonholo.discrete import Discretization
from nonholo.orbit import Orbit
from nonholo.plot import theme
from nonholo.plot.parts import draw_equilibria, draw_orbit, own_orbit
from nonholo.plot.sheets import AbstractSheet, sheet_of
from nonholo.systems import AbstractLLSystem

_POINTS = 300


@dataclasses.dataclass(frozen=True)
class InvariantCurvesPicture:
    """The artists of `invariant_curves`; None where there was nothing to draw.

    Attributes:
        axes: The axes.
        levels: The curves, for each energy.
        own: The curve of the orbit's energy.
        stable: Attracting equilibria on the curves, filled.
        unstable: Repelling equilibria, empty.
        orbit: The displacements of the orbit, colored by time.
    """

    axes: Axes
    levels: tuple[LineCollection, ...]
    own: LineCollection | None
    stable: PathCollection | None
    unstable: PathCollection | None
    orbit: PathCollection | None


@theme.styled
def invariant_curves(
    discrete: Discretization,
    orbit: Orbit | None = None,
    axes: Axes | None = None,
    energies: Any = None,
    **look: Unpack[theme.Look],
) -> InvariantCurvesPicture:
    r"""Draw the displacements, foliated by energy, with the equilibria and an orbit on its curve.

    For a top the variety is a disc: the radius is the step angle, the direction is u of the plane of rotation
    $u\wedge e_3$; opposite points of the rim, half-turns, are the same displacement and bear the same letter. For a
    sleigh it is the strip of the step angle $\Delta$ and the translation $\nu$ along the chord; its left edge is its
    right edge upside down. An orbit jumps along its curve, from the repelling to the attracting equilibrium.

    Args:
        discrete: A top with n = 3 or a sleigh, discretized with "matrix" and "skew".
        orbit: An orbit of it.
        axes: Where to draw; a new figure by default.
        energies: Energies of the curves; by default nine.
        **look: Title, label, color and more: `nh.plot.Look`.

    Raises:
        ValueError: Another system or discretization, an orbit of another one, energies that are not positive.

    Example:
        >>> sleigh = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.5)
        >>> picture = nh.plot.invariant_curves(sleigh, energies=[1.0, 2.0])
        >>> len(picture.levels), len(picture.stable.get_offsets())
        (2, 2)
    """
    where = "plot.invariant_curves"
    checked = planar_map(f"{where}(discrete=...)", discrete)[0]
    sheet = cast(AbstractSheet, sheet_of(checked.system))
    own_orbit(f"{where}(orbit=...)", orbit, checked)
    axes = theme.axes_or_new(axes, (6.2, 6.0))
    asked = sheet.energies(float(checked.time_step)) if energies is None else energies
    curves = [invariant_curve(checked, energy, _POINTS) for energy in checked_energies(f"{where}(energies=...)", asked)]
    levels = tuple(sheet.draw_level(axes, curve, color=theme.LEVEL, linewidth=1.1, zorder=1) for curve in curves)
    own = path = None
    if orbit is not None:
        curves = [invariant_curve(checked, orbit[:1].energy[0], _POINTS)] if orbit.energy[0] > 0 else []
        for curve in curves:
            own = sheet.draw_level(axes, curve, color=theme.DISCRETE, linewidth=1.8, zorder=3, label="its energy")
        path = draw_orbit(axes, orbit, sheet.places(sheet.variety.points(orbit.displacement)))
    stable = unstable = None
    if cast(AbstractLLSystem, checked.system).equilibria().attracting is not None:
        stable, unstable = draw_equilibria(axes, *sheet.attracting(curves), 40 if len(curves) == 1 else 22)
    theme.write_title(axes, "Displacements")
    sheet.dress(axes, curves, np.empty((0, 2)))
    return InvariantCurvesPicture(axes, levels, own, stable, unstable, path)
