"""The one place that chooses between a disc and a strip, and the plane of momenta along two directions.

Coordinates of tops and sleighs are those of their normal form, of others those of the canonical frame. What is drawn
on that plane is not decided here.
"""

from typing import Any, cast

import numpy as np
from matplotlib.axes import Axes

from nonholo.analysis.planar import planar_variety
from nonholo.base.types import Float
from nonholo.orbit import Orbit
from nonholo.plotting.sheets._base import AbstractSheet
from nonholo.plotting.sheets._blade import Blade
from nonholo.plotting.sheets._disc import DiscSheet
from nonholo.plotting.sheets._strip import StripSheet
from nonholo.systems import AbstractSystem


def sheet_of(system: AbstractSystem) -> AbstractSheet | None:
    """Return the sheet of a top in space or a sleigh in the plane, whatever its class; None for other systems."""
    variety = planar_variety(system)
    if variety is None:
        return None
    return (StripSheet if variety.form.is_sleigh else DiscSheet)(variety)


def blade_of_system(system: AbstractSystem) -> Blade | None:
    """Return the blade of a sleigh in the plane, whatever acts on it; None for other systems."""
    sheet = sheet_of(cast(Any, system).system if system.is_forced else system)
    return None if sheet is None else sheet.blade


def on_plane(system: AbstractSystem, restricted: Float[np.ndarray, "... k"]) -> Float[np.ndarray, "... k"]:
    """Return momenta along the rows of the constraint subspace in the coordinates of the plane."""
    return _turned(system, system.to_canonical(restricted))


def momenta_on_plane(orbit: Orbit) -> Float[np.ndarray, "K k"]:
    """Return the momenta of an orbit in the coordinates of the plane."""
    return _turned(orbit.system, orbit.reduced_momentum)


def _turned(system: AbstractSystem, canonical: Float[np.ndarray, "... k"]) -> Float[np.ndarray, "... k"]:
    sheet = sheet_of(system)
    return canonical if sheet is None else canonical @ sheet.to_plane.T


def plane_inertia(system: AbstractSystem) -> Float[np.ndarray, "2 2"]:
    """Return the inertia in the coordinates of the plane."""
    sheet = sheet_of(system)
    return np.asarray(system.canonical.constrained_inertia) if sheet is None else sheet.inertia


def half_axes(system: AbstractSystem) -> Float[np.ndarray, "2 2"]:
    """Return a matrix that maps the circle of radius s to the ellipse of energy s^2 / 2."""
    return np.linalg.cholesky(plane_inertia(system))


def ellipse(system: AbstractSystem, energy: float) -> Float[np.ndarray, "K 2"]:
    """Return the closed curve of one energy."""
    angle = np.linspace(0.0, 2 * np.pi, 361)
    circle = np.sqrt(2 * energy) * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    return circle @ half_axes(system).T


def name_axes(axes: Axes, system: AbstractSystem) -> None:
    """Name the axes; both of a top have one scale."""
    sheet, form = sheet_of(system), system.normal_form
    across, up = ("$r_1$", "$r_2$") if sheet is None else sheet.momentum_labels
    axes.set(xlabel=across, ylabel=up)
    axes.margins(0.06)
    if form is not None and not form.is_sleigh:
        axes.set_aspect("equal", adjustable="datalim")
