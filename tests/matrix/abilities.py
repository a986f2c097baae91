"""The abilities: what can be done with a motion, each against the same value by another way."""

import base64
import dataclasses
import functools
import json
import pickle
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from matrix.kinds import STEPS
from matrix.ready import ALL
from plot.runs import frames_of
from stopping import stopped_at
from typer.testing import CliRunner

import nonholo as nh
from nonholo.cli.scenario.files import toml_text

ABILITIES: dict[str, Callable[["Case", Path], None]] = {}
_PARTS = {"checkpoint_every": 5}
_MEMBERS = np.array([0.8, 1.0, 1.1])


class Case:
    """A kind with its runs, each made once."""

    def __init__(self, name: str) -> None:
        self.name, self.kind = name, ALL[name]
        self.h = self.kind.time_step
        self.discrete = self.kind.discrete(self.h)
        self.system = self.discrete.system
        self.run = {} if self.kind.branch == "principal" else {"branch": self.kind.branch}
        self.known = {"discrete": self.discrete} if "function" in self.kind.traits else {}
        self.ready = self.kind.made()
        self.is_wide = "wide" in self.kind.traits
        self.kept = "restricted_momentum" if self.is_wide else "body_velocity"
        self.in_coordinates = "coordinates" in self.kind.traits
        if self.ready is None:
            self.start = {"restricted_velocity": 0.5 * np.cos(np.arange(self.system.rank)) / np.sqrt(self.system.rank)}
        else:
            self.start = {name: getattr(self.ready(), name) for name in ("configuration", "body_velocity")}

    def simulated(self, discrete: Any = None, steps: int = STEPS, **how: Any) -> Any:
        """Return a run of this kind."""
        return nh.simulate(discrete or self.discrete, steps=steps, **{**self.start, **self.run, **how})

    @functools.cached_property
    def orbit(self) -> Any:
        """The run of this kind."""
        return self.simulated()

    @functools.cached_property
    def halves(self) -> Any:
        """The run with half the time step."""
        return self.simulated(self.kind.discrete(self.h / 2), 2 * STEPS)

    @functools.cached_property
    def flow(self) -> Any:
        """The flow from the start at the times of the run."""
        return self.flown(self.h * np.arange(1 + STEPS))

    def flown(self, times: Any, **how: Any) -> Any:
        """Return the flow at times; of bodies in hundreds of dimensions without its poses."""
        how = {**self.start, **how}
        return nh.flow(self.system, times=times, **how, **({"reconstruct": False} if self.is_wide else {}))

    def seen(self, orbit: Any) -> np.ndarray:
        """Return what is compared: configurations; of bodies in hundreds of dimensions momenta along the constraint."""
        return orbit.restricted_momentum if self.is_wide else orbit.configuration.reshape(len(orbit), -1)

    def event(self, orbit: Any = None, name: str = "middle") -> tuple[Any, int]:
        """Return an event between two states in the middle of a motion, and how often the motion crosses."""
        flat = self.seen(self.orbit if orbit is None else orbit)
        entry, k = int(np.argmax(np.abs(flat[-1] - flat[0]))), STEPS // 2
        level = (flat[k, entry] + flat[k + 1, entry]) / 2
        event = nh.Event(lambda orbit: self.seen(orbit)[:, entry] - level, name=name)
        return event, int(np.count_nonzero(np.diff(flat[:, entry] > level)))

    @functools.cached_property
    def crossings(self) -> Any:
        """The crossings of the event in the run, which has the states of one without events."""
        watched = self.simulated(events=[self.event()[0]])
        assert_same(watched, self.orbit)
        return watched.events["middle"]

    @functools.cached_property
    def balance(self) -> np.ndarray:
        """The energy, under forces less their work and from its largest value on."""
        energy, work = self.orbit.energy, np.nan_to_num(self.orbit.known_work)
        return np.abs(energy).max() + energy - energy[0] - work if work.any() else energy

    @property
    def rows(self) -> dict[str, Any]:
        """Starts of members: of different velocities, or from other places, where velocities are prescribed."""
        name = "body_velocity" if self.ready else "restricted_velocity"
        if getattr(self.system, "prescribed", ()):
            q = self.start["configuration"]
            return self.start | {"configuration": q + np.outer(_MEMBERS - 1, np.eye(len(q))[0])}
        return self.start | {name: np.outer(_MEMBERS, self.start[name])}

    def alone(self, member: int) -> dict[str, Any]:
        """Return the start of a member."""
        return {
            name: value[member] if np.ndim(value) > np.ndim(self.start[name]) else value
            for name, value in self.rows.items()
        }


