"""What a run of the discrete map is: its start, its limits, its compiled step, and runs without one."""

from nonholo.simulation.runs._by_rule import Run, rule_runner
from nonholo.simulation.runs._compiled import CompiledRun, closed_step, compiled_run, opened
from nonholo.simulation.runs._composed import composed_runner
from nonholo.simulation.runs._prepared import Start, checked_counts, first_state, refuse_too_large, refuse_too_long

__all__ = [
    "CompiledRun",
    "Run",
    "Start",
    "checked_counts",
    "closed_step",
    "compiled_run",
    "composed_runner",
    "first_state",
    "opened",
    "refuse_too_large",
    "refuse_too_long",
    "rule_runner",
]
