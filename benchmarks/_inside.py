"""The parts of the library, not public, that the scripts measure: this file alone names them.

They are imported on first use, so that a script that measures memory loads nothing that it does not need.
"""

import importlib
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

import nonholo as nh

HOMES = {
    "AbstractSystem": "nonholo.systems",
    "Branches": "nonholo.discrete",
    "Gaps": "nonholo.analysis.steering._shooting",
    "REDUCTIONS": "nonholo.ensembles",
    "ROWS": "nonholo.lagrange_dalembert.functions",
    "accelerations": "",  # of the tests
    "advance": "nonholo.lagrange_dalembert.compiled",
    "best": "nonholo.analysis.steering._shooting",
    "correction": "nonholo.kernels._scalar",
    "Expansion": "nonholo.lagrange_dalembert.compiled._expansion",
    "enclosures": "nonholo.discrete.certificate._certificate",
    "flow_by_diffrax": "nonholo.lagrange_dalembert._integration:flow",
    "flow_by_series": "nonholo.lagrange_dalembert.compiled._flow:flow",
    "frame_of": "nonholo.discrete.branching._equations",
    "in_double": "nonholo.discrete.definition",
    "in_one_thread": "nonholo.simulation",
    "kernels": "nonholo",
    "loop_in_jax": "nonholo.lagrange_dalembert._discretization:_advance",
    "in_double_precision": "nonholo.lagrange_dalembert.functions:in_double",
    "locate": "nonholo.discrete.certificate._certificate",
    "Located": "nonholo.discrete.certificate._certificate",
    "problem_of": "nonholo.discrete.certificate._roots",
    "published": "",  # of the tests
    "transcription": "nonholo.analysis.steering:_transcription",
}


def __getattr__(name: str) -> Any:
    if name not in HOMES:
        raise AttributeError(name)
    if not HOMES[name]:
        sys.path.append(str(Path(__file__).parents[1] / "tests"))
        return importlib.import_module(name)
    module, _, other = HOMES[name].partition(":")
    importlib.import_module(f"{module}.{other or name}") if (other or name) in ("kernels", "_transcription") else None
    return getattr(importlib.import_module(module), other or name)


def integration(system: Any, times: np.ndarray, rtol: float, **start: Any) -> Callable[[], Any]:
    """Return the integration without the checks and the orbit of `nh.flow`."""
    from nonholo.continuous import Problem, solver_of

    first = nh.flow(system, times=times[:1], **start)
    solve, _ = solver_of(system, None, float(times[0]), reconstruct=True)
    return lambda: solve(Problem(first.reduced_momentum[0], first.canonical_pose[0], times, (rtol, 1e-12)))
