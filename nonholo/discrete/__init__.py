"""The discrete mechanics: discretisations, the discrete Legendre transformation, the step and its start."""

from nonholo.discrete._consistency import consistency_defect
from nonholo.discrete._discretization import Discretization, discretize
from nonholo.discrete._legendre import discrete_legendre
from nonholo.discrete._moser_veselov import moser_veselov_displacement
from nonholo.discrete._start import initial_state

__all__ = [
    "Discretization",
    "consistency_defect",
    "discrete_legendre",
    "discretize",
    "initial_state",
    "moser_veselov_displacement",
]
