"""The figures of the paper, drawn again, and pictures of what it describes in words; one module for each.

A module has a `FIGURE`. Orbits and surfaces are computed by the library, in double precision.
"""

from nonholo_paper.figures._all import figures
from nonholo_paper.figures._figure import Figure

__all__ = ["Figure", "figures"]