case = functools.lru_cache(maxsize=2)(Case)


def ability(check: Callable[[Case, Path], None]) -> Callable[[Case, Path], None]:
    """Add a check to the abilities, by its name."""
    ABILITIES[check.__name__.replace("_", " ")] = check
    return check


def assert_same(one: Any, other: Any) -> None:
    """Compare the rows of two orbits bit by bit."""
    mine, theirs = one.rows(), other.rows()
    assert mine.keys() == theirs.keys()
    for name in mine.keys() - {"turned"}:
        np.testing.assert_array_equal(mine[name], theirs[name], err_msg=name)


_NUMBERS = ("time", "configuration", "energy", "restricted_momentum")


def assert_close(one: Any, other: Any, tolerance: float = 1e-13) -> None:
    """Compare configurations, energies and momenta along the constraint with those of another orbit or member."""
    for name in _NUMBERS if other.has_poses else _NUMBERS[2:]:
        np.testing.assert_allclose(getattr(one, name), getattr(other, name), 0, tolerance, err_msg=name)


def joined(parts: list[Any]) -> Any:
    """Return blocks as one orbit."""
    return parts[0].joined(parts[1:])


@ability
def simulate(c: Case, _: Path) -> None:
    """Errors against the flow fall with the order; under a table of forces the second half is a run with later rows."""
    if "table" in c.kind.traits:
        friction, table = c.system.force
        later = dataclasses.replace(c.system, force=(friction, table[5:]))
        first = {"configuration": c.orbit.configuration[5], "momentum": c.orbit.restricted_momentum[5]}
        rest = nh.simulate(nh.discretize(later, c.h), steps=STEPS - 5, **first)
        return np.testing.assert_allclose(rest.configuration, c.orbit.configuration[5:], 0, 1e-13)
    errors = [np.linalg.norm(c.seen(end)[-1] - c.seen(c.flow)[-1]) for end in (c.orbit, c.halves)]
    order = getattr(c.discrete, "order", 2)
    assert abs(np.log2(errors[0] / errors[1]) - order) < 0.3, errors
    return None


@ability
def thinned(c: Case, folder: Path) -> None:
    """A thinned run has every third state, and its numbers, in stores and blocks too."""
    thin, wanted = c.simulated(save_every=3), c.orbit.chosen(slice(0, None, 3))
    for name in ("time", "step", "configuration", "energy", "restricted_momentum"):
        np.testing.assert_array_equal(getattr(thin, name), getattr(wanted, name), name)
    assert_same(c.simulated(save_every=3, store=folder / "a.zarr", checkpoint_every=6), thin)
    thinned = nh.iterate(c.discrete, steps=STEPS, save_every=3, block_steps=6, **c.start, **c.run)
    assert_same(joined(list(thinned)), thin)


@ability
def iterate(c: Case, _: Path) -> None:
    """Blocks are the run."""
    assert_same(joined(list(nh.iterate(c.discrete, steps=STEPS, block_steps=5, **c.start, **c.run))), c.orbit)


@ability
def store(c: Case, folder: Path) -> None:
    """A run into a store is the run in memory, also when the store is opened."""
    assert_same(c.simulated(store=folder / "a.zarr", **_PARTS), c.orbit)
    assert_same(nh.load_orbit(folder / "a.zarr", **c.known), c.orbit)


@ability
def save_and_load(c: Case, folder: Path) -> None:
    """A saved orbit comes back with its bits, decoded too."""
    loaded = _saved_and_loaded(c.orbit, folder / "a.zarr", **c.known)
    np.testing.assert_array_equal(loaded.body_velocity, c.orbit.body_velocity)


