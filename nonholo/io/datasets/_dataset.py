"""An orbit as labeled data in the user's body frame, and the variables of its store, compact states beside it."""

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import xarray

from nonholo.base.types import Float
from nonholo.discrete import Discretization
from nonholo.groups import AbstractMatrixGroup
from nonholo.io._attributes import attributes
from nonholo.io.datasets._pose_variables import pose_variables, separate_variables
from nonholo.orbit import STATES, AbstractOrbit, Orbit
from nonholo.systems import System

if TYPE_CHECKING:
    import xarray


class Variable(NamedTuple):
    """An array with the names of its dimensions, and its attributes: xarray takes it as it is.

    Attributes:
        dims: Names.
        values: Numbers.
        attrs: Texts by name.
    """

    dims: tuple[str, ...]
    values: np.ndarray
    attrs: dict[str, Any]

    @property
    def shape(self) -> tuple[int, ...]:
        """The shape of the array."""
        return self.values.shape


CANONICAL = "canonical/"
"""The group of a store that holds compact states."""
STEP = CANONICAL + "step"
"""The numbers of steps in a store, where they do not follow from the places of its rows."""
_MOST = 1000  # components of a momentum, or numbers of a pose, that are reported
HEADED = ("heading", "quaternion")  # whose rows continue from the row before

# name: dimensions after `step`, and what the numbers are
_COMPACT = {
    "reduced_momentum": (("component",), "momentum along the constraint subspace, canonical frame", "momentum unit"),
    "cayley": (("chart",), "chart coordinates of the displacement, canonical frame", "1"),
    "pose": (("pose_component",), "compact pose, canonical frame", "1, lengths in length unit"),
    "turned": ((), "heading without ambiguity of full turns", "rad"),
}
_KNOWN = {
    "energy": ((), "reduced constrained energy", "energy unit"),
    "restricted_momentum": (("component",), "momentum along the rows of the constraint subspace", "momentum unit"),
    "body_velocity": (("coordinate",), "body velocity", "1 / time unit"),
    "momentum": (("coordinate",), "body momentum", "momentum unit"),
}
_STORED = ("energy", "restricted_momentum")
_MATRICES = {
    "configuration": (("row", "column"), "pose as a matrix", "1"),
    "displacement": (("row", "column"), "displacement of one step as a matrix", "1"),
}
_MULTIPLIERS = "multipliers: forces of a flow, impulses to the next state of a discrete orbit"
_OTHERS = {
    "time": ((), "time", "time unit"),
    "multipliers": (("multiplier",), _MULTIPLIERS, "force unit, or times time"),
}
_LABELS = _COMPACT | _KNOWN | _MATRICES | _OTHERS
_SPATIAL = {  # of a right-invariant constraint
    "reduced_momentum": "spatial momentum along the constraint subspace",
    "restricted_momentum": "spatial momentum along the rows of the constraint subspace",
    "cayley": "chart coordinates of the spatial displacement",
}


def orbit_to_dataset(orbit: Orbit, *, decoded: bool = False) -> "xarray.Dataset":
    r"""Return an orbit as a labeled dataset in the user's body frame; attributes describe its making.

    Variables along `step`, whose coordinate is the number of the step, with the coordinate `time`: `energy`,
    `restricted_momentum`, `body_velocity`, `momentum` and the pose.

    | group | the pose |
    |---|---|
    | SE(2) | `x`, `y`, `heading` |
    | SO(3), SE(3) | `quaternion`: w, x, y, z, unit, signs continuous; on SE(3) also `x`, `y`, `z` |
    | SO(n), SE(n) | `rotation`, a matrix; on SE(n) also `position` |
    | translations | `position` |
    | products | those of the factors, translations as `shape` |
    | other groups | `configuration`, a matrix |

    Quantities that the orbit does not have, or that are too large in many dimensions, are left out.

    Args:
        orbit: The orbit to label.
        decoded: Also poses and displacements as matrices, and `multipliers` of an orbit of which every step is saved,
            NaN after the last state of a discrete one.

    Example:
        >>> orbit = nh.simulate(nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1), body_velocity=(1, 0, 0), steps=3)
        >>> list(orbit.to_dataset().data_vars)
        ['energy', 'restricted_momentum', 'body_velocity', 'momentum', 'x', 'y', 'heading']
    """
    import xarray

    names = (*_KNOWN, *_MATRICES) if decoded else tuple(_KNOWN)
    states = {name: _variable(orbit, name) for name in names if _is_known(orbit, name)}
    columns = {"time": _variable(orbit, "time")} | states | _posed(orbit, None)
    if decoded and _has_multipliers(orbit):
        rows = orbit.multipliers
        missing = np.full((len(orbit) - len(rows), rows.shape[1]), np.nan)
        columns["multipliers"] = _variable(orbit, "multipliers", np.concatenate([rows, missing]))
    number = ("step", orbit.step, {"long_name": "number of the step", "units": "1"})
    return xarray.Dataset(columns, {"step": number}, attributes(orbit)).set_coords("time").copy(deep=True)


