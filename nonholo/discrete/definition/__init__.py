"""The map by its definition, in JAX: derivatives of the discrete Lagrangian, roots, runs. Imported on first use."""

from nonholo.discrete._scheme import free_rows
from nonholo.discrete.definition._rollout import Rollout, roll_out, step_residual, step_slopes
from nonholo.discrete.definition._step import (
    allow_float32,
    compile_double,
    in_double,
    map_each,
    momenta_by_derivative,
    sample_displacements,
    trace,
    traceable,
)
from nonholo.discrete.definition._stepper import DefinitionStepper, leap, next_charts, step, whole_steps_by_definition
