"""Axes in space with white walls, for surfaces that no picture of the library draws."""

from typing import Any

import numpy as np
from jaxtyping import Float
from matplotlib.figure import Figure as MatplotlibFigure
from matplotlib.ticker import MaxNLocator

from nonholo.plot import theme


def space(title: str, labels: tuple[str, str, str], view: tuple[float, float]) -> Any:
    """Return axes of a new figure; the view is elevation and azimuth in degrees."""
    axes: Any = MatplotlibFigure(figsize=(7.2, 6.4)).add_axes((-0.02, 0.01, 0.94, 0.97), projection="3d")
    axes.computed_zorder = False
    axes.set(xlabel=labels[0], ylabel=labels[1])
    axes.zaxis.set_rotate_label(False)
    axes.set_zlabel(labels[2], rotation=90)
    axes.view_init(*view)
    axes.set_box_aspect((1.0, 1.0, 0.85))
    axes.grid(False)
    for axis in (axes.xaxis, axes.yaxis, axes.zaxis):
        axis.set_pane_color((1.0, 1.0, 1.0, 0.0))
        axis.set_major_locator(MaxNLocator(4))
        axis.line.set_color(theme.MUTED)
    axes.text2D(0.03, 0.97, title, transform=axes.transAxes, fontsize="large", fontweight="bold")
    return axes


def along(line: Any) -> Float[np.ndarray, "K 3"]:
    """Return the points of a line drawn in space."""
    return np.stack(line.get_data_3d(), axis=-1)
