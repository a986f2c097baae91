"""Entry points that run a motion: loops, thinning, outcomes."""

from nonholo.simulation._simulate import simulate

__all__ = ["simulate"]
