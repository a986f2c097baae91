"""What a run looks for."""

from typing import Any

from nonholo.base.checks import error
from nonholo.orbit import AbstractStepper
from nonholo.simulation.events._event import checked_events
from nonholo.simulation.events._search import Watch


def watched(owner: str, stepper: AbstractStepper[Any], events: Any) -> Watch | None:
    """Return what a run looks for, refused where parts of its steps are not defined; None without events."""
    if events is None:
        return None
    named = checked_events(owner, events)
    if stepper.part_refused is not None:
        remedy = "Look for changes of sign in the states yourself."
        raise error(f"{owner}(events=...)", "have parts of a step", stepper.part_refused, remedy)
    return Watch(named, stepper.motion.after_parts)
