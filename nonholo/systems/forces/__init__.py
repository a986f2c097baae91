"""Forces and potentials: what acts on a system beside its constraint, and the system with it."""

from nonholo.systems.forces._contacts import Contacts, Mode, friction, update_slope
from nonholo.systems.forces._forced import Forced, central_differences
from nonholo.systems.forces._friction import (
    Friction,
    Slip,
    Widened,
    force_of,
    parts_of,
    refuse_table,
    slips_of,
    terms_of,
    with_later_force,
    without_slips,
)
from nonholo.systems.forces._potentials import Gravity, Linear, Spring
