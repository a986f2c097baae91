"""The plane of displacements and that of momenta of a body with two admissible directions."""

from nonholo.plotting.sheets._momentum_plane import ellipse, half_axes, name_axes, reduced
from nonholo.plotting.sheets._variety_plane import disc, draw_level, dress, flat

__all__ = [
    "disc",
    "draw_level",
    "dress",
    "ellipse",
    "flat",
    "half_axes",
    "name_axes",
    "reduced",
]
