"""What people ride and drive, and what wriggles."""

from nonholo.literature.vehicles._bicycle import bicycle
from nonholo.literature.vehicles._snake import snake
from nonholo.literature.vehicles._trailers import trailers

__all__ = ["bicycle", "snake", "trailers"]
