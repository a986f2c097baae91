"""The options of a run, checked."""

from typing import NamedTuple

from nonholo.base.checks import choice, step_counts
from nonholo.discrete import (
    AbstractBranchRule,
    BranchRule,
    Discretization,
    as_discretization,
    checked_rule,
    refuse_composition,
)


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
        as_discretization("simulate(discrete=...)", discrete, composed=True)
        steps, every = step_counts(steps, save_every)
        rule = checked_rule("simulate", discrete, branch)
        if not rule.is_principal:
            remedy = "Leave branch out: each substep takes the principal root."
            refuse_composition("simulate(branch=...)", discrete, remedy)
        choice("simulate(backend=...)", backend, ("auto", "numba", "jax"))
        return cls(steps, every, rule, backend, reconstruct, throw, progress)
