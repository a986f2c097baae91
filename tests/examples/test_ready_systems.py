"""What every ready system offers: a picture, tables, files, and a comparison with its flow."""

import functools

import numpy as np
import pytest

import nonholo as nh
from nonholo.base.numerics import double_precision
from nonholo.examples import Example
from nonholo.lagrange_dalembert import CoordinateOrbit

FORCED = {"heavy_suslov_top", "sleigh_in_a_well"}  # bodies, whose orbits are those of nh.Orbit: test_driven.py
NAMES = sorted(set(nh.examples.__all__) - {"Example"} - FORCED)
COORDINATES = [name for name in NAMES if name != "chaplygin_ball"]
DRIVEN = {"driven_sleigh", "roller_racer", "twistcar", "ball_on_turntable"}
HERE = pytest.mark.profile("routes", keep=["particle"])
PATHS = {
    "particle": ("Path", 3),
    "chaotic_quartic_oscillator": ("Plane of $x$ and $y_{1}$", 2),
}


@functools.cache
def ready(name: str) -> Example:
    """Return an example with its default parameters."""
    return getattr(nh.examples, name)()


@functools.cache
def run(name: str, steps: int = 40) -> CoordinateOrbit:
    """Return its discrete orbit up to time 4, or to 80 of its own steps."""
    start = {"configuration": ready(name).configuration, "body_velocity": ready(name).body_velocity}
    return nh.simulate(ready(name).discretize(80 * ready(name).time_step / steps), **start, steps=steps)


@functools.cache
def flow(name: str) -> CoordinateOrbit:
    """Return its flow at a few of the times of the runs."""
    start = {"configuration": ready(name).configuration, "body_velocity": ready(name).body_velocity}
    return nh.flow(
        ready(name).system, **start, times=80 * ready(name).time_step * np.linspace(0.0, 1.0, 9), rtol=1e-13, atol=1e-14
    )


@HERE
@pytest.mark.parametrize("name", COORDINATES)
def test_the_picture_shows_path_coordinates_velocities_and_errors(name: str) -> None:
    """Each panel draws the numbers of the orbit; the head has the name of the system and its coordinates."""
    orbit = run(name)
    figure = orbit.plot()
    titles = [axes.get_title(loc="left") for axes in figure.axes]
    path, d = PATHS.get(name, ("Path", 2))
    energy = "Energy less work" if name in DRIVEN else "Energy error"
    assert titles == [path, "Coordinates", "Velocity", energy, "Residual of the constraint"]
    assert ("of order 2 in the time between states" in [text.get_text() for text in figure.axes[3].texts]) == (
        name in DRIVEN
    )
    drawn = np.ma.getdata(figure.axes[0].collections[0].get_offsets())
    assert drawn.shape == (len(orbit), 2)
    if d == 2:
        assert np.array_equal(drawn, orbit.configuration[:, :2])
    assert (
        len([line for line in figure.axes[2].lines if len(line.get_xdata()) == len(orbit)])
        == orbit.body_velocity.shape[1]
    )
    assert ready(name).system.name in [text.get_text() for text in figure.texts]
    assert "40 steps" in figure.texts[1].get_text()


@HERE
@pytest.mark.parametrize("name", COORDINATES)
def test_the_table_has_a_column_for_each_number(name: str) -> None:
    """Coordinates have their names, velocities and momenta too; rows are indexed by time."""
    orbit, names = run(name), ready(name).coordinates
    table = orbit.to_pandas()
    assert np.array_equal(table[list(names)].to_numpy(), orbit.configuration)
    assert np.array_equal(table[[f"momentum_{each}" for each in names]].to_numpy(), orbit.momentum)
    assert np.array_equal(table["energy"], orbit.energy)
    assert np.array_equal(table.index, orbit.time)
    assert np.isnan(table["multipliers_0"].iloc[-1])


@HERE
@pytest.mark.parametrize("name", COORDINATES)
def test_files_are_read_back_exactly(name: str, tmp_path) -> None:  # noqa: ANN001
    """The CSV has the time and the named coordinates, the dataset keeps the names along an axis."""
    orbit, names = run(name), ready(name).coordinates
    orbit.to_csv(tmp_path / "motion.csv")
    table = np.genfromtxt(tmp_path / "motion.csv", delimiter=",", names=True)
    assert table.dtype.names == ("t", *names)
    assert np.array_equal(np.stack([table[each] for each in names], axis=1), orbit.configuration)
    with pytest.raises(FileExistsError):
        orbit.to_csv(tmp_path / "motion.csv")
    last = orbit.to_dataset().configuration.sel(coordinate=names[-1])
    assert np.array_equal(last, orbit.configuration[:, -1])


