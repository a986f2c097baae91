r"""What data sets there are: a system, a box of first configurations, weights of first momenta, a range of energies.

A first momentum is $p = s\,D u$ with u uniform on the unit sphere and D the diagonal matrix of the weights; s gives the
kinetic energy that is drawn.
"""

import importlib
from typing import Any, NamedTuple

import numpy as np

from nonholo.ensembles.designs import AbstractDistribution, Direction, Uniform
from nonholo.systems import ChaplyginSleigh, MultidimensionalSleigh, SuslovTop, VeselovaTop

_TENSOR = [[1.4, 0.2, 0.5, 0.1], [0.2, 1.0, -0.3, 0.2], [0.5, -0.3, 0.9, 0.1], [0.1, 0.2, 0.1, 0.8]]
_DIAGONAL, _CENTER = [0.6, 0.4, 0.2, 0.3], (0.5, 0.2, 0.1, -0.1)
_BODIES = {
    "top": lambda: SuslovTop(np.array(_TENSOR)[:3, :3]),
    "top_so4": lambda: SuslovTop(_TENSOR),
    "veselova": lambda: VeselovaTop(np.array(_TENSOR)[:3, :3]),
    "sleigh": lambda: ChaplyginSleigh(1.0, 1.0, a=0.5, b=0.3),
    "sleigh_se3": lambda: MultidimensionalSleigh(1.0, _CENTER[:3], np.diag(_DIAGONAL[:3])),
    "sleigh_se4": lambda: MultidimensionalSleigh(1.0, _CENTER, np.diag(_DIAGONAL)),
}


class Definition(NamedTuple):
    """A data set.

    Attributes:
        title: What moves.
        weights: Of the components of first momenta: of those along the constraint of bodies, else of all.
        spread: Half the edges of the box of first configurations: coordinates, or of a pose the coordinates of
            its logarithm. None for the identity: the body moves alike from every pose.
        center: The middle of the box.
        energy: The range of first kinetic energies, which are uniform.
        version: Another one wherever the same call gives other numbers.
    """

    title: str
    weights: tuple[float, ...]
    spread: tuple[float, ...] | None = None
    center: tuple[float, ...] | float = 0.0
    energy: tuple[float, float] = (0.2, 1.0)
    version: int = 1

    @property
    def distributions(self) -> dict[str, AbstractDistribution]:
        """What is drawn for each orbit, by name."""
        drawn: dict[str, AbstractDistribution] = {"start_energy": Uniform(*self.energy)}
        drawn["start_direction"] = Direction(len(self.weights))
        if self.spread is not None:
            half = np.array(self.spread)
            drawn["start_configuration"] = Uniform(self.center - half, self.center + half)
        return drawn


_TURN, _PLANE, _PI = (2.0, 2.0, 2.0), (1.0, 1.0, np.pi), np.pi
DEFINITIONS = {
    "top": Definition("Suslov top", (1.0, 1.0)),
    "top_so4": Definition("Suslov top on SO(4)", (1.0, 1.0, 1.0)),
    "veselova": Definition("Veselova top", (1.0, 1.0), _TURN),
    "sleigh": Definition("Chaplygin sleigh", (1.0, 1.0)),
    "sleigh_se3": Definition("Sleigh in space", (1.0, 1.0, 1.0)),
    "sleigh_se4": Definition("Sleigh on SE(4)", (1.0, 1.0, 1.0, 1.0)),
    "chaotic_quartic_oscillator": Definition("Chaotic quartic oscillator", 7 * (1.0,), 7 * (0.5,)),
    "chaplygin_ball": Definition("Chaplygin ball", 6 * (1.0,), (*_TURN, 0.0, 0.0, 0.0)),
    "driven_sleigh": Definition("Sleigh driven by a moving mass", (1.0, 1.0, 1.0, 0.0), (*_PLANE, 0.0)),
    "heavy_suslov_top": Definition("Suslov top in a quadratic potential", (1.0, 1.0), _TURN),
    "kinematic_car": Definition("Kinematic car", (1.0, 1.0, 1.0, 1.0, 1e-4), (*_PLANE, _PI, 0.4)),
    "knife_edge_on_incline": Definition("Knife edge on an incline", (1.0, 1.0, 1.0), _PLANE),
    "non_reversible": Definition("Oscillators in a gearbox", (1.0, 1.0, 1.0), _PLANE, energy=(0.2, 3.0)),
    "particle": Definition("Nonholonomic particle", (1.0, 1.0, 1.0), (1.0, 1.0, 1.0)),
    "roller_racer": Definition("Roller racer", (1.0, 1.0, 1.0, 0.0), (*_PLANE, 0.0)),
    "rolling_disk": Definition("Rolling disk", (1.0, 1.0, 1.0, 1.0), (*_PLANE, _PI)),
    "sleigh_in_a_well": Definition("Sleigh on a spring", (1.0, 1.0), (_PI, 1.0, 1.0)),
    "snakeboard": Definition(
        "Snakeboard", (1.0, 1.0, 1.0, 1.0, 1e-4), (*_PLANE, _PI, 0.3), center=(0.0, 0.0, 0.0, 0.0, 1.0), version=2
    ),
    "two_wheeled_robot": Definition("Robot with two wheels", 5 * (1.0,), (*_PLANE, _PI, _PI)),
}
"""Data sets by name: bodies, then `nonholo.examples`."""


def system_of(name: str) -> Any:
    """Return the system of a data set; one of `nonholo.examples` loads JAX."""
    if name in _BODIES:
        return _BODIES[name]()
    return getattr(importlib.import_module("nonholo.examples"), name)().system
