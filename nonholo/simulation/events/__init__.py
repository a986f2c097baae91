"""Events: what they are, the search for them in states of a motion, and runs and flows that look for some."""

from nonholo.simulation.events._blocks import computed_block, searched_first
from nonholo.simulation.events._crossings import crossings, cusp
from nonholo.simulation.events._event import Event, checked_events, values_at
from nonholo.simulation.events._flow import check_functions, flow_in_coordinates, flow_with_events
from nonholo.simulation.events._in_coordinates import blocks_with_events, iterated, simulated, watched_in_coordinates
from nonholo.simulation.events._search import Between, Watch, changes, located, search
from nonholo.simulation.events._watched import run_compiled, run_with_events, watched, watched_events

__all__ = [
    "Between",
    "Event",
    "Watch",
    "blocks_with_events",
    "changes",
    "check_functions",
    "checked_events",
    "computed_block",
    "crossings",
    "cusp",
    "flow_in_coordinates",
    "flow_with_events",
    "iterated",
    "located",
    "run_compiled",
    "run_with_events",
    "search",
    "searched_first",
    "simulated",
    "values_at",
    "watched",
    "watched_events",
    "watched_in_coordinates",
]
