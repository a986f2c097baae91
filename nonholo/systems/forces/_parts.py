"""What a force is made of: friction, a table and a function, each at most once."""

from typing import Any

from nonholo.base.checks import error, shown
from nonholo.systems.forces._friction import Friction


def parts_of(force: Any) -> dict[str, Any]:
    """Return friction, table and function of a force, or of a tuple or list of them; of None nothing.

    Rows in a tuple or list are a table, unless friction or a function stands beside them.
    """
    several = isinstance(force, tuple | list) and any(_kind(each) != "table" for each in force)
    forces = force if several else () if force is None else (force,)
    parts = {_kind(each): each for each in forces}
    if len(parts) < len(forces):
        remedy = "Add coefficients, rows or functions of one kind together."
        raise error("Forced(force=...)", "have at most one force of each kind", shown(force), remedy)
    return parts


def joined(parts: dict[str, Any]) -> Any:
    """Return the force of parts: None of nothing, a single one as it is, a tuple of several."""
    forces = tuple(parts.values())
    return forces if len(forces) > 1 else forces[0] if forces else None


def _kind(force: Any) -> str:
    return "friction" if isinstance(force, Friction) else "function" if callable(force) else "table"