@pytest.mark.profile("routes", keep=["particle", "roller_racer"])
@pytest.mark.parametrize("name", NAMES)
def test_blocks_together_are_the_run(name: str) -> None:
    """Bit for bit, thinned too, the time of driven systems with it; the last block has the states that are left."""
    start = {"configuration": ready(name).configuration, "body_velocity": ready(name).body_velocity}
    discrete = ready(name).discretize(2 * ready(name).time_step)
    for every, block, sizes in ((1, 12, [12, 12, 12, 5]), (3, 12, [4, 4, 4, 2]), (1, 40, [40, 1]), (1, 39, [39, 2])):
        whole = nh.simulate(discrete, **start, steps=40, save_every=every)
        blocks = list(nh.iterate(discrete, **start, steps=40, save_every=every, block_steps=block))
        assert [len(each) for each in blocks] == sizes
        for rows in ("time", "configuration", "displacement", "momentum", "multipliers", "energy"):
            assert np.array_equal(np.concatenate([getattr(each, rows) for each in blocks]), getattr(whole, rows))


@HERE
@pytest.mark.parametrize("name", NAMES)
def test_the_errors_against_the_flow_are_of_order_two(name: str) -> None:
    """Of configurations and of momenta along admissible directions, where they are not only rounding."""
    study = nh.compare([run(name), run(name, 80)], flow(name))
    assert len(study.comparisons[0]) == 41
    assert abs(study.order.pose - 2.0) <= 0.1
    assert np.isnan(study.order.momentum) or abs(study.order.momentum - 2.0) <= 0.1


@HERE
@pytest.mark.parametrize("name", NAMES)
def test_invariants_are_measured(name: str) -> None:
    """Drift of the energy and residual of the constraint are those of the orbit's own numbers."""
    orbit = run(name)
    found = nh.invariants(orbit)
    assert (found.states, found.steps, found.outcome) == (41, 40, nh.Outcome.successful)
    assert found.work == (orbit.work[-1] if name in DRIVEN else None)
    assert found.group_residual is None if name in COORDINATES else found.group_residual < 1e-14
    size = max(abs(orbit.energy)) if name in DRIVEN else abs(orbit.energy[0])
    assert found.energy_drift == max(abs(orbit.energy - orbit.energy[0] - orbit.work)) / size
    assert found.constraint_residual == max(orbit.constraint_residual)


@HERE
@pytest.mark.parametrize("name", NAMES)
def test_restricted_momenta_act_on_admissible_velocities_alone(name: str) -> None:
    """They agree with the momentum on every admissible velocity, and vanish across: they lie in their span."""
    orbit, system = run(name), ready(name).system
    forms = getattr(system, "plain", system).constraint_forms
    rounding = 1e-13 * max(1.0, np.abs(orbit.momentum).max() / 100)  # hundreds of a bicycle
    for k in (0, 17, 40):
        with double_precision():
            A = np.asarray(forms(orbit.configuration[k]))
        prescribed = [index for index, _ in getattr(system, "prescribed", ())]
        A = np.concatenate([A, np.eye(A.shape[1])[prescribed]])
        free = np.linalg.svd(A)[2][len(A) :]
        assert np.abs(free @ (orbit.restricted_momentum - orbit.momentum)[k]).max() <= rounding
        assert np.abs(A @ orbit.restricted_momentum[k]).max() <= rounding


def test_a_flow_has_a_picture_of_lines_and_may_be_drawn_over_a_run() -> None:
    """Alone it is a line in the colors of time; beside a run a second one in each panel."""
    alone = nh.plot.overview(flow("particle"))
    assert "continuous flow from time 0 to 4" in alone.texts[1].get_text()
    both = nh.plot.overview(run("particle"), flow=flow("particle"))
    assert "continuous" in [text.get_text() for text in both.axes[0].get_legend().get_texts()]
    with pytest.raises(ValueError, match=r"overview\(flow=...\)` must move in"):
        nh.plot.overview(
            run("particle"),
            flow=nh.flow(nh.ChaplyginSleigh(1.0, 1.0, 0.5), body_velocity=(1.0, 0.0, 0.0), times=(0.0, 1.0)),
        )


def test_a_flow_is_known_between_its_times() -> None:
    """Its numbers at a time are those that a flow has that is asked for it; a discrete orbit has none."""
    orbit = flow("particle")
    start = {name: getattr(orbit, name)[0] for name in ("configuration", "body_velocity")}
    middle = (orbit.time[2] + orbit.time[3]) / 2
    asked = nh.flow(orbit.system, **start, times=[orbit.time[0], middle, orbit.time[-1]], rtol=1e-13)
    there = orbit.at([orbit.time[3], middle])
    for name in ("configuration", "body_velocity", "momentum", "energy", "multipliers"):
        rows = getattr(there, name)
        assert np.array_equal(rows[1], getattr(asked, name)[1])
        assert np.array_equal(rows[0], getattr(orbit, name)[3])
    with pytest.raises(ValueError, match="lie between"):
        orbit.at(orbit.time[-1] + 1)
    with pytest.raises(ValueError, match="be called on a flow"):
        run("particle").at(0.1)
