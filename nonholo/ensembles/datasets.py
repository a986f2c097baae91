"""Data sets of orbits: their definitions, the task that runs them, and their record: the data card and tables."""

import dataclasses
import functools
import hashlib
import importlib
import inspect
import itertools
import json
import shlex
from collections.abc import Callable, Iterator
from importlib import resources
from pathlib import Path
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from nonholo import io
from nonholo.base.checks import error, shown, within_disk
from nonholo.discrete import discretize
from nonholo.ensembles._names import NO_NAME, OUTCOME, function_from, is_own
from nonholo.ensembles.designs import MemberBlock
from nonholo.ensembles.distributions import AbstractDistribution, Direction, Normal, Uniform
from nonholo.ensembles.stores import RAISED, SweepStore, standing_of
from nonholo.io.datasets import columns_of
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


Member: TypeAlias = tuple[Any, dict[str, Any]]
"""The system of an orbit, and how it starts: arguments of `simulate`."""


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

    time_step = 0.05
    starts = (
        "First kinetic energies are uniform in the range of the definition. First momenta are p = s D u: u is uniform "
        "on the unit sphere, D is diagonal with the weights of the definition, s gives the energy; only their action "
        "along the constraint counts. First configurations are uniform in a box with the given center and half edges: "
        "coordinates, of a pose those of its logarithm; a body that moves alike from every pose starts at the identity."
    )

    @property
    def distributions(self) -> dict[str, AbstractDistribution]:
        """The random quantities of each orbit, by name."""
        draws: dict[str, AbstractDistribution] = {"start_energy": Uniform(*self.energy)}
        draws["start_direction"] = Direction(len(self.weights))
        if self.spread is not None:
            half = np.array(self.spread)
            draws["start_configuration"] = Uniform(self.center - half, self.center + half)
        return draws

    def member(self, name: str, draws: dict[str, Any]) -> Member:
        """Return the system of a data set, and how an orbit starts."""
        system, q = system_of(name), draws.get("start_configuration")
        if q is not None and not getattr(system, "coordinates", ()):
            q = system.group.exp(q)

        def energy(momentum: np.ndarray) -> float:
            return flow(system, configuration=q, momentum=momentum, times=[0.0]).energy[0]

        p = np.array(self.weights) * draws["start_direction"]
        kinetic = (energy(p) + energy(-p)) / 2 - energy(0 * p)  # whatever the potential, and what drives it
        return system, {"configuration": q, "momentum": p * np.sqrt(draws["start_energy"] / kinetic)}


class Family(NamedTuple):
    """A data set of systems that a function makes with their starts, of which some arguments are drawn.

    Attributes:
        title: The systems.
        distributions: The random arguments, by name.
        time_step: That of `dataset`, by default.
        function: It returns an `nh.examples.Example`, or anything else with a `system`, a `configuration` and a
            `body_velocity`; None for that of `nonholo.examples` with the name of the data set.
        version: As that of a `Definition`; 0 of a function of the user's own, which has none.
    """

    title: str
    distributions: dict[str, AbstractDistribution]
    time_step: float = 0.05
    function: Callable[..., Any] | None = None
    version: int = 1

    starts = "Arguments of the function that makes systems with starts are drawn. The system above is the first one."

    def member(self, name: str, draws: dict[str, Any]) -> Member:
        """Return the system of an orbit, and how it starts."""
        ready = (self.function or getattr(importlib.import_module("nonholo.examples"), name))(**draws)
        return ready.system, {"configuration": ready.configuration, "body_velocity": ready.body_velocity}


def family_of(function: Callable[..., Any]) -> Family:
    """Return the data set of a function of the user's own: arguments whose default is a distribution are drawn."""
    arguments = inspect.signature(function).parameters.values()
    draws = {each.name: each.default for each in arguments if isinstance(each.default, AbstractDistribution)}
    if not draws:
        remedy = "Write def robot(speed=nh.Uniform(0.5, 1.0)): ..."
        got = f"{shown(function)}, which has none"
        raise error("dataset(name=...)", "have an argument whose default is a distribution", got, remedy)
    title, *_ = (inspect.getdoc(function) or function.__name__).splitlines()
    return Family(title.rstrip("."), draws, function=function, version=0)


