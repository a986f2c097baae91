"""Parts of pictures, for those that compose their own: a surface of momenta, the rim of a disc of displacements."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.patches import Circle

from nonholo.base.types import Float
from nonholo.plot import theme

_SHEET = "#9cc4dd"
_OPACITY = 0.42
_FLAT = 1e-9
_PAIRS = "abcd"  # names of pairs of opposite points of the rim that are one


def draw_surface(axes: Any, momentum: Float[np.ndarray, "R C 3"]) -> Any:
    """Draw a surface of momenta as a translucent mesh, lit from above.

    Args:
        axes: Axes in space.
        momentum: The rows and columns of the mesh.

    Example:
        >>> import matplotlib.pyplot as plt
        >>> axes = plt.figure().add_subplot(projection="3d")
        >>> sphere = [[[np.cos(u) * np.cos(v), np.sin(u) * np.cos(v), np.sin(v)] for u in range(7)] for v in (-1, 0, 1)]
        >>> draw_surface(axes, np.array(sphere)).get_facecolor().shape
        (12, 4)
    """
    x, y, z = np.moveaxis(momentum, -1, 0)
    unit = momentum / spans(momentum)
    normal = np.cross(np.gradient(unit, axis=0), np.gradient(unit, axis=1))
    length = np.linalg.norm(normal, axis=-1, keepdims=True)
    light = np.abs(normal / np.where(length > 0, length, 1.0) @ (np.array([0.35, -0.45, 0.82])))
    shade = 0.55 + 0.45 * light[..., None]
    colors = np.concatenate([shade * to_rgb(_SHEET), np.full(shade.shape, _OPACITY)], axis=-1)
    rows, columns = x.shape
    look = {"rcount": rows, "ccount": columns, "linewidth": 0, "antialiased": False, "shade": False}
    return axes.plot_surface(x, y, z, facecolors=colors, **look)


def spans(momentum: Float[np.ndarray, "R C 3"]) -> Float[np.ndarray, "3"]:
    """Return the extent of each component; the largest of them where a surface is flat up to rounding."""
    span = np.ptp(momentum.reshape(-1, 3), axis=0)
    return np.where(span > _FLAT * span.max(), span, span.max())


def draw_rim(axes: Axes) -> None:
    """Draw the half-turns around a disc of displacements; points with the same letter are the same one.

    Args:
        axes: Axes whose unit circle is the rim.

    Example:
        >>> import matplotlib.pyplot as plt
        >>> axes = plt.figure().add_subplot()
        >>> draw_rim(axes)
        >>> [text.get_text() for text in axes.texts]
        ['a', 'a', 'b', 'b', 'c', 'c', 'd', 'd']
    """
    axes.add_patch(Circle((0, 0), 1.0, facecolor="none", edgecolor=theme.MUTED, linewidth=1.2, zorder=2))
    for index, letter in enumerate(_PAIRS):
        angle = np.pi * (index + 0.5) / len(_PAIRS)
        for sign in (1, -1):
            x, y = sign * np.cos(angle), sign * np.sin(angle)
            axes.plot(x, y, "o", color=theme.MUTED, markersize=4, zorder=4)
            axes.text(1.07 * x, 1.07 * y, letter, color=theme.INK, ha="center", va="center", style="italic")
