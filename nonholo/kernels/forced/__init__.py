"""Steps under forces: half impulses, linear or of functions, and the loops over steps."""

from nonholo.kernels.forced._driven import Drive, function_of
from nonholo.kernels.forced._kick import Kick
from nonholo.kernels.forced.run import ForcedBody

__all__ = [
    "Drive",
    "ForcedBody",
    "Kick",
    "function_of",
]
