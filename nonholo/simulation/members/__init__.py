"""Many motions at once: the members of an ensemble, their starts, their loops, and what is returned."""

from nonholo.simulation.members._ensemble import ensemble
from nonholo.simulation.members._executors import in_one_thread
from nonholo.simulation.members._members import Members, ScalarMembers, in_lanes, numbers_of, tangents
from nonholo.simulation.members._result import Ensemble
