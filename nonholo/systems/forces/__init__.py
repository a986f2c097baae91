"""Forces and potentials: what acts on a system beside its constraint, and the system with it."""

from nonholo.systems.forces._forced import Forced, as_forced, refuse_forced
from nonholo.systems.forces._friction import Friction
from nonholo.systems.forces._gravity import Gravity
from nonholo.systems.forces._impulses import Propagator, admissible_directions, impulses, propagator, work_of

__all__ = [
    "Forced",
    "Friction",
    "Gravity",
    "Propagator",
    "admissible_directions",
    "as_forced",
    "impulses",
    "propagator",
    "refuse_forced",
    "work_of",
]
