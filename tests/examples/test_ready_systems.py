"""What every ready system offers: a picture, tables, files, crossings, a flow; wheels that are drawn do not slip."""

import dataclasses
import functools
from collections.abc import Callable

import numpy as np
import pytest

import nonholo as nh
from nonholo.analysis.bodies import plate
from nonholo.analysis.planar import blade_axes
from nonholo.base.numerics import double_precision
from nonholo.base.types import Array
from nonholo.examples import Example
from nonholo.lagrange_dalembert import CoordinateOrbit

FORCED = {"heavy_suslov_top", "sleigh_in_a_well"}  # bodies, whose orbits are those of nh.Orbit: test_driven.py
NAMES = sorted(set(nh.examples.__all__) - {"Example"} - FORCED)
COORDINATES = [name for name in NAMES if name != "chaplygin_ball"]
HERE = pytest.mark.profile("routes", keep=["particle"])


@functools.cache
def ready(name: str) -> Example:
    """Return an example with its default parameters."""
    return getattr(nh.examples, name)()


@functools.cache
def run(name: str, steps: int = 40) -> CoordinateOrbit:
    """Return its discrete orbit up to time 4, or to 80 of its own steps."""
    return ready(name).simulate(time_step=80 * ready(name).time_step / steps, steps=steps)


@functools.cache
def flow(name: str) -> CoordinateOrbit:
    """Return its flow at a few of the times of the runs."""
    return ready(name).flow(times=80 * ready(name).time_step * np.linspace(0.0, 1.0, 9), rtol=1e-13, atol=1e-14)


@HERE
@pytest.mark.parametrize("name", COORDINATES)
def test_the_table_has_a_column_for_each_number(name: str, tmp_path) -> None:  # noqa: ANN001
    """Coordinates have their names, velocities and momenta too, in tables by time, CSV files and datasets."""
    orbit, names = run(name), ready(name).coordinates
    table = orbit.to_pandas()
    assert np.array_equal(table[list(names)].to_numpy(), orbit.configuration)
    assert np.array_equal(table[[f"momentum_{each}" for each in names]].to_numpy(), orbit.momentum)
    assert np.array_equal(table.index, orbit.time)
    assert np.isnan(table["multipliers_0"].iloc[-1])
    orbit.to_csv(tmp_path / "motion.csv")
    with (tmp_path / "motion.csv").open() as file:
        assert file.readline().strip().split(",") == ["t", *names]
    with pytest.raises(FileExistsError):
        orbit.to_csv(tmp_path / "motion.csv")
    last = orbit.to_dataset().configuration.sel(coordinate=names[-1])
    assert np.array_equal(last, orbit.configuration[:, -1])


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
    """Alone it is a line in the colors of time; beside a run a second one in each panel, without corners."""
    alone = nh.plot.overview(flow("particle"))
    assert "continuous flow from time 0 to 4" in alone.texts[1].get_text()
    both = nh.plot.overview(run("particle"), flow=flow("particle"))
    assert "continuous" in [text.get_text() for text in both.axes[0].get_legend().get_texts()]
    assert len(nh.plot.point_track(run("particle"), flow=flow("particle")).flow.get_xdata()) > 500
    with pytest.raises(ValueError, match=r"overview\(flow=...\)` must move in"):
        nh.plot.overview(
            run("particle"),
            flow=nh.flow(nh.ChaplyginSleigh(1.0, 1.0, 0.5), body_velocity=(1.0, 0.0, 0.0), times=(0.0, 1.0)),
        )


EVERY = sorted(set(nh.examples.__all__) - {"Example"})
DRIVEN = {"driven_sleigh", "roller_racer", "twistcar", "ball_on_turntable"}
STEPS = 30


def _profile(name: str) -> list[pytest.MarkDecorator]:
    """Return where a system runs: the particle by default; what takes half a minute and more before a release."""
    profile = "long" if name in {"chaplygin_ball", "bicycle", "rattleback"} else "routes"
    guard = "test_a_ready_system_is_first_class"
    return [] if name == "particle" else [pytest.mark.profile(profile, instead=guard)]


