"""The mesh of a momentum locus in space, shaded, and a view that sees where it meets itself."""

from typing import Any

import numpy as np
from matplotlib.colors import to_rgb

from nonholo._types import Float
from nonholo.analysis import MomentumLocus
from nonholo.plotting._sphere import View

_SHEET = "#9cc4dd"
_OPACITY = 0.42
_FLAT = 1e-9
_VIEW = (25.0, -52.0)  # elevation and azimuth
_AZIMUTHS = np.arange(-70.0, -24.0, 5.0)  # of a top


def draw_surface(axes: Any, momentum: Float[np.ndarray, "R C 3"]) -> Any:
    """Draw the translucent mesh."""
    x, y, z = np.moveaxis(momentum, -1, 0)
    scaled = momentum / spans(momentum)
    normal = np.cross(np.gradient(scaled, axis=0), np.gradient(scaled, axis=1))
    length = np.linalg.norm(normal, axis=-1, keepdims=True)
    light = np.abs(normal / np.where(length > 0, length, 1.0) @ (np.array([0.35, -0.45, 0.82])))
    shade = 0.55 + 0.45 * light[..., None]
    colours = np.concatenate([shade * to_rgb(_SHEET), np.full(shade.shape, _OPACITY)], axis=-1)
    rows, columns = x.shape
    return axes.plot_surface(
        x, y, z, facecolors=colours, rcount=rows, ccount=columns, linewidth=0, antialiased=False, shade=False
    )


def spans(momentum: Float[np.ndarray, "R C 3"]) -> Float[np.ndarray, "3"]:
    """Return the extent of each component; that of the largest where a surface is flat but for rounding."""
    span = np.ptp(momentum.reshape(-1, 3), axis=0)
    return np.where(span > _FLAT * span.max(), span, span.max())


def best_view(locus: MomentumLocus) -> tuple[float, float]:
    """Return a view that sees the double segments of a top well apart."""
    if len(locus.double_lines) < 3:
        return _VIEW
    along = np.diff(locus.double_lines, axis=1)[:, 0] / spans(locus.momentum)

    def apart(azimuth: float) -> float:
        flat = View(azimuth, _VIEW[0])(along)[0]
        flat = flat / np.linalg.norm(flat, axis=1, keepdims=True)
        return float(1 - np.abs(flat @ flat.T - np.eye(3)).max())

    return _VIEW[0], float(max(_AZIMUTHS, key=apart))
