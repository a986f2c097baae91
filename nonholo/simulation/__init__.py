"""Entry points that run a motion: loops, thinning, outcomes."""

from nonholo.orbit import Crossings, EventLog
from nonholo.simulation._blocks import iterate
from nonholo.simulation._ensemble import ensemble
from nonholo.simulation._ensemble_result import Ensemble
from nonholo.simulation._ensemble_run import in_one_thread
from nonholo.simulation._events import Event
from nonholo.simulation._events_of import crossings, cusp
from nonholo.simulation._flow import flow
from nonholo.simulation._prepared import refuse_too_long
from nonholo.simulation._resume import extend, resume
from nonholo.simulation._simulate import simulate
from nonholo.simulation._stretch import closed_step

__all__ = [
    "Crossings",
    "Ensemble",
    "Event",
    "EventLog",
    "closed_step",
    "crossings",
    "cusp",
    "ensemble",
    "extend",
    "flow",
    "in_one_thread",
    "iterate",
    "refuse_too_long",
    "resume",
    "simulate",
]
