"""The discrete mechanics: discretisations, the discrete Legendre transformation, the step and its start."""

from nonholo.discrete._branch_tree import BranchTree, branch_tree
from nonholo.discrete._branch_values import Branches
from nonholo.discrete._branches import branches, displacements_over, fold_distance, inverse_discrete_legendre
from nonholo.discrete._consistency import consistency_defect
from nonholo.discrete._discrete_legendre import discrete_legendre
from nonholo.discrete._discretization import Discretization, as_discretization, discretize
from nonholo.discrete._legendre import legendre
from nonholo.discrete._moser_veselov import moser_veselov_displacement
from nonholo.discrete._reversal import reversal_defects
from nonholo.discrete._start import initial_state
from nonholo.discrete.routes import AbstractCompiledRoute

__all__ = [
    "AbstractCompiledRoute",
    "BranchTree",
    "Branches",
    "Discretization",
    "as_discretization",
    "branch_tree",
    "branches",
    "consistency_defect",
    "discrete_legendre",
    "discretize",
    "displacements_over",
    "fold_distance",
    "initial_state",
    "inverse_discrete_legendre",
    "legendre",
    "moser_veselov_displacement",
    "reversal_defects",
]
