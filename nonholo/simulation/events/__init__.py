"""Events: what they are, the search for them in states of a motion, and flows that look for some."""

from nonholo.simulation.events._crossings import (
    begun_at,
    between_times,
    check_functions,
    check_resets,
    crossings,
    cusp,
    flow_in_coordinates,
    flow_with_events,
    of_requested,
    refuse_resets,
    watch_for,
)
from nonholo.simulation.events._event import Event, Impact, checked_events, has_resets
from nonholo.simulation.events._search import (
    Part,
    Watch,
    find_crossings,
    locate,
    piece_of,
    search,
    struck,
    values_of,
)