def stored_variables(orbit: Any, before: Float[np.ndarray, "1 c"] | None = None) -> dict[str, Variable]:
    """Return the arrays of a store by name: what a person knows, and compact states in a separate group.

    Args:
        orbit: An orbit or a block of one.
        before: The heading or the quaternion of the state before the first one, in a row.
    """
    if not orbit.is_compact:
        return _variables(orbit)
    compact = {
        CANONICAL + name: _variable(orbit, name, getattr(orbit, state))
        for name, state in zip(_COMPACT, STATES[1:], strict=True)
        if getattr(orbit, state) is not None
    }
    states = {name: _variable(orbit, name) for name in _STORED if _is_known(orbit, name)} | _posed(orbit, before)
    for variable in states.values():
        variable.attrs["coordinates"] = "time"  # those of the group canonical need none
    return {"time": _variable(orbit, "time")} | states | compact


def steps_apart(orbit: Any) -> dict[str, Variable]:
    """Return the array of the steps of an orbit that is not a whole run; empty of one that is."""
    if np.array_equal(orbit.step, orbit.save_every * np.arange(len(orbit))):
        return {}
    return {STEP: Variable(("step",), orbit.step, {"long_name": "number of the step"})}


def _variables(orbit: Any) -> dict[str, Variable]:
    """Return what an orbit tells, but for empty rows; names along axes are texts, which are attributes of a store."""
    dataset = orbit.to_dataset()
    for variable in dataset.data_vars.values():
        own_labels = {"components": list(orbit.coordinates)} if "coordinate" in variable.dims else {}
        variable.attrs |= {"coordinates": "time"} | own_labels
    variables = {
        str(name): Variable(tuple(map(str, each.dims)), each.values, each.attrs)
        for name, each in dataset.reset_coords("time").data_vars.items()
    }
    return {name: each for name, each in variables.items() if 0 not in each.shape[1:]}


def is_known(system: System, name: str, *, posed: bool, discrete: bool) -> bool:
    """Return whether motions of a system have a quantity; with a right-invariant constraint most need the pose."""
    needs_pose = {"configuration"}
    if system.is_spatial:
        needs_pose |= {"energy", "momentum", "body_velocity", "displacement"}
    if (name in needs_pose and not posed) or (name == "displacement" and not discrete):
        return False
    return name in _STORED or system.group.dim <= _MOST


def labels_of(system: System, name: str) -> tuple[tuple[str, ...], dict[str, str]]:
    """Return the dimensions of a quantity after those of the states, and its attributes."""
    axes, meaning, units = _LABELS[name]
    long_name = _SPATIAL.get(name, meaning) if system.is_spatial else meaning
    return axes, {"long_name": long_name, "units": units}


def _is_known(orbit: Orbit, name: str) -> bool:
    return is_known(orbit.system, name, posed=orbit.canonical_pose is not None, discrete=orbit.cayley is not None)


def _posed(orbit: Orbit, before: np.ndarray | None) -> dict[str, Variable]:
    if orbit.canonical_pose is None or orbit.canonical_pose.shape[1] > _MOST:
        return {}
    variables = pose_variables(orbit, before).items()
    return {name: Variable(("step", *axes), values, dict(labels)) for name, (axes, values, labels) in variables}


def _has_multipliers(orbit: Orbit) -> bool:
    """Return whether an orbit has multipliers that need no other steps than those of its states."""
    motion = orbit.motion
    single = not isinstance(motion, Discretization) or (motion.order == 2 and orbit.has_every_step)
    return single and not motion.is_measured and len(orbit) > 0 and _is_known(orbit, "momentum")


def _variable(orbit: Orbit, name: str, values: np.ndarray | None = None) -> Variable:
    axes, labels = labels_of(orbit.system, name)
    return Variable(("step", *axes), getattr(orbit, name) if values is None else values, labels)


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
