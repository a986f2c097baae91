"""The options of a run, checked."""

from typing import Any, NamedTuple

from nonholo.base.checks import choice, error, step_counts
from nonholo.discrete import (
    AbstractBranchRule,
    BranchRule,
    Discretization,
    as_discretization,
    checked_rule,
    refuse_composition,
)


def check_forces(owner: str, discrete: Any, steps: int, *, free: str | None = None, traced: bool = False) -> None:
    """Refuse what runs with forces do not have, which `free` names, and more steps than their table has rows.

    Traced are numbers alone.
    """
    if (forced := discrete.forces) is None:
        return
    if free is not None:
        raise error(f"{owner}(discrete=...)", "have the principal branch under forces", free, "Leave both out.")
    if forced.table is not None and steps > len(forced.table):
        remedy = "Pass fewer steps, or a force for each step."
        raise error(f"{owner}(steps=...)", "be at most one for each row of the forces", f"{steps}", remedy)
    if traced and forced.needs_function:
        remedy = "Use Gravity, Friction or a table: what a function does is not traced."
        raise error(f"{owner}(discrete=...)", "have forces that are numbers", "a Python function", remedy)


class RunOptions(NamedTuple):
    """The options of a run, whatever its start.

    Attributes:
        steps: Number of steps.
        every: Steps between saved states.
        rule: Which value of the map a step takes.
        backend: "auto", "numba" or "jax".
        reconstruct: Whether poses are kept.
        throw: Whether a run that cannot continue raises.
        progress: Whether a progress bar is shown.
    """

    steps: int
    every: int
    rule: AbstractBranchRule
    backend: str
    reconstruct: bool
    throw: bool
    progress: bool

    @classmethod
    def of(
        cls,
        discrete: Discretization,
        *,
        steps: int,
        save_every: int,
        branch: BranchRule,
        backend: str,
        reconstruct: bool,
        throw: bool,
        progress: bool,
    ) -> "RunOptions":
        """Return checked options that a discretization can be run with."""
        as_discretization("simulate(discrete=...)", discrete, composed=True, forced=True)
        steps, every = step_counts(steps, save_every)
        rule = checked_rule("simulate", discrete, branch)
        if not rule.is_principal:
            remedy = "Leave branch out: each substep takes the principal root."
            refuse_composition("simulate(branch=...)", discrete, remedy)
        choice("simulate(backend=...)", backend, ("auto", "numba", "jax"))
        plain = rule.is_principal and backend != "jax"
        free = None if plain else f"branch {rule.name!r} and backend {backend!r}"
        check_forces("simulate", discrete, steps, free=free)
        return cls(steps, every, rule, backend, reconstruct, throw, progress)
