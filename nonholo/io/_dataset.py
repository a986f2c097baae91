"""An orbit as a labelled `xarray.Dataset`: the compact arrays and, on request, the decoded ones."""

from typing import Any

import xarray

from nonholo.io._attributes import attributes
from nonholo.orbit import Orbit

# name: dimensions after `step`, and what the numbers are
_COMPACT = {
    "time": ((), "time", "time unit"),
    "reduced_momentum": (("component",), "momentum along the constraint subspace, canonical frame", "momentum unit"),
    "cayley": (("component",), "Cayley coordinates of the displacement, canonical frame", "1"),
    "pose": (("pose_component",), "compact pose, canonical frame", "1, lengths in length unit"),
    "turned": ((), "heading without ambiguity of full turns", "rad"),
    "energy": ((), "reduced constrained energy", "energy unit"),
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
        {'step': 4, 'component': 2, 'pose_component': 4}
    """
    wanted = _COMPACT | _DECODED if decoded else _COMPACT
    if decoded and orbit.pose is None:
        wanted = {name: entry for name, entry in wanted.items() if name != "configuration"}
    if decoded and orbit.cayley is None:
        wanted = {name: entry for name, entry in wanted.items() if name != "displacement"}
    variables = {name: _variable(orbit, name, *entry) for name, entry in wanted.items()}
    present = {name: variable for name, variable in variables.items() if variable is not None}
    return xarray.Dataset(present, attrs=attributes(orbit)).set_coords("time")


def _variable(orbit: Orbit, name: str, dimensions: tuple[str, ...], meaning: str, units: str) -> Any:
    rows = getattr(orbit, name)
    return None if rows is None else (("step", *dimensions), rows, {"long_name": meaning, "units": units})
