"""The overview of an orbit: its panels, and the head above them."""

from nonholo.plotting.overviews._overview import overview

__all__ = [
    "overview",
]
