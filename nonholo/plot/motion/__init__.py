"""Pictures of an orbit: paths in space, momenta, the error of its energy, quantities in time."""

from nonholo.plot.motion._coordinates import (
    Bodies,
    Track,
    bodies_of,
    draw_path,
    draw_shape,
    draw_velocity,
    momentum_track,
    symbol,
    track_of,
)
from nonholo.plot.motion._fit import fit_profile, fit_residuals
from nonholo.plot.motion._phase_portrait import phase_portrait
from nonholo.plot.motion._spheres import body_axis_track, known_axes, momentum_sphere, rotation_axes
from nonholo.plot.motion._time_series import (
    draw_residual,
    energy_error,
    heading_and_speed,
    momentum_components,
    velocity_components,
)
from nonholo.plot.motion._tracks import blade_track, point_track