def _saved_and_loaded(orbit: Any, store: Path, **reference: Any) -> Any:
    nh.save_orbit(orbit, store)
    loaded = nh.load_orbit(store, **reference)
    assert_same(loaded, orbit)
    np.testing.assert_array_equal(loaded.energy, orbit.energy)
    return loaded


@ability
def extend(c: Case, folder: Path) -> None:
    """A store that is extended is the longer run."""
    c.simulated(steps=STEPS - 5, store=folder / "a.zarr", **_PARTS)
    assert_same(nh.extend(folder / "a.zarr", 5, **c.known), c.orbit)


@ability
def resume(c: Case, folder: Path) -> None:
    """A run that was stopped while it wrote its second block is, resumed, the undisturbed run."""
    with stopped_at(1):
        c.simulated(store=folder / "a.zarr", **_PARTS)
    assert_same(nh.resume(folder / "a.zarr", **c.known), c.orbit)


@ability
def events(c: Case, _: Path) -> None:
    """Crossings are as many as changes of sign, between the states where the sign changes, and on the level."""
    event, count = c.event()
    assert len(c.crossings) == count > 0
    assert STEPS // 2 in c.crossings.step
    np.testing.assert_allclose(event.function(c.crossings.states), 0, atol=1e-13)


@ability
def events_in_stores(c: Case, folder: Path) -> None:
    """A store has the crossings of the run in memory."""
    stored = c.simulated(store=folder / "a.zarr", events=[c.event()[0]], **_PARTS)
    assert_same(stored.events["middle"].states, c.crossings.states)


@ability
def events_in_iterators(c: Case, _: Path) -> None:
    """Blocks have the crossings of the run."""
    blocks = nh.iterate(c.discrete, steps=STEPS, block_steps=5, events=[c.event()[0]], **c.start, **c.run)
    assert_same(joined([block.events["middle"].states for block in blocks]), c.crossings.states)


@ability
def crossings(c: Case, _: Path) -> None:
    """The crossings of an orbit afterwards are those of its run."""
    assert_same(nh.crossings(c.orbit, c.event()[0]).states, c.crossings.states)


@ability
def impacts(c: Case, _: Path) -> None:
    """The first impact is where the run without a wall crosses it, and the step ends on the side where it began."""
    event, _ = c.event()
    orbit = c.simulated(events=[dataclasses.replace(event, reset=nh.Impact())])
    hits, free, values = orbit.events["middle"], c.crossings, event.function(orbit)
    np.testing.assert_array_equal(hits.time[0], free.time[0])
    np.testing.assert_array_equal(hits.states.configuration[0], free.states.configuration[0])
    assert values[hits.step[0]] * values[hits.step[0] + 1] > 0
    np.testing.assert_allclose(event.function(hits.after), 0, atol=1e-13)
    if not c.in_coordinates and "opaque" not in c.kind.traits:  # there energies are those of whole steps
        np.testing.assert_allclose(hits.after.energy, hits.states.energy, 1e-12)


@ability
def ensemble(c: Case, _: Path) -> None:
    """Members are runs alone from their starts."""
    batch = nh.ensemble(c.discrete, steps=STEPS, save_every=3, **c.rows, **c.run)
    for member in range(len(_MEMBERS)):
        _assert_member(batch, member, c.simulated(save_every=3, **c.alone(member)))


def _assert_member(batch: Any, member: int, alone: Any) -> None:
    assert batch.orbit(member).branch == alone.branch
    for name in _NUMBERS if alone.has_poses else _NUMBERS[2:]:
        np.testing.assert_allclose(getattr(batch, name)[member], getattr(alone, name), 1e-13, 1e-13, err_msg=name)


@ability
def ensemble_of_time_steps(c: Case, _: Path) -> None:
    """Members are runs alone with their time steps."""
    _assert_members_of(c, {"time_step": [c.h, c.h / 2]}, c.halves.chosen(slice(0, 1 + STEPS)))