_TURN, _PLANE, _PI = (2.0, 2.0, 2.0), (1.0, 1.0, np.pi), np.pi
_SLOW, _HALF = Uniform(-0.3, 0.3), Uniform([-0.5, -0.5], [0.5, 0.5])
DEFINITIONS: dict[str, Definition | Family] = {
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
    "ball_in_bowl": Family("Ball in a bowl", {"place": _HALF, "velocity": _HALF, "spin": Uniform(-3.0, 3.0)}),
    "ball_on_turntable": Family("Ball on a turntable", {"place": _HALF, "velocity": _HALF}),
    "bicycle": Family("Bicycle", {"speed": Uniform(4.4, 6.0), "lean_rate": _SLOW, "steer_rate": _SLOW}, 0.02),
    "rattleback": Family("Rattleback", {"spin": Uniform(-6.0, 6.0), "tilt": Uniform([-0.02] * 2, [0.02] * 2)}, 0.002),
    "snake": Family("Snake", {"joints": Uniform([0.4, -0.8], [0.8, -0.4]), "joint_rates": _HALF}),
    "tilting_disk": Family(
        "Tilting disk", {"turning": Uniform(-0.6, 0.6), "lean_rate": _SLOW, "rolling": Uniform(1.0, 2.0)}
    ),
    "trailers": Family("Tractor with trailers", {"place": _HALF, "speed": Uniform(0.5, 1.5), "turning": _SLOW}),
}
"""Data sets by name: bodies, then `nonholo.examples`."""


@functools.cache
def system_of(name: str) -> Any:
    """Return the system of a data set; one of `nonholo.examples` loads JAX."""
    if name in _BODIES:
        return _BODIES[name]()
    return getattr(importlib.import_module("nonholo.examples"), name)().system


SPLITS = ("train", "validation", "test")
_LEFT_OUT = {"displacement", "constraint_residual"}
_EXACT = {"time", "energy", "momentum", "restricted_momentum", "multipliers"}  # what no one observes
_NUMBERS, _MEMBERS = 1 << 21, 256  # at most in a block
_APART = ("title", "function")  # of a definition, what its record has elsewhere
_RUN = ("time_step", "steps", "noise", "ends")

_FLAGS: dict[str, Any] = {"long_name": "part of the data set", "flag_values": list(range(len(SPLITS)))}
_FLAGS |= {"flag_meanings": " ".join(SPLITS)}

Field: TypeAlias = tuple[tuple[str, ...], np.ndarray, dict[str, Any]]


