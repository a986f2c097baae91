"""Forces and potentials: what acts on a system beside its constraint, and the system with it."""

from nonholo.systems.forces._forced import Forced
from nonholo.systems.forces._friction import Friction
from nonholo.systems.forces._gravity import Gravity
from nonholo.systems.forces._linear import Linear
from nonholo.systems.forces._parts import joined, parts_of
from nonholo.systems.forces._slip import Slip
from nonholo.systems.forces._spring import Spring
from nonholo.systems.forces._widened import Widened
