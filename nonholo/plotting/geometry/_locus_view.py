"""A view of a momentum locus in space that sees where it meets itself."""

import numpy as np

from nonholo.analysis import MomentumLocus
from nonholo.plotting.elements import spans
from nonholo.plotting.parts import View

_VIEW = (25.0, -52.0)  # elevation and azimuth
_AZIMUTHS = np.arange(-70.0, -24.0, 5.0)  # of a top


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
