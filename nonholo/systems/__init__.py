"""What a system is: a group, an inertia operator and the subspace that velocities are constrained to."""

from nonholo.systems._base import AbstractLLSystem, Equilibria
from nonholo.systems._mass import inertia_from_mass_tensor, inertia_tensor, mass_tensor_from_inertia
from nonholo.systems._sleigh import ChaplyginSleigh
from nonholo.systems._suslov import SuslovTop

__all__ = [
    "AbstractLLSystem",
    "ChaplyginSleigh",
    "Equilibria",
    "SuslovTop",
    "inertia_from_mass_tensor",
    "inertia_tensor",
    "mass_tensor_from_inertia",
]
