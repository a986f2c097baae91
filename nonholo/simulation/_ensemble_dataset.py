"""An ensemble as a labelled `xarray.Dataset`: what the io room writes of an orbit, with a leading member axis."""

from typing import Any

import xarray

from nonholo.io._attributes import attributes
from nonholo.io._dataset import _COMPACT, _SPATIAL
from nonholo.orbit import Orbit
from nonholo.simulation._ensemble_result import Ensemble
from nonholo.systems import AbstractLRSystem

_AXES = ("row", "column")  # of a parameter that is a matrix


def ensemble_to_dataset(ensemble: Ensemble) -> xarray.Dataset:
    """Return the compact states, energies, outcomes and parameters with dimensions `member` and `step`.

    The attributes are those of an orbit of the shared system; parameters that differ are variables of their names.
    """
    spatial = isinstance(ensemble.members.discrete.system, AbstractLRSystem)
    variables: dict[str, Any] = {}
    for name, (dimensions, meaning, units) in _COMPACT.items():
        if _is_known(ensemble, name, spatial):
            told = {"long_name": _SPATIAL.get(name, meaning) if spatial else meaning, "units": units}
            variables[name] = ("member", "step", *dimensions), getattr(ensemble, name), told
    variables["outcome"] = "member", ensemble.outcome, {"long_name": "how the member ended, a nonholo.Outcome"}
    variables["steps_done"] = "member", ensemble.steps_done, {"long_name": "good steps"}
    for name, values in ensemble.members.parameters.items():
        axes = _AXES[: values.ndim - 1] if values.ndim != 2 else (f"{name}_component",)
        variables[name] = ("member", *axes), values, {"long_name": "parameter of the member"}
    return xarray.Dataset(variables, attrs=_told(ensemble)).set_coords("time")


def _is_known(ensemble: Ensemble, name: str, spatial: bool) -> bool:
    needs_pose = name == "pose" or (spatial and name == "energy")
    return name != "turned" and not (needs_pose and ensemble.pose is None)


def _told(ensemble: Ensemble) -> dict[str, Any]:
    none = slice(0, 0)
    shared = Orbit(
        ensemble.members.discrete,
        ensemble.time[0, none],
        ensemble.reduced_momentum[0, none],
        ensemble.cayley[0, none],
        None,
        save_every=ensemble.save_every or ensemble.steps,
    )
    kept = attributes(shared)
    del kept["outcome"]
    return {**kept, "format": "nonholo.ensemble", "steps": ensemble.steps}
