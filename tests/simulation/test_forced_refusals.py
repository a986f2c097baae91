"""What knows free motions alone, or no such force, refuses a system with forces."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import nonholo as nh

TOP = nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]])
HEAVY = nh.Gravity(force=[0.2, -0.3, -1.0], point=[0.1, 0.2, 0.3])
SLOPE = nh.Gravity(force=[0.4, -1.0], point=[0.5, 0.3])
RUB = nh.Friction([0.1, 0.2, 0.3])


_FORCED = nh.Forced(TOP, HEAVY, RUB)
_MAP = nh.discretize(_FORCED, 0.1)
_RUN = nh.simulate(_MAP, restricted_velocity=[0.5, -0.3], steps=5)
_PUSHED = nh.discretize(nh.Forced(TOP, force=np.ones((5, 3))), 0.1)
_PAIR = nh.Forced(TOP, force=lambda *state: state[2][:2])
_REFUSED: dict[str, Callable[[], Any]] = {
    "step": lambda: nh.step(_MAP, [0.1, 0.2]),
    "certified branches": lambda: nh.branches(_MAP, momentum=[0.1, 0.2], certify=True),
    "inverse_discrete_legendre": lambda: nh.inverse_discrete_legendre(_MAP, np.zeros(3)),
    "fold_distance": lambda: nh.fold_distance(_MAP, np.eye(3)),
    "discrete_legendre": lambda: nh.discrete_legendre(_MAP, np.eye(3)),
    "momentum_locus": lambda: nh.momentum_locus(_MAP),
    "invariant_curve": lambda: nh.invariant_curve(_MAP, 0.1),
    "critical_energies": lambda: nh.critical_energies(_MAP),
    "consistency_defect": lambda: nh.consistency_defect(_MAP, np.eye(3)),
    "heteroclinic": lambda: nh.heteroclinic(_MAP, energy=0.1),
    "flow_obstruction": lambda: nh.flow_obstruction(_MAP, 0.1),
    "equilibria": lambda: nh.equilibria(_FORCED),
    "equilibria of the map": lambda: nh.equilibria(_MAP),
    "invariant_measure": lambda: nh.invariant_measure(_FORCED),
    "conserved_momenta": lambda: nh.conserved_momenta(_FORCED),
    "lyapunov_function": lambda: nh.lyapunov_function(_FORCED),  # type: ignore[arg-type]
    "asymptotics": lambda: nh.asymptotics(_RUN),
    "vector_field of a table": lambda: nh.vector_field(_PUSHED.system),
    "ensemble of longer runs": lambda: nh.ensemble(_PUSHED, restricted_velocity=np.ones((2, 2)), steps=9),
    "ensemble of flows of a table": lambda: nh.ensemble(
        nh.Forced(TOP, force=np.ones((3, 3))), restricted_velocity=np.ones((2, 2)), times=(0.0, 1.0)
    ),
    "sweep of longer runs": lambda: nh.EnsembleTask(_PUSHED, steps=9),
    "reduction of free motions": lambda: nh.EnsembleTask(_MAP, steps=3, reductions=["final_state", "energy_drift"]),
    "phase_portrait": lambda: nh.plot.phase_portrait(_FORCED),
    "branch": lambda: nh.simulate(_MAP, restricted_velocity=[0.5, -0.3], steps=5, branch="nearest"),
    "backend": lambda: nh.simulate(_MAP, restricted_velocity=[0.5, -0.3], steps=5, backend="jax"),
    "displacement": lambda: nh.simulate(_MAP, displacement=np.eye(3), steps=5),
    "order": lambda: nh.discretize(nh.Forced(nh.VeselovaTop(np.diag([1.0, 2.0, 3.0])), HEAVY), 0.1, order=4),
    "energy with another difference": lambda: nh.discretize(
        nh.Forced(TOP, HEAVY, scheme="energy"), 0.1, difference="logarithmic"
    ),
    "a matrix of another size": lambda: nh.Forced(TOP, nh.Linear(np.eye(2))),
    "a spring of another dimension": lambda: nh.Forced(TOP, nh.Spring([0.1, 0.2], [0.0, 0.0], 1.0)),
    "two functions": lambda: nh.Forced(TOP, (lambda g: g[0, 0], lambda g: g[1, 1])),
    "a scheme of coordinates": lambda: nh.Forced(nh.examples.particle().system, lambda q: q[0], scheme="energy"),
    "difference": lambda: nh.discretize(_FORCED, 0.1, difference="logarithmic"),
    "closed_form": lambda: nh.flow(_FORCED, restricted_velocity=[0.5, -0.3], times=(0.0, 1.0), method="closed_form"),
    "flow of a table": lambda: nh.flow(
        nh.Forced(TOP, force=np.ones((3, 3))), restricted_velocity=[0.5, -0.3], times=(0.0, 1.0)
    ),
    "forced twice": lambda: nh.Forced(_FORCED),
    "no system": lambda: nh.Forced(3),  # type: ignore[arg-type]
    "no potential": lambda: nh.Forced(TOP, 3.0),
    "points of another dimension": lambda: nh.Forced(TOP, SLOPE),
    "friction of another dimension": lambda: nh.Forced(TOP, force=nh.Friction([1.0, 2.0])),
    "friction that drives": lambda: nh.Friction([1.0, -2.0, 0.0]),
    "two frictions": lambda: nh.Forced(TOP, force=(RUB, RUB)),
    "two tables beside friction": lambda: nh.Forced(TOP, force=(RUB, np.ones((5, 3)), np.ones((5, 3)))),
    "a table of another dimension in a sum": lambda: nh.Forced(TOP, force=(RUB, np.ones((3, 2)))),
    "flow of a sum with a table": lambda: nh.flow(
        nh.Forced(TOP, force=(RUB, np.ones((3, 3)))), restricted_velocity=[0.5, -0.3], times=(0.0, 1.0)
    ),
    "a table of another dimension": lambda: nh.Forced(TOP, force=np.ones((3, 2))),
    "a potential of two numbers": lambda: nh.Forced(TOP, lambda g: g[0]).potential_energy(np.eye(3)),
    "a force of two numbers": lambda: _PAIR.applied_force(0.0, np.eye(3), np.ones(3)),
}


@pytest.mark.parametrize("question", _REFUSED)
def test_what_does_not_know_of_forces_is_refused(question: str) -> None:
    """Whatever serves free motions alone says so, in place of leaving the forces out."""
    with pytest.raises(ValueError, match=r"Force|force|Friction|Gravity"):
        _REFUSED[question]()


def test_friction_in_the_place_of_a_potential_is_sent_to_the_force() -> None:
    """The second argument is the potential: friction there is refused with the name of its own argument."""
    with pytest.raises(ValueError, match=r"Friction and other forces as force="):
        nh.Forced(TOP, nh.Friction([1.0, 2.0, 0.0]))
