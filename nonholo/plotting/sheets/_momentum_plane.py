"""The plane of the momenta along a two-dimensional constraint subspace: its energy ellipses and the names of its axes.

Coordinates are those of the canonical body frame. What is drawn on it is not decided here.
"""

from typing import Any

import numpy as np
from matplotlib.axes import Axes

from nonholo._types import Float
from nonholo.systems import ChaplyginSleigh, SuslovTop

_LABELS = {
    ChaplyginSleigh: (r"angular momentum  $\pi = p_\theta + b\,p_1$", r"momentum along the blade  $p_1$"),
    SuslovTop: (r"$M_{13}$, along $e_1\wedge e_3$", r"$M_{23}$, along $e_2\wedge e_3$"),
}


def reduced(system: Any, restricted: Float[np.ndarray, "... k"]) -> Float[np.ndarray, "... k"]:
    """Return restricted momenta in the canonical frame."""
    return system.to_canonical(restricted)


def half_axes(system: Any) -> Float[np.ndarray, "2 2"]:
    """Return a matrix that maps the circle of radius s to the ellipse of energy s^2 / 2."""
    return np.linalg.cholesky(np.asarray(system.canonical.constrained_inertia))


def ellipse(system: Any, energy: float) -> Float[np.ndarray, "K 2"]:
    """Return the closed curve of one energy."""
    angle = np.linspace(0.0, 2 * np.pi, 361)
    circle = np.sqrt(2 * energy) * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    return circle @ half_axes(system).T


def name_axes(axes: Axes, system: Any) -> None:
    """Name the axes; both of a top have one scale."""
    plane = len(system.constraint_subspace) == 2
    across, up = _LABELS.get(type(system), ("$r_1$", "$r_2$")) if plane else ("$r_1$", "$r_2$")
    axes.set(xlabel=across, ylabel=up)
    axes.margins(0.06)
    if isinstance(system, SuslovTop):
        axes.set_aspect("equal", adjustable="datalim")
