"""Calls of every public name that work, with the kinds of their arguments; each fast and tiny."""

import dataclasses
import itertools
import operator
from collections.abc import Callable
from typing import Any

from fuzz.kinds import Argument

import nonholo as nh

_BLOCKS = 10  # 10**12 steps in blocks of two are legal


@dataclasses.dataclass(frozen=True)
class Call:
    """A call that works.

    Attributes:
        name: The public name, and in brackets what tells this call from others of it.
        function: What is called with the arguments by name.
        arguments: Those that may be changed, with their kinds.
        slow: Whether it compiles, by JAX or numba, before it answers.
        stores: Whether its folder must hold the stores of `fuzz.shelf`.
        infinite: Whether infinity is one of its answers, as its docstring says.
    """

    name: str
    function: Callable[..., Any]
    arguments: dict[str, Argument]
    slow: bool = False
    stores: bool = False
    infinite: bool = False

    def __call__(self, **changed: Any) -> Any:
        """Call it with some arguments changed; what comes block by block is collected, the first blocks of it."""
        values = {name: argument.value for name, argument in self.arguments.items()}
        result = self.function(**{**values, **changed})
        return list(itertools.islice(result, _BLOCKS)) if self.name.startswith("iterate") else result


def call(name: str, function: Callable[..., Any] | None = None, /, **arguments: Any) -> Call:
    """Return a call that works, by default of the public name: arguments, and which of slow, stores, infinite it is."""
    flags = {flag: arguments.pop(flag, False) for flag in ("slow", "stores", "infinite")}
    return Call(name, function or operator.attrgetter(name.partition(" [")[0])(nh), arguments, **flags)


def slow(calls: list[Call]) -> list[Call]:
    """Return calls that compile, by JAX or numba."""
    return [dataclasses.replace(each, slow=True) for each in calls]


def closed(draw: Callable[..., Any]) -> Callable[..., None]:
    """Return a function that draws a picture and closes it."""

    def drawn(**arguments: Any) -> None:
        import matplotlib.pyplot as plt

        try:
            draw(**arguments)
        finally:
            plt.close("all")

    return drawn


def by_position(function: Callable[..., Any]) -> Callable[..., Any]:
    """Return a function whose arguments have names for one that takes them by position."""
    return lambda **arguments: function(*arguments.values())


NOT_CALLED = {
    "Discretization": "made by `discretize`, which checks; a pytree, whose leaves may be anything",
    "MemberBlock": "made by sweeps; its methods are called",
    "OutcomeError": "raised by runs",
    "AliasingWarning": "a warning of `Orbit.from_poses`",
    "ImpossibleBodyWarning": "a warning of `from_inertia`, which is called",
    "Crossings": "made by runs; its methods are called",
    "Ensemble": "made by `ensemble`; its methods are called",
    "EventLog": "made by runs",
    "Orbit": "made by runs; its methods are called",
    "Outcome": "an enumeration",
    "cusp": "an event; `crossings` is called with it",
    "allow_float32": "takes no argument",
    "examples.Example": "made by the examples",
    "testing.Report": "made by the checks",
    "testing.Result": "made by the checks",
}


def public_names() -> list[str]:
    """Return every public name, those of the rooms with the room before it."""
    result = [name for name in dir(nh) if name not in ("examples", "plot", "testing")]
    for room in ("examples", "plot", "testing"):
        result += [f"{room}.{name}" for name in getattr(nh, room).__all__]
    return result


def is_picture(name: str) -> bool:
    """Tell whether a name is that of the artists of a picture, which are made by the functions of `plot`."""
    return name.startswith("plot.") and name.split(".")[1][0].isupper()


def all_calls() -> dict[str, Call]:
    """Return the table, by name."""
    from fuzz import calls_analysis, calls_groups, calls_maps, calls_pictures, calls_runs, calls_stores, calls_systems

    parts = (calls_groups, calls_systems, calls_maps, calls_runs, calls_analysis, calls_stores, calls_pictures)
    return {each.name: each for part in parts for each in part.calls()}
