"""Events: what they are, the search for them in states of a motion, and flows that look for some."""

from nonholo.simulation.events._crossings import begun_at, check_resets, crossings, cusp, refuse_resets, watched
from nonholo.simulation.events._event import Event, checked_events, has_resets
from nonholo.simulation.events._flow import (
    between_times,
    check_functions,
    flow_in_coordinates,
    flow_with_events,
    of_requested,
)
from nonholo.simulation.events._impact import Impact
from nonholo.simulation.events._search import (
    Part,
    Watch,
    crossed,
    located,
    piece_of,
    search,
    struck,
    values_of,
)
