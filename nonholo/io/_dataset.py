"""An orbit as a labelled `xarray.Dataset`: the compact arrays and, on request, the decoded ones."""

from typing import Any

import xarray

from nonholo.io._attributes import attributes
from nonholo.orbit import Orbit
from nonholo.systems import AbstractLRSystem

# name: dimensions after `step`, and what the numbers are
_COMPACT = {
    "time": ((), "time", "time unit"),
    "reduced_momentum": (("component",), "momentum along the constraint subspace, canonical frame", "momentum unit"),
    "cayley": (("chart",), "chart coordinates of the displacement, canonical frame", "1"),
    "pose": (("pose_component",), "compact pose, canonical frame", "1, lengths in length unit"),
    "turned": ((), "heading without ambiguity of full turns", "rad"),
    "energy": ((), "reduced constrained energy", "energy unit"),
}
_SPATIAL = {  # of a right-invariant constraint
    "reduced_momentum": "spatial momentum along the constraint subspace",
    "cayley": "chart coordinates of the spatial displacement",
}
_DECODED = {
    "momentum": (("coordinate",), "body momentum", "momentum unit"),
    "body_velocity": (("coordinate",), "body velocity", "1 / time unit"),
    "configuration": (("row", "column"), "pose as a matrix", "1"),
    "displacement": (("row", "column"), "displacement of one step as a matrix", "1"),
}


def orbit_to_dataset(orbit: Orbit, *, decoded: bool = False) -> xarray.Dataset:
    """Return an orbit as a labelled dataset, with everything in its attributes that is needed to rebuild it.

    Args:
        orbit: What to label.
        decoded: Also compute momenta, body velocities, poses and displacements as matrices, in the user's body frame.

    Example:
        >>> orbit = nh.simulate(nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1), body_velocity=(1, 0, 0), steps=3)
        >>> dict(orbit.to_dataset().sizes)
        {'step': 4, 'component': 2, 'chart': 2, 'pose_component': 4}
    """
    wanted = {
        name: entry for name, entry in (_COMPACT | (_DECODED if decoded else {})).items() if _is_known(orbit, name)
    }
    variables = {name: _variable(orbit, name, *entry) for name, entry in wanted.items()}
    return xarray.Dataset(variables, attrs=attributes(orbit)).set_coords("time")


def _is_known(orbit: Orbit, name: str) -> bool:
    """Tell whether an orbit has a quantity; with a right-invariant constraint most need the pose."""
    needs_pose, needs_step = {"pose", "configuration"}, {"cayley", "displacement"}
    if isinstance(orbit.system, AbstractLRSystem):
        needs_pose |= {"energy", "momentum", "body_velocity", "displacement"}
    if (name in needs_pose and orbit.pose is None) or (name in needs_step and orbit.cayley is None):
        return False
    return name != "turned" or orbit.turned is not None


def _variable(orbit: Orbit, name: str, dimensions: tuple[str, ...], meaning: str, units: str) -> tuple[Any, ...]:
    told = _SPATIAL.get(name, meaning) if isinstance(orbit.system, AbstractLRSystem) else meaning
    return ("step", *dimensions), getattr(orbit, name), {"long_name": told, "units": units}
