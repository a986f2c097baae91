"""Limits of runs: no more time or memory than there is."""

from nonholo.base.limits import within_a_year, within_memory
from nonholo.discrete import Discretization

_COMPILED, _BY_DEFINITION = 5e-10, 1e-5  # least seconds of a step for each component of momentum; of one step


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


def refuse_many_matrices(
    where: str, discrete: Discretization, states: int, remedy: str, *, derivatives: int = 0
) -> None:
    """Refuse more states in matrices, with derivatives of each, than memory holds."""
    numbers = 2 + discrete.system.rank + discrete.system.group.dim + 2 * discrete.system.group.size**2
    within_memory(where, 8.0 * states * numbers * (1 + derivatives), remedy)