def _assert_members_of(c: Case, parameters: dict[str, Any], second: Any) -> None:
    """Compare two members of an ensemble with the run and another one."""
    batch = nh.ensemble(c.discrete, steps=STEPS, save_every=1, parameters=parameters, **c.start, **c.run)
    _assert_member(batch, 0, c.orbit)
    _assert_member(batch, 1, second)


@ability
def ensemble_of_parameters(c: Case, _: Path) -> None:
    """Members are runs alone of their bodies."""
    _assert_members_of(c, {c.kind.parameter: np.stack(c.kind.values)}, c.simulated(c.kind.discrete(c.h, value=1)))


@ability
def ensemble_with_events(c: Case, _: Path) -> None:
    """Members have the crossings of their runs alone."""
    event, _ = c.event()
    result = nh.ensemble(c.discrete, steps=STEPS, events=[event], **c.rows, **c.run).events["middle"]
    assert result.count[1] > 0
    for member in range(len(_MEMBERS)):
        alone = c.simulated(events=[event], **c.alone(member)).events["middle"]
        assert result.count[member] == len(alone)
        if len(alone):
            np.testing.assert_allclose(result.first.time[member], alone.time[:1], 0, 1e-12)


@ability
def sweep(c: Case, folder: Path) -> None:
    """The members of a sweep end where runs alone do; its store, resumed, is the sweep."""
    design, task = nh.Grid({"time_step": [c.h, c.h / 2]}), _task(c)
    result = nh.sweep(task, design, folder / "a.zarr")
    for member, alone in enumerate((c.orbit, c.halves.chosen(slice(0, 1 + STEPS)))):
        np.testing.assert_allclose(result.final_energy[member], alone.energy[-1], 0, 1e-13)
        end = "restricted_momentum" if "final_momentum" in result else "configuration"
        stored = result.get("final_momentum", result.get("final_configuration"))
        np.testing.assert_allclose(stored[member], getattr(alone, end)[-1], 0, 1e-13)
        np.testing.assert_allclose(result.final_time[member], alone.time[-1], 0, 1e-13)
    own = {} if not c.known else {"task": task}
    assert nh.resume(folder / "a.zarr", **own).equals(result)


def _task(c: Case) -> Any:
    if c.in_coordinates:
        return nh.FamilyTask(c.ready, time_step=c.h, steps=STEPS)
    start = {name: value for name, value in c.start.items() if name != "configuration"}
    return nh.EnsembleTask(c.discrete, steps=STEPS, **start, **c.run)


@ability
def flow(c: Case, _: Path) -> None:
    """The flow is what runs with smaller and smaller steps tend to, by their extrapolation."""
    power = 2 ** getattr(c.discrete, "order", 2)
    coarse, fine = c.seen(c.orbit), c.seen(c.halves)[::2]
    limit = (power * fine - coarse) / (power - 1)
    errors = [np.abs(c.seen(c.flow) - rows).max() for rows in (coarse, limit)]
    assert errors[1] < 0.1 * errors[0] < 0.01, errors


@ability
def flow_with_events(c: Case, _: Path) -> None:
    """A flow that ends at the time of a crossing is there."""
    event, count = c.event(c.flow)
    result = c.flown(c.flow.time, events=[event]).events["middle"]
    assert len(result) == count > 0
    there = c.flown([0.0, result.time[0]])
    np.testing.assert_allclose(event.function(there)[-1], 0, atol=1e-9)


@ability
def flow_at_other_times(c: Case, _: Path) -> None:
    """States between are those of a flow that is asked for them."""
    times = c.h * np.array([0.3, 4.5])
    states = c.flown([0.0, *times]).chosen(slice(1, None))
    assert_close(c.flow.at(times), states, 1e-11)


@ability
def flow_ensemble(c: Case, _: Path) -> None:
    """Members of flows are flows alone."""
    batch = nh.ensemble(c.system, times=c.flow.time, **c.rows, **({"reconstruct": False} if c.is_wide else {}))
    for member in range(len(_MEMBERS)):
        _assert_member(batch, member, c.flown(c.flow.time, **c.alone(member)))


