"""The orbit: compact states of a motion and their decoding by the group. Nothing is simulated here."""

from nonholo.orbit._orbit import AbstractMotion, Orbit, as_orbit
from nonholo.orbit._poses import configurations, unwrapped

__all__ = ["AbstractMotion", "Orbit", "as_orbit", "configurations", "unwrapped"]
