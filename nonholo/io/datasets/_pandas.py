"""An orbit as a table: what its dataset tells, one column for each number, times as the index."""

from typing import Any

import numpy as np
import xarray

from nonholo.groups import AbstractMatrixGroup
from nonholo.io.datasets._pose_variables import separate_variables
from nonholo.orbit import AbstractOrbit

_PARTS = {"quaternion": tuple("wxyz")}


def orbit_to_pandas(orbit: AbstractOrbit) -> Any:
    """Return an orbit as a `pandas.DataFrame` in the user's body frame, indexed by time.

    Columns are the variables of `orbit_to_dataset`; those of several numbers have their numbers in the name, from 0 on,
    quaternions the letters w, x, y, z. Coordinates of a Lagrange-d'Alembert system have their names, such as `x`; what
    belongs to one has its name too, such as `momentum_x`.

    Example:
        >>> orbit = nh.simulate(nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1), body_velocity=(1, 0, 0), steps=3)
        >>> table = orbit.to_pandas()
        >>> table.shape, list(table.columns[-5:])
        ((4, 12), ['momentum_1', 'momentum_2', 'x', 'y', 'heading'])
    """
    columns: dict[str, tuple[str, np.ndarray]] = {}
    dataset = orbit.to_dataset()
    if not orbit.coordinates and "configuration" in dataset:
        dataset = _with_named_poses(dataset, orbit.space, orbit.configuration)
    for name, variable in dataset.data_vars.items():
        labels = [_labels(dataset, str(name), axis) for axis in variable.dims[1:]]
        for place in np.ndindex(variable.shape[1:]):
            parts = [str(words[i]) for words, i in zip(labels, place, strict=True)]
            whole = parts if name == "configuration" and "coordinate" in variable.dims else [str(name), *parts]
            columns["_".join(whole)] = "time", variable.values[:, *place]
    return xarray.Dataset(columns, coords={"time": orbit.time}).to_dataframe()


def _labels(dataset: xarray.Dataset, name: str, axis: Any) -> Any:
    """Return what the numbers along an axis are called: their names, or from 0 on."""
    return dataset.coords[axis].values if axis in dataset.coords else _PARTS.get(name, range(dataset.sizes[axis]))


def _with_named_poses(dataset: xarray.Dataset, group: AbstractMatrixGroup, g: np.ndarray) -> xarray.Dataset:
    """Replace matrices by what people know: positions, headings, quaternions."""
    posed = {name: (("step", *axes), rows) for name, (axes, rows, _) in separate_variables(group, g).items()}
    return dataset.drop_vars(["configuration", "displacement"], errors="ignore").assign(posed)