@ability
def flow_store(c: Case, folder: Path) -> None:
    """A saved flow comes back with its bits."""
    reference = {"discrete": c.flow.motion} if c.known and getattr(c.system, "forces", c.system) else {}
    _saved_and_loaded(c.flow, folder / "a.zarr", **reference)


@ability
def multipliers(c: Case, _: Path) -> None:
    """Impulses are what the definition leaves over, in rows of the annihilator; in coordinates of the forms."""
    if c.in_coordinates:
        law = "discrete principle"
    elif c.discrete.forces is not None or c.system.is_spatial:
        law = "multipliers"
    else:
        result, pairs = c.orbit.multipliers, zip(c.orbit.displacement, c.orbit.momentum, strict=True)
        left = c.orbit.momentum[1:] - np.stack([c.system.group.coadjoint(W, p) for W, p in pairs])[:-1]
        np.testing.assert_allclose(left @ np.linalg.pinv(c.system.annihilator), result, 0, 1e-12)
        return
    assert nh.testing.check_discretization(c.discrete, definition=False, **_place(c))[law].status == "ok"


def _place(c: Case) -> dict[str, Any]:
    return {"configuration": c.start["configuration"]} if c.in_coordinates else {}


@ability
def dataset(c: Case, _: Path) -> None:
    """The dataset has the arrays of the orbit, and its names."""
    report = c.orbit.to_dataset()
    np.testing.assert_array_equal(report["time"], c.orbit.time)
    np.testing.assert_array_equal(report["energy"], c.orbit.energy)
    np.testing.assert_array_equal(report[c.kept], getattr(c.orbit, c.kept))


@ability
def pandas(c: Case, _: Path) -> None:
    """The columns of the table are those of the orbit."""
    table = c.orbit.to_pandas()
    np.testing.assert_array_equal(table.index, c.orbit.time)
    np.testing.assert_array_equal(table["energy"], c.orbit.energy)
    columns = [name for name in table if str(name).startswith(c.kept)]
    np.testing.assert_array_equal(table[columns], getattr(c.orbit, c.kept))


@ability
def csv(c: Case, folder: Path) -> None:
    """The columns of the file are columns of the table."""
    c.orbit.to_csv(folder / "a.csv")
    written, table = np.genfromtxt(folder / "a.csv", delimiter=",", names=True), c.orbit.to_pandas()
    np.testing.assert_array_equal(written["t"], c.orbit.time)
    report = {table[name].to_numpy().tobytes() for name in table} | {row.tobytes() for row in c.seen(c.orbit).T}
    report |= {row.tobytes() for row in c.orbit.configuration.reshape(len(table), -1).T}
    for name in written.dtype.names[1:]:
        assert np.ascontiguousarray(written[name]).tobytes() in report, name


@ability
def picture(c: Case, folder: Path) -> None:
    """The picture is written, and a line of it has the numbers of the orbit."""
    figure = c.orbit.plot(folder / "a.png")
    assert (folder / "a.png").stat().st_size > 10_000
    rows = [*c.orbit.restricted_momentum.T, *c.orbit.body_velocity.T]
    lines = [np.asarray(line.get_ydata(), dtype=float) for axes in figure.axes for line in axes.lines]
    assert any(np.array_equal(line, row) for line in lines for row in rows)


@ability
def film(c: Case, folder: Path) -> None:
    """The film has its frames, and they differ."""
    first, second = frames_of(nh.plot.animate(c.orbit, folder / "a.gif", frames=2, size=(1.6, 1.2)))
    assert np.abs(second - first).max() > 60


@ability
def page(c: Case, folder: Path) -> None:
    """A page holds the first state of the motion and repeats it, or replays its numbers."""
    c.orbit.to_html(folder / "a.html")
    match = re.search(r'<script type="application/json" id="data">(.*?)</script>', (folder / "a.html").read_text())
    assert match is not None
    data = json.loads(match[1])
    if "replay" in data:
        energy = np.frombuffer(base64.b64decode(data["replay"]["energy"]))
        np.testing.assert_allclose(energy, c.balance, 1e-12)
    else:
        again = nh.explore(c.orbit).orbit()
        np.testing.assert_allclose(again.energy, c.orbit.energy, 1e-12)
        np.testing.assert_array_equal(data["state"]["momentum"], c.orbit.reduced_momentum[0])