@dataclasses.dataclass(frozen=True)
class DatasetTask:
    """Run the orbits of a data set, and label them.

    Attributes:
        dataset: Its name.
        definition: What is drawn, and what moves.
        time_step: h.
        steps: Number of steps N; there are N + 1 states.
        noise: Standard deviation of what is added to each observed number; with 0 there are none.
        ends: The first orbit after each part of the split.
    """

    dataset: str
    definition: Definition | Family
    time_step: float
    steps: int
    noise: float
    ends: tuple[int, ...]

    def __call__(self, block: MemberBlock) -> dict[str, Any]:
        """Run some orbits."""
        draws = ({name: rows[member] for name, rows in block.items()} for member in range(block.count))
        starts = (self.definition.member(self.dataset, own) for own in draws)
        run: Any = {"steps": self.steps, "throw": False}
        each = [simulate(discretize(system, self.time_step), **first, **run) for system, first in starts]
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

    def _observations(self, block: MemberBlock, fields: dict[str, Field]) -> dict[str, Field]:
        """Return what can be observed with normal noise, which depends on nothing but `rng`, orbit and name."""
        observations: dict[str, Field] = {}
        for name in sorted(fields.keys() - _EXACT) if self.noise else ():
            axes, rows, labels = fields[name]
            uniform = block.random(rows[0].size, f"noise {name}")
            noise = Normal(0.0, self.noise, size=rows[0].size).draw(uniform).reshape(rows.shape)
            meaning = f"{labels['long_name']}, with noise"
            observations[f"observed_{name}"] = axes, rows + noise, labels | {"long_name": meaning}
        return observations

    @property
    def parts(self) -> dict[str, tuple[int, int]]:
        """The first orbit of each part of the split, and the first one after it."""
        return dict(zip(SPLITS, itertools.pairwise((0, *self.ends)), strict=True))

    @property
    def block(self) -> int:
        """Orbits of a block that make a good piece of work."""
        return max(1, min(_MEMBERS, _NUMBERS // (self.steps + 1) // 64))

    def check_design(self, names: list[str]) -> None:
        """Take the design of the definition; refuse a ready system whose extra is missing."""
        del names
        if not is_own(self.dataset):
            system_of(self.dataset)

    def describe(self) -> dict[str, Any]:
        """Return the task as plain data."""
        fields = {name: getattr(self, name) for name in ("dataset", *_RUN)}
        return {"kind": type(self).__name__, "version": self.definition.version, **fields}


def dataset_task_from(entry: dict[str, Any]) -> DatasetTask:
    """Return the task of a description; refuse one of another version."""
    name = entry["dataset"]
    run: dict[str, Any] = {field: entry[field] for field in _RUN} | {"ends": tuple(entry["ends"])}
    definition = family_of(function_from(name)) if is_own(name) else DEFINITIONS.get(name)
    if definition is None or entry["version"] != definition.version:
        here = definition and definition.version
        raise ValueError(f"the data set {name!r} in version {entry['version']}, here {here}")
    return DatasetTask(name, definition, **run)


def _fields(orbit: Any) -> dict[str, Field]:
    """Return what an orbit says of its states by name: poses as people know them, no impulse of the last state."""
    variables = io.datasets.variables_of(orbit).items()
    fields: dict[str, Field] = {name: (axes[1:], rows, labels) for name, (axes, rows, labels) in variables}
    labels = {"long_name": "impulses of constraint on the way to the next state"}
    fields["multipliers"] = ("constraint",), orbit.multipliers, labels
    return {name: (axes, rows, dict(labels)) for name, (axes, rows, labels) in fields.items() if name not in _LEFT_OUT}


def record_of(store: SweepStore, task: DatasetTask, file_format: str, license_name: str) -> dict[str, Any]:
    """Return the record of a data set whose store is finished."""
    definition, draws = task.definition, store.design.values(_first_that_ran(store), 1)
    first = {name: rows[0] for name, rows in draws.items()}
    kind, parameters = io.provenance.described_system(definition.member(task.dataset, first)[0])
    return {
        "name": task.dataset,
        "title": definition.title,
        "definition": {name: value for name, value in definition._asdict().items() if name not in _APART},
        "system": {"kind": kind, "parameters": parameters},
        "starts": definition.starts,
        "versions": json.loads(io.provenance.versions_text("scipy", "jax")),
        "command": _command(store, task, file_format, license_name),
        "rng": store.design.seed,
        "orbits": store.design.members,
        **{name: getattr(task, name) for name in ("steps", "time_step", "noise")},
        "split": {part: list(ends) for part, ends in task.parts.items()},
        "outcomes": standing_of(store.path).outcomes,
        "license": license_name,
        "format": file_format,
        "fields": {name: _field(store, name) for name in sorted(store.outputs)},
    }


def _first_that_ran(store: SweepStore) -> int:
    """Return the number of the first orbit whose system could be made."""
    pieces = map(store.layout.piece, range(store.layout.blocks))
    rows = ((piece.first, np.flatnonzero(store.rows(OUTCOME, piece) != RAISED)) for piece in pieces)
    return next(first + int(members[0]) for first, members in rows if members.size)


def _command(store: SweepStore, task: DatasetTask, file_format: str, license_name: str) -> str:
    """Return the command that writes it again."""
    if task.dataset == NO_NAME:
        return "the Python call nonholo.dataset"
    orbits = store.design.members
    split = "/".join(repr((end - begin) / orbits) for begin, end in task.parts.values())
    options = {"orbits": orbits, "steps": task.steps, "time-step": task.time_step, "rng": store.design.seed}
    options |= {"noise": task.noise, "split": split, "format": file_format, "license": license_name}
    module, _, name = task.dataset.rpartition(":")
    options |= {"module": f"{module}.py"} if module else {}
    words = [str(word) for name, value in options.items() for word in (f"--{name}", value)]
    return shlex.join(["nonholo", "dataset", name, "-o", store.path.parent.name, *words])


def _field(store: SweepStore, name: str) -> dict[str, Any]:
    """Return what a field is, and the SHA-256 of its numbers: little-endian, orbit by orbit."""
    output, digest = store.outputs[name], hashlib.sha256()
    little = np.dtype(output.dtype).newbyteorder("<")
    for block in range(store.layout.blocks):
        digest.update(np.ascontiguousarray(store.rows(name, store.layout.piece(block)), little).tobytes())
    attributes = {key: value for key, value in output.attributes.items() if key != "coordinates"}
    shape = [store.design.members, *output.shape]
    dimensions = ["member", *output.dimensions]
    return {"dimensions": dimensions, "shape": shape, "dtype": output.dtype, **attributes, "sha256": digest.hexdigest()}


def card(record: dict[str, Any]) -> str:
    """Return the data card, in Markdown."""
    rows = "\n".join(f"| `{name}` | {_row(each)} |" for name, each in record["fields"].items())
    parts = ", ".join(f"{part} {begin} to {end - 1}" for part, (begin, end) in record["split"].items() if begin < end)
    endings = ", ".join(f"{number} {outcome}" for outcome, number in record["outcomes"].items())
    definitions = "\n".join(f"- {name}: {value}" for name, value in record["definition"].items() if value is not None)
    parameters = "\n".join(f"- {name}: {value}" for name, value in record["system"]["parameters"].items())
    loading = "\n    ".join(_LOADING[record["format"]]).format(record["split"]["train"][1])
    words = {"rows": rows, "parts": parts, "endings": endings, "definitions": definitions, "loading": loading}
    text = (resources.files("nonholo.ensembles") / "data_card.md").read_text("utf-8")
    return text.format(**record, **words, parameters=parameters)


def _row(field: dict[str, Any]) -> str:
    meaning = "; ".join(filter(None, (field.get("long_name", ""), ", ".join(field.get("components", [])))))
    size = "x".join(map(str, field["shape"]))
    return " | ".join([", ".join(field["dimensions"]), size, meaning, field.get("units", "")])


_LOADING = {
    "zarr": ["import xarray", 'orbits = xarray.open_zarr("orbits.zarr")', "train = orbits.isel(member=slice(0, {}))"],
    "csv": ["import pandas", 'train = pandas.read_csv("train.csv")  # a row for each state: orbit, time, fields'],
}
_BYTES = 24.0  # of a number as text


def write_tables(store: SweepStore, folder: Path, parts: dict[str, tuple[int, int]]) -> None:
    """Write the orbits of a finished store, those of each part to a file: their number, the time, all that varies."""
    names = [name for name, each in store.outputs.items() if each.dimensions[:1] == ("step",)]
    names.sort(key=lambda name: name != "time")
    fields = [(name, store.outputs[name]) for name in names]
    columns = ["orbit", *(c for name, each in fields for c in columns_of(name, each.shape[1:], each.attributes))]
    states = store.outputs["time"].shape[0] * store.design.members
    within_disk("dataset(file_format='csv')", _BYTES * states * len(columns), folder, "Free space, then call it again.")
    for part, (begin, end) in parts.items():
        if begin < end:
            with io.places.new_file(folder / f"{part}.csv", overwrite=True) as file:
                file.writelines(io.tables.table_lines(columns, _rows(store, names, begin, end)))


def _rows(store: SweepStore, names: list[str], begin: int, end: int) -> Iterator[list[np.ndarray]]:
    """Give the columns of the states of some orbits, block by block; rows after the end of an orbit are left out."""
    for block in range(store.layout.blocks):
        piece = store.layout.piece(block)
        members = np.arange(piece.first, piece.first + piece.count)
        if not (is_within := (members >= begin) & (members < end)).any():
            continue
        fields = [store.rows(name, piece)[is_within] for name in names]
        states = np.concatenate([each.reshape(*each.shape[:2], -1) for each in fields], axis=2)
        is_state = np.isfinite(states[..., 0])
        yield [np.broadcast_to(members[is_within, None], is_state.shape)[is_state], *states[is_state].T]
