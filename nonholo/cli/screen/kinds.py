"""Which pictures of a run there are, by the names of the command line."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np

    from nonholo.orbit import Orbit

_GENERATIONS = 4  # of a tree of branches
_ARGUMENTS: dict[str, Callable[["Orbit"], tuple[Any, ...]]] = {
    **dict.fromkeys(("overview", "blade-track"), lambda orbit: (orbit,)),
    **dict.fromkeys(("body-axis-track", "point-track"), lambda orbit: (orbit,)),
    "phase-portrait": lambda orbit: (orbit.system, orbit),
    **dict.fromkeys(("momentum-sphere", "energy-error"), lambda orbit: (orbit,)),
    **dict.fromkeys(("invariant-curves", "branch-counts"), lambda orbit: (orbit.motion, orbit)),
    "momentum-locus": lambda orbit: (_locus(orbit), orbit),
    "locus-section": lambda orbit: (_locus(orbit),),
    "branches": lambda orbit: (orbit.motion,),
    "branch-tree": lambda orbit: (orbit.motion, _tree(orbit)),
    "section": lambda orbit: (orbit.events[0] if orbit.events else None,),
}
KINDS = tuple(_ARGUMENTS)


def figure_of(kind: str, orbit: "Orbit", flow: Callable[["Orbit"], Any], look: dict[str, Any], **names: Any) -> Any:
    """Return the figure of one kind: with the flow beside the orbit, of the first displacement, of named quantities."""
    from nonholo import plot

    if kind in ("overview", "blade-track"):
        look = look | {"flow": flow(orbit)}
    elif kind == "branches":
        look = look | {"displacement": orbit.displacement[0]}
    named = {side: _quantity(side, name) for side, name in names.items()}
    drawn = getattr(plot, kind.replace("-", "_"))(*_ARGUMENTS[kind](orbit), **named, **look)
    return drawn if kind == "overview" else (drawn.plane if kind == "branch-tree" else drawn.axes).figure


def _locus(orbit: Any) -> Any:
    import nonholo

    return nonholo.momentum_locus(orbit.motion)


def _tree(orbit: Any) -> Any:
    import nonholo

    return nonholo.branch_tree(orbit.motion, orbit.displacement[0], _GENERATIONS)


def _quantity(side: str, name: str | None) -> Callable[["Orbit"], "np.ndarray"]:
    """Return what gives a number of each state: an array of orbits by its name, with the indices of one component."""
    attribute, *indices = (name or "").split(".")

    def quantity(states: "Orbit") -> "np.ndarray":
        values: Any = getattr(states, attribute, None)
        if not all(index.isdigit() for index in indices) or not hasattr(values, "shape"):
            raise ValueError(f"a section needs --x and --y like body_velocity.0. Got '{name}' to run {side}.")
        return values[(slice(None), *map(int, indices))]

    quantity.__name__ = name or side
    return quantity
