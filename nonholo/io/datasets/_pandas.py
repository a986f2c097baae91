"""An orbit as a table: what its dataset tells, one column for each number, times as the index."""

from typing import Any

import numpy as np
import xarray

from nonholo.io.datasets._dataset import orbit_to_dataset
from nonholo.orbit import Orbit

_PARTS = {"quaternion": "wxyz"}


def orbit_to_pandas(orbit: Orbit) -> Any:
    """Return an orbit as a `pandas.DataFrame` in the user's body frame, indexed by time.

    Columns are the variables of `orbit_to_dataset`; those of several numbers have their numbers in the name, from 0 on,
    quaternions the letters w, x, y, z.

    Example:
        >>> orbit = nh.simulate(nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1), body_velocity=(1, 0, 0), steps=3)
        >>> table = orbit.to_pandas()
        >>> table.shape, list(table.columns[-5:])
        ((4, 12), ['momentum_1', 'momentum_2', 'x', 'y', 'heading'])
    """
    columns: dict[str, tuple[str, np.ndarray]] = {}
    for name, variable in orbit_to_dataset(orbit).data_vars.items():
        for place in np.ndindex(variable.shape[1:]):
            parts = _PARTS[str(name)][place[0]] if name in _PARTS else "_".join(map(str, place))
            columns[f"{name}_{parts}" if place else str(name)] = "time", variable.values[:, *place]
    return xarray.Dataset(columns, coords={"time": orbit.time}).to_dataframe()
