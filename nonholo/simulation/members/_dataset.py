"""An ensemble as a labeled `xarray.Dataset`: what the io room writes of an orbit, with a leading member axis."""

from typing import Any

import numpy as np
import xarray

from nonholo import io
from nonholo.simulation.members._result import Ensemble

_EACH = ("member", "step")
_AXES = ("row", "column")  # of a parameter that is a matrix


def ensemble_to_dataset(ensemble: Ensemble, none: Any) -> xarray.Dataset:
    """Return what the dataset of an orbit tells, with dimensions `member` and `step`, outcomes and parameters.

    Body velocities and momenta of bodies, which are decoded member by member where parameters differ, are left out. The
    attributes are those of an orbit of the shared motion; parameters that differ are variables of their names.

    Args:
        ensemble: The ensemble to label.
        none: No state of the shared motion, as an orbit.
    """
    variables = _in_coordinates(ensemble, none) if ensemble.members.in_coordinates else _of_bodies(ensemble)
    variables["time"] = _EACH, ensemble.time, {"long_name": "time", "units": "time unit"}
    variables["outcome"] = "member", ensemble.outcome, {"long_name": "how the member ended, a nonholo.Outcome"}
    variables["steps_done"] = "member", ensemble.steps_done, {"long_name": "good steps"}
    for name, values in ensemble.parameters.items():
        axes = _AXES[: values.ndim - 1] if values.ndim != 2 else (f"{name}_component",)
        variables[name] = ("member", *axes), values, {"long_name": "parameter of the member"}
    labels: dict[str, Any] = {"coordinate": np.array(none.coordinates, dtype=object)} if none.coordinates else {}
    if ensemble.save_every is not None:
        labels["step"] = ensemble.save_every * np.arange(ensemble.time.shape[1])
    common = io.provenance.attributes(none)
    del common["outcome"]
    attributes = {**common, "format": "nonholo.ensemble", "steps": ensemble.steps}
    return xarray.Dataset(variables, labels, attributes).set_coords("time")


def _of_bodies(ensemble: Ensemble) -> dict[str, Any]:
    """Return energies, momenta along the constraint and poses."""
    system, has_poses = ensemble.members.discrete.system, ensemble.canonical_pose is not None
    variables: dict[str, Any] = {}
    for name in ("energy", "restricted_momentum"):
        if io.datasets.is_known(system, name, posed=has_poses, discrete=True):
            axes, labels = io.datasets.labels_of(system, name)
            variables[name] = (*_EACH, *axes), getattr(ensemble, name), labels
    if has_poses:
        variables |= io.datasets.posed(system.group, ensemble.configuration, "member")
    return variables


def _in_coordinates(ensemble: Ensemble, none: Any) -> dict[str, Any]:
    """Return all that an orbit tells."""
    rows, variables = none.labeled_rows(), dict[str, Any]()
    for name, (axes, _, labels) in rows.items():
        variables[name] = (*_EACH, *axes), getattr(ensemble, name), labels
    if none.coordinates:
        return variables
    return io.datasets.with_own_axes(variables | io.datasets.posed(none.space, ensemble.configuration, "member"))
