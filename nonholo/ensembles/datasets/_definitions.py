r"""The data sets: a system, a box of first configurations, weights of first momenta, a range of energies.

A first momentum is $p = s\,D u$ with u uniform on the unit sphere and D the diagonal matrix of the weights; s gives the
kinetic energy that is drawn.
"""

import dataclasses
import functools
import importlib
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from nonholo import io
from nonholo.discrete import discretize
from nonholo.ensembles._block import MemberBlock
from nonholo.ensembles._names import OUTCOME
from nonholo.ensembles.designs import AbstractDistribution, Direction, Normal, Uniform
from nonholo.simulation import flow, simulate
from nonholo.systems import ChaplyginSleigh, MultidimensionalSleigh, SuslovTop, VeselovaTop

_TENSOR = [[1.4, 0.2, 0.5, 0.1], [0.2, 1.0, -0.3, 0.2], [0.5, -0.3, 0.9, 0.1], [0.1, 0.2, 0.1, 0.8]]
_DIAGONAL, _CENTER = [0.6, 0.4, 0.2, 0.3], (0.5, 0.2, 0.1, -0.1)
_BODIES = {
    "top": lambda: SuslovTop(np.array(_TENSOR)[:3, :3]),
    "top_so4": lambda: SuslovTop(_TENSOR),
    "veselova": lambda: VeselovaTop(np.array(_TENSOR)[:3, :3]),
    "sleigh": lambda: ChaplyginSleigh(1.0, 1.0, a=0.5, b=0.3),
    "sleigh_se3": lambda: MultidimensionalSleigh(1.0, _CENTER[:3], np.diag(_DIAGONAL[:3])),
    "sleigh_se4": lambda: MultidimensionalSleigh(1.0, _CENTER, np.diag(_DIAGONAL)),
}


class Definition(NamedTuple):
    """A data set.

    Attributes:
        title: The system.
        weights: Of the components of first momenta: of those along the constraint of bodies, else of all.
        spread: Half the edges of the box of first configurations: coordinates, or of a pose the coordinates of
            its logarithm. None for the identity: the body moves alike from every pose.
        center: The middle of the box.
        energy: The range of first kinetic energies, which are uniform.
        version: Another one wherever the same call gives other numbers.
    """

    title: str
    weights: tuple[float, ...]
    spread: tuple[float, ...] | None = None
    center: tuple[float, ...] | float = 0.0
    energy: tuple[float, float] = (0.2, 1.0)
    version: int = 1

    @property
    def distributions(self) -> dict[str, AbstractDistribution]:
        """The random quantities of each orbit, by name."""
        draws: dict[str, AbstractDistribution] = {"start_energy": Uniform(*self.energy)}
        draws["start_direction"] = Direction(len(self.weights))
        if self.spread is not None:
            half = np.array(self.spread)
            draws["start_configuration"] = Uniform(self.center - half, self.center + half)
        return draws


_TURN, _PLANE, _PI = (2.0, 2.0, 2.0), (1.0, 1.0, np.pi), np.pi
DEFINITIONS = {
    "top": Definition("Suslov top", (1.0, 1.0)),
    "top_so4": Definition("Suslov top on SO(4)", (1.0, 1.0, 1.0)),
    "veselova": Definition("Veselova top", (1.0, 1.0), _TURN),
    "sleigh": Definition("Chaplygin sleigh", (1.0, 1.0)),
    "sleigh_se3": Definition("Sleigh in space", (1.0, 1.0, 1.0)),
    "sleigh_se4": Definition("Sleigh on SE(4)", (1.0, 1.0, 1.0, 1.0)),
    "chaotic_quartic_oscillator": Definition("Chaotic quartic oscillator", 7 * (1.0,), 7 * (0.5,)),
    "chaplygin_ball": Definition("Chaplygin ball", 6 * (1.0,), (*_TURN, 0.0, 0.0, 0.0)),
    "driven_sleigh": Definition("Sleigh driven by a moving mass", (1.0, 1.0, 1.0, 0.0), (*_PLANE, 0.0)),
    "heavy_suslov_top": Definition("Suslov top in a quadratic potential", (1.0, 1.0), _TURN),
    "kinematic_car": Definition("Kinematic car", (1.0, 1.0, 1.0, 1.0, 1e-4), (*_PLANE, _PI, 0.4)),
    "knife_edge_on_incline": Definition("Knife edge on an incline", (1.0, 1.0, 1.0), _PLANE),
    "non_reversible": Definition("Oscillators in a gearbox", (1.0, 1.0, 1.0), _PLANE, energy=(0.2, 3.0)),
    "particle": Definition("Nonholonomic particle", (1.0, 1.0, 1.0), (1.0, 1.0, 1.0)),
    "roller_racer": Definition("Roller racer", (1.0, 1.0, 1.0, 0.0), (*_PLANE, 0.0)),
    "rolling_disk": Definition("Rolling disk", (1.0, 1.0, 1.0, 1.0), (*_PLANE, _PI)),
    "sleigh_in_a_well": Definition("Sleigh on a spring", (1.0, 1.0), (_PI, 1.0, 1.0)),
    "snakeboard": Definition(
        "Snakeboard", (1.0, 1.0, 1.0, 1.0, 1e-4), (*_PLANE, _PI, 0.3), center=(0.0, 0.0, 0.0, 0.0, 1.0), version=2
    ),
    "twistcar": Definition("Twistcar", (1.0, 1.0, 1.0, 0.0), (*_PLANE, 0.0)),
    "two_wheeled_robot": Definition("Robot with two wheels", 5 * (1.0,), (*_PLANE, _PI, _PI)),
}
"""Data sets by name: bodies, then `nonholo.examples`."""


