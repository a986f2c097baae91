"""The common parts of pictures: which orbits are drawn, which of their states, marks, spheres, enlarged corners."""

from nonholo.plot.parts._marks import (
    draw_ends,
    draw_equilibria,
    draw_flow,
    draw_in_time,
    draw_orbit,
    evenly_in_box,
    evenly_spread,
    segments,
    some_states,
    turn_per_state,
    window,
)
from nonholo.plot.parts._page import (
    Square,
    corner_axes,
    detail,
    finish_page,
    fit_view,
    new_page,
    remove_detail,
    square_about,
)
from nonholo.plot.parts._sphere import (
    View,
    arcs,
    best_view,
    draw_curve,
    draw_globe,
    draw_named_axes,
    draw_path,
    mark_ends,
    name_beside,
    opacity,
    set_curve,
    view_of,
)
from nonholo.plot.parts._subject import (
    drawable,
    drawable_in_time,
    forbidden_axis,
    is_free,
    is_same_body,
    known_equilibria,
    own_orbit,
    permanent_velocity,
    same_group,
    with_poses,
)