@pytest.mark.parametrize("name", [pytest.param(name, marks=_profile(name), id=name) for name in EVERY])
def test_a_ready_system_is_first_class(name: str) -> None:
    """The level lies between states 17 and 18: the crossing is what a step of that part of the length reaches."""
    ready: Example = getattr(nh.examples, name)()
    discrete = ready.discretize(2 * ready.time_step)
    orbit = ready.simulate(time_step=2 * ready.time_step, steps=STEPS)
    flat = orbit.configuration.reshape(len(orbit), -1)
    place = int(np.argmax(np.ptp(flat, axis=0)))
    level = (flat[17, place] + flat[18, place]) / 2
    event = nh.Event(lambda states: states.configuration.reshape(len(states), -1)[:, place] - level, name="level")
    result = ready.simulate(time_step=2 * ready.time_step, steps=STEPS, events=[event]).events["level"]
    at = int(np.flatnonzero(result.step == 17)[0])
    assert np.abs(event.function(result.states)).max() <= 4 * np.spacing(np.abs(flat[:, place]).max())
    if name not in DRIVEN:  # whose runs begin at time 0
        part = dataclasses.replace(discrete, time_step=result.fraction[at] * float(discrete.time_step))
        momentum = (orbit.restricted_momentum if name in FORCED else orbit.momentum)[17]
        reached = nh.simulate(part, configuration=orbit.configuration[17], momentum=momentum, steps=1)
        # starts from a momentum solve the same equations; their roots are exact to 1e-10 squared
        assert np.abs(result.states.configuration[at] - reached.configuration[1]).max() <= 1e-13


ROLLING = {
    "bicycle": [3, 4], "driven_sleigh": [1], "kinematic_car": [2, 3, 4, 5], "knife_edge_on_incline": [0],
    "roller_racer": [2, 3, 6, 7], "rolling_disk": [0], "sleigh_in_a_well": [-1], "snake": [2, 3, 6, 7, 10, 11],
    "snakeboard": [3, 4, 6, 7], "tilting_disk": [1], "trailers": [2, 3, 7, 8, 12, 13, 17, 18],
    "twistcar": [2, 3, 6, 7], "two_wheeled_robot": [1, 2],
}  # fmt: skip
"""Which parts of the outline of an example are on the ground: blades, and wheels that roll along their first edge."""


def parts_in_space(name: str, x: float, y: float, heading: float, parts: list[Array]) -> list[tuple[Array, Array]]:
    """Return middle and axle, a unit vector, of each part of a body at a pose that is on the ground."""
    turn, result = np.array([[np.cos(heading), np.sin(heading)], [-np.sin(heading), np.cos(heading)]]), []
    for part in (parts[k] @ turn for k in ROLLING[name]):
        ahead = (part[1] - part[0]) / np.linalg.norm(part[1] - part[0])
        result.append((part.mean(axis=0) + np.array([x, y]), np.array([-ahead[1], ahead[0]])))
    return result


def in_coordinates(name: str, q: Array, v: Array) -> Callable[[float], list[tuple[Array, Array]]]:
    """Return the parts at configurations along a velocity."""
    system = ready(name).system
    places = [system.coordinates.index(each) for each in ("x", "y", system.heading)]

    def at(s: float) -> list[tuple[Array, Array]]:
        return parts_in_space(name, *(q + s * v)[places], system.parts(q + s * v))

    return at


def on_group(name: str, g: Array, v: Array) -> Callable[[float], list[tuple[Array, Array]]]:
    """Return the parts at poses along a body velocity."""
    system = ready(name).system.system
    parts, axes = plate(system), blade_axes(system.inside)

    def at(s: float) -> list[tuple[Array, Array]]:
        pose = g @ system.group.exp(s * v) @ axes
        return parts_in_space(name, *pose[:2, 2], np.arctan2(pose[1, 0], pose[0, 0]), parts)

    return at


def test_every_outline_is_tested() -> None:
    """The table above names every example that pictures draw as a body on the ground."""
    drawn = {name for name in set(nh.examples.__all__) - {"Example"} if _is_drawn(ready(name).system)}
    assert drawn - {"rattleback"} == set(ROLLING)  # which has no wheel


def _is_drawn(system: object) -> bool:
    body = getattr(system, "system", None)
    return bool(getattr(system, "outline", ())) or (body is not None and body.group == nh.SE(2))


@pytest.mark.profile("routes", keep=["snakeboard", "rolling_disk", "s*well"])
@pytest.mark.parametrize("name", sorted(ROLLING))
def test_a_wheel_that_is_drawn_does_not_slip(name: str) -> None:
    """Along a run the middle of a drawn wheel or blade moves along it: across by the error of differences of 1e-5."""
    example, at = ready(name), on_group if name == "sleigh_in_a_well" else in_coordinates
    body = example.system.system if at is on_group else example.system  # without the spring, which compiles for long
    start = {"configuration": example.configuration, "body_velocity": example.body_velocity}
    orbit = nh.simulate(nh.discretize(body, 0.05), **start, steps=40)
    rows = orbit.configuration if at is on_group else orbit.configuration + orbit.displacement / 2
    fastest = 0.0
    for q, v in zip(rows[:-1:5], orbit.body_velocity[:-1:5], strict=True):
        parts = at(name, q, v)
        for (before, _), (_, axle), (after, _) in zip(parts(-1e-5), parts(0.0), parts(1e-5), strict=True):
            moved = (after - before) / 2e-5
            fastest = max(fastest, float(np.abs(moved).max()))
            assert abs(moved @ axle) < 1e-8 * (1 + np.linalg.norm(v))
    assert fastest > 0.05  # it moves at all
