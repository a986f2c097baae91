"""The values of the multivalued map: their equations, how one is followed, rules that choose among them, their tree."""

from nonholo.discrete.branching._branches import branches, displacements_over, fold_distance, inverse_discrete_legendre
from nonholo.discrete.branching._equations import Frame, frame_of, has_frame
from nonholo.discrete.branching._growth import BranchGrowth, branch_growth
from nonholo.discrete.branching._rules import (
    PRINCIPAL,
    AbstractBranchRule,
    BranchRule,
    branch_rule,
    checked_rule,
    displacement_at,
)
from nonholo.discrete.branching._stepper import Place, RuleStepper, first_place, next_place
from nonholo.discrete.branching._tree import BranchTree, branch_tree
from nonholo.discrete.branching._values import Branches, Landscape, landscape
