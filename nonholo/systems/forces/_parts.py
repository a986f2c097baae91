"""What a force is made of: friction, slip, a table, a function, each at most once; and what a potential is."""

from typing import Any

from nonholo.base.checks import error, shown
from nonholo.systems.forces._friction import Friction
from nonholo.systems.forces._slip import Slip


def parts_of(force: Any) -> dict[str, Any]:
    """Return friction, slip, table and function of a force, or of a tuple or list of them; of None nothing.

    Rows in a tuple or list are a table, unless friction or a function stands beside them.
    """
    several = isinstance(force, tuple | list) and any(_kind(each) != "table" for each in force)
    forces = force if several else () if force is None else (force,)
    parts = {_kind(each): each for each in forces}
    if len(parts) < len(forces):
        remedy = "Add coefficients, rows or functions of one kind together."
        raise error("Forced(force=...)", "have at most one force of each kind", shown(force), remedy)
    return parts


def terms_of(potential: Any) -> tuple[Any, ...]:
    """Return the potentials of one, or of a tuple or list of them, with at most one function; of None nothing."""
    terms = tuple(potential) if isinstance(potential, tuple | list) else () if potential is None else (potential,)
    where = "Forced(potential=...)"
    remedy = "Pass a function of a configuration, Gravity, Linear or Spring; Friction and other forces as force=."
    for each in terms:
        if not (callable(each) or hasattr(each, "mean_covector")):
            raise error(where, "be a potential", shown(each), remedy)
    if sum(map(callable, terms)) > 1:
        raise error(where, "have at most one function", shown(potential), "Add them together in one function.")
    return terms


def joined(parts: dict[str, Any]) -> Any:
    """Return the force of parts: None of nothing, a single one as it is, a tuple of several."""
    forces = tuple(parts.values())
    return forces if len(forces) > 1 else forces[0] if forces else None


def _kind(force: Any) -> str:
    known = {Friction: "friction", Slip: "slip"}
    return known.get(type(force)) or ("function" if callable(force) else "table")
