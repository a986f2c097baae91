"""The projective plane of displacements of the top: the disc of (q1, q2), q0 >= 0; opposite rim points are one."""

from typing import Any

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection

from nonholo.analysis import InvariantCurve


def project(z: Float[np.ndarray, "... 3"]) -> Float[np.ndarray, "... 2"]:
    """Return (q1, q2) of half-angle vectors (z0, z1, z2), z = sin(angle/2) u in the plane of u and e3."""
    upper = np.where(z[..., :1] < 0, -z, z)
    return np.stack([-upper[..., 2], upper[..., 1]], axis=-1)


def draw_curve(axes: Axes, curve: InvariantCurve, **look: Any) -> LineCollection:
    """Draw the components of an invariant curve, cut where they cross the rim."""
    runs = []
    for points in curve.components:
        turned = np.flatnonzero(np.diff(points[:, 0] >= 0)) + 1
        runs += [project(run) for run in np.split(points, turned) if len(run) > 1]
    lines = LineCollection(runs, **look)
    axes.add_collection(lines)
    return lines
