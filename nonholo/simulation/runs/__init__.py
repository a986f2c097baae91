"""Runs of the discrete map: their options and limits, first states, compiled steps, runs without one."""

from nonholo.simulation.runs._compiled import CompiledRun, closed_step, compiled_run, opened
from nonholo.simulation.runs._first_state import FirstState, first_state
from nonholo.simulation.runs._limits import refuse_many_matrices, refuse_too_large, refuse_too_long
from nonholo.simulation.runs._options import RunOptions, check_forces
from nonholo.simulation.runs._state import Rows, RunState
from nonholo.simulation.runs._uncompiled import Runner, uncompiled_run

__all__ = [
    "CompiledRun",
    "FirstState",
    "Rows",
    "RunOptions",
    "RunState",
    "Runner",
    "check_forces",
    "closed_step",
    "compiled_run",
    "first_state",
    "opened",
    "refuse_many_matrices",
    "refuse_too_large",
    "refuse_too_long",
    "uncompiled_run",
]