@ability
def invariants(c: Case, _: Path) -> None:
    """The drift of the energy is that of the energies, less the work of forces."""
    result = nh.invariants(c.orbit)
    assert (result.states, result.steps) == (1 + STEPS, STEPS)
    np.testing.assert_allclose(result.energy_drift, np.ptp(c.balance) / np.abs(c.balance).max(), 0.2, 1e-14)


@ability
def compare(c: Case, _: Path) -> None:
    """Errors against the run with half the time step are the differences of their momenta and energies."""
    result, other = nh.compare(c.orbit, c.halves), c.halves.chosen(slice(0, None, 2))
    errors = np.linalg.norm(c.orbit.restricted_momentum - other.restricted_momentum, axis=1)
    np.testing.assert_allclose(result.momentum, errors, 1e-12, 1e-15)
    np.testing.assert_allclose(result.energy, c.orbit.energy - other.energy, 0, 1e-14)


@ability
def gradient(c: Case, _: Path) -> None:
    """The derivative of the end of a rollout by its start is the difference of two runs."""
    import jax

    name, start = next(iter(c.start.items()))
    if c.ready is not None:  # whose velocities have to be admissible
        name, start = "momentum", getattr(c.orbit, "momentum" if c.in_coordinates else "restricted_momentum")[0]
    rest = {key: value for key, value in c.start.items() if key not in (name, "body_velocity")}

    def end(run: Callable[..., Any], value: Any) -> Any:
        return run(c.discrete, **{name: value}, **rest, steps=3).configuration[-1].ravel()[-2]

    with jax.enable_x64(True):
        result = np.asarray(jax.grad(functools.partial(end, nh.rollout))(np.asarray(start, dtype=float)))
    way = 1e-4 * np.cos(np.arange(len(start)))
    np.testing.assert_allclose(result @ way, (end(nh.simulate, start + way) - end(nh.simulate, start - way)) / 2, 1e-6)


@ability
def checks(c: Case, _: Path) -> None:
    """The checks of the library hold for the system, its map and, of compositions, their order."""
    nh.testing.check_system(c.system, **_place(c))
    if "composition" in c.kind.traits:
        nh.testing.check_order(c.discrete, c.orbit.body_velocity[0])
    else:
        report = nh.testing.check_discretization(c.discrete, definition=False, **_place(c))
        assert any(each.status == "ok" for each in report.results)


@ability
def pickled(c: Case, _: Path) -> None:
    """An orbit comes back from a pickle with its bits, and what moves runs as before."""
    back = pickle.loads(pickle.dumps(c.orbit))  # noqa: S301
    assert_same(back, c.orbit)
    assert_same(c.simulated(pickle.loads(pickle.dumps(c.discrete))), c.orbit)  # noqa: S301


@ability
def scenario_file(c: Case, folder: Path) -> None:
    """A file runs by the command as the call does."""
    from nonholo.cli._app import app

    (folder / "a.toml").write_text(scenario_text(c))
    arguments = ["simulate", str(folder / "a.toml"), "-o", str(folder / "a.zarr"), "--no-plot", "--json"]
    result = CliRunner().invoke(app, arguments)
    if result.exit_code == 2:
        raise ValueError(result.output)
    assert result.exit_code == 0, result.output
    assert_same(nh.load_orbit(folder / "a.zarr"), c.orbit)


def scenario_text(c: Case) -> str:
    """Return the scenario of a kind, as a file has it."""
    tables = {
        "body": c.kind.body,
        "start": {name: np.asarray(value).tolist() for name, value in c.start.items()},
        "run": {"time_step": c.h, "steps": STEPS, **c.kind.how, **c.run},
        "forces": c.kind.forces,
    }
    return toml_text(c.kind.about, tables)
