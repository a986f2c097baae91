"""Steps under forces: half impulses, linear or of functions, and the loops over steps."""

from nonholo.kernels.forced._balanced import Balanced, Impulses
from nonholo.kernels.forced._cubic import Pull, advance_cubic, cubic_of
from nonholo.kernels.forced._driven import Drive
from nonholo.kernels.forced._kick import Kick, friction_flow
from nonholo.kernels.forced.run import ForcedBody
