"""The orbit: compact states of a motion and their decoding by the group. Nothing is simulated here."""

from nonholo.orbit._base import AbstractOrbit, OrbitT, looked_at, times_within
from nonholo.orbit._crossings import AbstractEventLog, Crossings, EventLog, joined_crossings
from nonholo.orbit._decoder import AliasingWarning, Decoder, configurations, poses, turned_near, unwrap
from nonholo.orbit._orbit import STATES, AbstractMotion, Orbit, any_orbit, as_orbit, step_poses
from nonholo.orbit._stepper import AbstractStepper, DiscreteMotion, First, Plan, Rows, State, keep_row, write_first
