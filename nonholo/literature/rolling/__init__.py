"""What rolls on a plane as a whole."""

from nonholo.literature.rolling._ball_on_turntable import ball_on_turntable
from nonholo.literature.rolling._rattleback import rattleback
from nonholo.literature.rolling._tilting_disk import tilting_disk

__all__ = ["ball_on_turntable", "rattleback", "tilting_disk"]
