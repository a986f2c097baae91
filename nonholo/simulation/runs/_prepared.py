"""What every run checks and computes before its first step."""

from typing import Any, NamedTuple

import numpy as np

from nonholo._checks import choice, step_counts
from nonholo._limits import within_a_year, within_memory
from nonholo.discrete import Discretization, initial_state
from nonholo.discrete._branch_rules import AbstractBranchRule, checked_rule
from nonholo.discrete._composition import check_composed_run
from nonholo.discrete._discretization import as_discretization
from nonholo.discrete._start import in_group
from nonholo.discrete._structured import is_secular

_COMPILED, _BY_DEFINITION = 5e-10, 1e-5  # least seconds of a step for each component of momentum; of one step


class Start(NamedTuple):
    """The first state of a run: canonical momenta, compact pose, and what the start demanded of the first step."""

    reduced: np.ndarray
    pose: np.ndarray
    demanded: np.ndarray | None


def checked_counts(
    discrete: Discretization, steps: Any, save_every: Any, branch: Any, backend: str, displacement: Any
) -> tuple[int, int, AbstractBranchRule]:
    """Return the numbers of steps of a run and its branch rule, after checking that they can be had together."""
    as_discretization("simulate(discrete=...)", discrete, composed=True)
    steps, every = step_counts(steps, save_every)
    rule = checked_rule("simulate", discrete, branch)
    check_composed_run(discrete, displacement, principal=rule.is_principal)
    choice("simulate(backend=...)", backend, ("auto", "numba", "jax"))
    return steps, every, rule


def refuse_too_long(owner: str, discrete: Discretization, steps: int, *, compiled: bool, members: int = 1) -> None:
    """Refuse more steps than a year has time for, however fast the machine is."""
    least = _COMPILED * (discrete.system.rank + 1) if compiled else _BY_DEFINITION
    within_a_year(f"{owner}(steps=...)", members * steps * least, "Pass fewer steps, or a larger time_step.")


def refuse_too_large(owner: str, discrete: Discretization, states: int, reconstruct: bool, *, members: int = 1) -> None:
    """Refuse more saved states, or larger poses, than memory holds."""
    size, pose = 1 + 2 * discrete.system.rank, reconstruct * discrete.system.group.pose_size
    what, remedy = ("reconstruct", "Pass reconstruct=False, raise") if pose > size else ("steps", "Raise")
    remedy += " save_every, or pass store=... (`simulate`) or reduce=... (`ensemble`)."
    within_memory(f"{owner}({what}=...)", 8.0 * members * states * (size + pose), remedy)


def first_state(
    discrete: Discretization, configuration: Any, saved: int, compiled: bool, starts: dict[str, Any]
) -> Start:
    """Return the checked start of a run that holds so many poses in memory."""
    g = first_pose(discrete, configuration, saved, compiled)
    reduced, demanded = initial_state(discrete, g, **starts)
    pose = np.empty(0) if g is None else discrete.system.group.pose_from_matrix(g @ discrete.system.frame)
    return Start(reduced, pose, demanded)


def first_pose(discrete: Discretization, configuration: Any, saved: int, compiled: bool) -> np.ndarray | None:
    """Return the first pose; None where neither the step nor the result needs one."""
    group = discrete.system.group
    needless = saved == 0 and compiled and is_secular(discrete)
    if configuration is None:
        return None if needless else group.identity
    g = in_group("simulate(configuration=...)", group, configuration)
    return None if needless else g
