"""Numbers side by side, on which processors work at once."""

from nonholo.kernels.lanes._lanes import EIGHT, FOUR, ONE, load, spread, store
