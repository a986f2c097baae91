"""What people ride and drive, and what wriggles."""

from nonholo.examples.vehicles._bicycle import bicycle
from nonholo.examples.vehicles._snake import snake
from nonholo.examples.vehicles._trailers import trailers

__all__ = ["bicycle", "snake", "trailers"]