def system_of(name: str) -> Any:
    """Return the system of a data set; one of `nonholo.examples` loads JAX."""
    if name in _BODIES:
        return _BODIES[name]()
    return getattr(importlib.import_module("nonholo.examples"), name)().system


SPLITS = ("train", "validation", "test")
_LEFT_OUT = {"displacement", "constraint_residual"}
_EXACT = {"time", "energy", "momentum", "restricted_momentum", "multipliers"}  # what no one observes
_NUMBERS, _MEMBERS = 1 << 21, 256  # at most in a block

_FLAGS = {
    "long_name": "part of the data set",
    "flag_values": list(range(len(SPLITS))),
    "flag_meanings": " ".join(SPLITS),
}

Field: TypeAlias = tuple[tuple[str, ...], np.ndarray, dict[str, Any]]


@dataclasses.dataclass(frozen=True)
class DatasetTask:
    """Run the orbits of a data set, and label them.

    Attributes:
        dataset: Its name.
        version: That of its definition.
        time_step: h.
        steps: Number of steps N; there are N + 1 states.
        noise: Standard deviation of what is added to each observed number; with 0 there are none.
        ends: The first orbit after each part of the split.
    """

    dataset: str
    version: int
    time_step: float
    steps: int
    noise: float
    ends: tuple[int, ...]

    def __call__(self, block: MemberBlock) -> dict[str, Any]:
        """Run some orbits."""
        each = [self._orbit({name: rows[member] for name, rows in block.items()}) for member in range(block.count)]
        fields = [_fields(orbit) for orbit in each]
        results: dict[str, Field] = {}
        for name, (axes, rows, labels) in fields[0].items():
            whole = np.full((block.count, self.steps + 1, *rows.shape[1:]), np.nan)
            for place, own in zip(whole, fields, strict=True):
                place[: len(own[name][1])] = own[name][1]
            results[name] = ("step", *axes), whole, labels
        results |= self._observations(block, results)
        for name in results.keys() - {"time"}:
            results[name][2]["coordinates"] = "time"  # as CF conventions name them
        return results | {
            OUTCOME: np.array([int(orbit.outcome) for orbit in each]),
            "split": ((), np.searchsorted(self.ends, block.index, side="right"), _FLAGS),
        }

    def _orbit(self, start: dict[str, np.ndarray]) -> Any:
        """Run the orbit of what is drawn."""
        system, definition = _system(self.dataset), DEFINITIONS[self.dataset]
        q = start.get("start_configuration")
        if q is not None and not getattr(system, "coordinates", ()):
            q = system.group.exp(q)

        def energy(momentum: np.ndarray) -> float:
            return flow(system, configuration=q, momentum=momentum, times=[0.0]).energy[0]

        p = np.array(definition.weights) * start["start_direction"]
        kinetic = (energy(p) + energy(-p)) / 2 - energy(0 * p)  # whatever the potential, and what drives it
        p *= np.sqrt(start["start_energy"] / kinetic)
        discrete = discretize(system, self.time_step)
        return simulate(discrete, configuration=q, momentum=p, steps=self.steps, throw=False)

    def _observations(self, block: MemberBlock, fields: dict[str, Field]) -> dict[str, Field]:
        """Return what can be observed with normal noise, which depends on nothing but `rng`, orbit and name."""
        observations: dict[str, Field] = {}
        for name in fields.keys() - _EXACT if self.noise else ():
            axes, rows, labels = fields[name]
            uniform = block.random(rows[0].size, f"noise {name}")
            noise = Normal(0.0, self.noise, size=rows[0].size).draw(uniform).reshape(rows.shape)
            meaning = f"{labels['long_name']}, with noise"
            observations[f"observed_{name}"] = axes, rows + noise, labels | {"long_name": meaning}
        return dict(sorted(observations.items()))

    @property
    def block(self) -> int:
        """Orbits of a block that make a good piece of work."""
        return max(1, min(_MEMBERS, _NUMBERS // (self.steps + 1) // 64))

    def check_design(self, names: list[str]) -> None:
        """Take the design of the definition."""

    def describe(self) -> dict[str, Any]:
        """Return the task as plain data."""
        return {"kind": type(self).__name__, **dataclasses.asdict(self)}


def dataset_task_from(entry: dict[str, Any]) -> DatasetTask:
    """Return the task of a description; refuse one of another version."""
    version = DEFINITIONS[entry["dataset"]].version if entry["dataset"] in DEFINITIONS else None
    if entry["version"] != version:
        raise ValueError(f"the data set {entry['dataset']!r} in version {entry['version']}, here {version}")
    fields: dict[str, Any] = {field.name: entry[field.name] for field in dataclasses.fields(DatasetTask)}
    fields["ends"] = tuple(fields["ends"])
    return DatasetTask(**fields)


@functools.cache
def _system(name: str) -> Any:
    return system_of(name)


def _fields(orbit: Any) -> dict[str, Field]:
    """Return what an orbit says of its states by name: poses as people know them, no impulse of the last state."""
    dataset = orbit.to_dataset()
    fields: dict[str, Field] = {}
    for name, variable in dataset.reset_coords("time").data_vars.items():
        names = {"components": list(orbit.coordinates)} if orbit.coordinates and "coordinate" in variable.dims else {}
        fields[str(name)] = tuple(map(str, variable.dims[1:])), variable.values, variable.attrs | names
    if not orbit.coordinates and "configuration" in fields:
        fields |= io.separate_variables(orbit.space, fields.pop("configuration")[1])
    labels = {"long_name": "impulses of constraint on the way to the next state"}
    fields["multipliers"] = ("constraint",), orbit.multipliers, labels
    return {name: (axes, rows, dict(labels)) for name, (axes, rows, labels) in fields.items() if name not in _LEFT_OUT}
