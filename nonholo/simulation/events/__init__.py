"""Events: what they are, the search for them in states of a motion, and flows that look for some."""

from nonholo.simulation.events._crossings import crossings, cusp, watched
from nonholo.simulation.events._event import Event, checked_events
from nonholo.simulation.events._flow import check_functions, flow_in_coordinates, flow_with_events
from nonholo.simulation.events._search import Part, Watch, crossed, located, piece_of, search, values_of
