"""The discrete mechanics: discretisations, the discrete Legendre transformation, the step and its start."""

from nonholo.discrete._branch_equations import Frame, frame_of, has_frame
from nonholo.discrete._branch_rules import PRINCIPAL, AbstractBranchRule, BranchRule, checked_rule
from nonholo.discrete._branch_steps import Place, first_place, next_places
from nonholo.discrete._branch_tree import BranchTree, branch_tree
from nonholo.discrete._branch_values import Branches
from nonholo.discrete._branches import branches, displacements_over, fold_distance, inverse_discrete_legendre
from nonholo.discrete._composition import compiled_step, refuse_composition, weights
from nonholo.discrete._consistency import consistency_defect
from nonholo.discrete._discretization import Discretization, as_discretization, discretize
from nonholo.discrete._legendre import discrete_legendre, legendre
from nonholo.discrete._moser_veselov import moser_veselov_displacement
from nonholo.discrete._start import check_first_state, initial_state
from nonholo.discrete._structured import (
    Structured,
    decoded,
    decoded_poses,
    encoded,
    encoded_poses,
    from_kernel,
    is_secular,
    scalar_step,
    structured,
)

__all__ = [
    "PRINCIPAL",
    "AbstractBranchRule",
    "BranchRule",
    "BranchTree",
    "Branches",
    "Discretization",
    "Frame",
    "Place",
    "Structured",
    "as_discretization",
    "branch_tree",
    "branches",
    "check_first_state",
    "checked_rule",
    "compiled_step",
    "consistency_defect",
    "decoded",
    "decoded_poses",
    "discrete_legendre",
    "discretize",
    "displacements_over",
    "encoded",
    "encoded_poses",
    "first_place",
    "fold_distance",
    "frame_of",
    "from_kernel",
    "has_frame",
    "initial_state",
    "inverse_discrete_legendre",
    "is_secular",
    "legendre",
    "moser_veselov_displacement",
    "next_places",
    "refuse_composition",
    "scalar_step",
    "structured",
    "weights",
]
