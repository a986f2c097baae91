"""Pictures of an orbit: paths in space, momenta, the error of its energy, quantities in time."""

from nonholo.plot.motion._blade_track import blade_track
from nonholo.plot.motion._bodies import Bodies, bodies_of
from nonholo.plot.motion._body_axis_track import body_axis_track, known_axes, rotation_axes
from nonholo.plot.motion._coordinates import Track, draw_path, draw_shape, draw_velocity, symbol, track_of
from nonholo.plot.motion._energy_error import draw_residual, energy_error
from nonholo.plot.motion._fit import fit_profile, fit_residuals
from nonholo.plot.motion._momentum_sphere import momentum_sphere
from nonholo.plot.motion._phase_portrait import phase_portrait
from nonholo.plot.motion._point_track import point_track
from nonholo.plot.motion._time_series import heading_and_speed, momentum_components, velocity_components
