"""The properties that groups, systems and discretizations must have, checked for ours and for users' own."""

from nonholo.testing._discretizations import check_discretization, check_order
from nonholo.testing._groups import check_group
from nonholo.testing._report import Report, Result
from nonholo.testing._systems import check_system

__all__ = ["Report", "Result", "check_discretization", "check_group", "check_order", "check_system"]
