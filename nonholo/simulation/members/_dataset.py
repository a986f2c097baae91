"""An ensemble as a labeled `xarray.Dataset`: what the io room writes of an orbit, with a leading member axis."""

from typing import Any

import numpy as np
import xarray

from nonholo import io
from nonholo.orbit import Orbit
from nonholo.simulation.members._result import Ensemble

_EACH = ("member", "step")
_AXES = ("row", "column")  # of a parameter that is a matrix


def ensemble_to_dataset(ensemble: Ensemble) -> xarray.Dataset:
    """Return what `orbit_to_dataset` tells of an orbit, with dimensions `member` and `step`, outcomes and parameters.

    Body velocities and momenta, which are decoded member by member where parameters differ, are left out. The
    attributes are those of an orbit of the shared system; parameters that differ are variables of their names.
    """
    members = ensemble.members
    system, posed = members.discrete.system, ensemble.canonical_pose is not None
    variables: dict[str, Any] = {"time": (_EACH, ensemble.time, {"long_name": "time", "units": "time unit"})}
    for name in ("energy", "restricted_momentum"):
        if io.is_known(system, name, posed=posed, discrete=True):
            axes, labels = io.labels_of(system, name)
            variables[name] = (*_EACH, *axes), getattr(ensemble, name), labels
    if posed:
        poses = io.separate_variables(system.group, ensemble.configuration)
        variables |= {name: ((*_EACH, *axes), values, labels) for name, (axes, values, labels) in poses.items()}
    variables["outcome"] = "member", ensemble.outcome, {"long_name": "how the member ended, a nonholo.Outcome"}
    variables["steps_done"] = "member", ensemble.steps_done, {"long_name": "good steps"}
    for name, values in members.parameters.items():
        axes = _AXES[: values.ndim - 1] if values.ndim != 2 else (f"{name}_component",)
        variables[name] = ("member", *axes), values, {"long_name": "parameter of the member"}
    numbered = {} if ensemble.save_every is None else {"step": ensemble.save_every * np.arange(ensemble.time.shape[1])}
    return xarray.Dataset(variables, numbered, _attributes(ensemble)).set_coords("time")


def _attributes(ensemble: Ensemble) -> dict[str, Any]:
    none = slice(0, 0)
    shared = Orbit(
        ensemble.members.discrete,
        ensemble.time[0, none],
        ensemble.reduced_momentum[0, none],
        ensemble.cayley[0, none],
        None,
        save_every=ensemble.save_every or ensemble.steps,
    )
    kept = io.attributes(shared)
    del kept["outcome"]
    return {**kept, "format": "nonholo.ensemble", "steps": ensemble.steps}
