"""Entry points that run a motion: loops, thinning, outcomes."""

from nonholo.simulation._flow import flow
from nonholo.simulation._simulate import simulate

__all__ = ["flow", "simulate"]
