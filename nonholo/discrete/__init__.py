"""The discrete mechanics: discretizations, the discrete Legendre transformation, the step and its start."""

from nonholo.discrete._decoder import momentum_slope, step_jacobians
from nonholo.discrete._discretization import Discretization, as_discretization, check_first_state
from nonholo.discrete._discretize import consistency_defect, discrete_legendre, discretize, moser_veselov_displacement
from nonholo.discrete._measured import MeasuredMotion, orbit_of_poses
from nonholo.discrete._scheme import legendre, refuse_composition, weights
from nonholo.discrete.branching import PRINCIPAL, Branches, BranchGrowth, BranchRule, BranchTree, branch_tree
from nonholo.discrete.routes import AbstractCompiledRoute, ScalarRoute, reversal_defects
