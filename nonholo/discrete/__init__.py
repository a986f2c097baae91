"""The discrete mechanics: discretisations, the discrete Legendre transformation, the step and its start."""

from nonholo.discrete._discretization import Discretization, discretize
from nonholo.discrete._legendre import discrete_legendre
from nonholo.discrete._start import initial_state

__all__ = ["Discretization", "discrete_legendre", "discretize", "initial_state"]
