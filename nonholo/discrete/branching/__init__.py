"""The values of the multivalued map: their equations, how one is followed, rules that choose among them, their tree."""

from nonholo.discrete.branching._equations import frame_of, has_frame
from nonholo.discrete.branching._growth import BranchGrowth, BranchTree, branch_growth, branch_tree
from nonholo.discrete.branching._rules import PRINCIPAL, BranchRule, RuleStepper, checked_rule, step_by_rule
from nonholo.discrete.branching._values import (
    Branches,
    Landscape,
    branches,
    displacements_over,
    fold_distance,
    inverse_discrete_legendre,
    landscape,
)
