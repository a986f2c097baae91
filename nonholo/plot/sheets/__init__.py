"""Bodies with two admissible directions on paper: their displacements on a disc or a strip, and their momenta.

What differs between tops and sleighs in pictures is in two classes of one interface, in `_chosen`.
"""

from nonholo.plot.sheets._blade import Blade
from nonholo.plot.sheets._chosen import (
    AbstractSheet,
    blade_of_system,
    ellipse,
    half_axes,
    momenta_on_plane,
    name_axes,
    on_plane,
    plane_inertia,
    sheet_of,
)
