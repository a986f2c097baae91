"""What rolls on a plane as a whole."""

from nonholo.examples.rolling._ball_in_bowl import ball_in_bowl
from nonholo.examples.rolling._ball_on_turntable import ball_on_turntable
from nonholo.examples.rolling._rattleback import rattleback
from nonholo.examples.rolling._tilting_disk import tilting_disk

__all__ = ["ball_in_bowl", "ball_on_turntable", "rattleback", "tilting_disk"]
