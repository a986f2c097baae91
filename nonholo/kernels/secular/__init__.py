"""The step in O(n) of tops on SO(n) and sleighs on SE(n): two unknowns, the path to the principal root, its proof."""

from nonholo.kernels.secular._root import certain_radius, level_of
from nonholo.kernels.secular._step import SecularBody, room_for_sums, secular_sleigh, secular_top, term
