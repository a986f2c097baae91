"""Entry points that run a motion: loops, thinning, outcomes."""

from nonholo.orbit import Crossings, EventLog
from nonholo.simulation._crossings import crossings, cusp
from nonholo.simulation._event import Event, Impact
from nonholo.simulation._flow import flow
from nonholo.simulation._options import check_forces, refuse_many_matrices, stepper_of
from nonholo.simulation._simulate import iterate, simulate
from nonholo.simulation._stored import extend, resume_run, size_in_blocks
from nonholo.simulation.members import (
    Ensemble,
    Members,
    ScalarMembers,
    ensemble,
    in_lanes,
    in_one_thread,
    numbers_of,
    tangents,
)
