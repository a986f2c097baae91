"""The continuous mechanics: vector field, forces of constraint, closed-form solutions, numerical integration."""

from nonholo.continuous._equations import ContinuousFlow, vector_field
from nonholo.continuous._series import Problem, Solved, States, flow_tangents
from nonholo.continuous._solvers import Solver, has_series, members_by_series, solver_of
