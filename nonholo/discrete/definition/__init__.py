"""The map by its definition, in JAX: derivatives of the discrete Lagrangian, roots, runs. Imported on first use."""

from nonholo.discrete.definition._nodes import free_rows, step_residual
from nonholo.discrete.definition._precision import allow_float32, doubled, in_double
from nonholo.discrete.definition._principal import ON_LOCUS, principal_of, traceable
from nonholo.discrete.definition._rollout import Rollout, rolled
from nonholo.discrete.definition._step import (
    displaced,
    is_even,
    map_each,
    momenta_by_derivative,
    momentum_of,
    nearest_displacement,
    next_charts_by_definition,
    sample_displacements,
    value_and_slope,
)
from nonholo.discrete.definition._stepper import DefinitionStepper, parts_by_definition, whole_steps_by_definition
