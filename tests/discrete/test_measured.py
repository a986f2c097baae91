"""Orbits of given poses: a run gives its own momenta, other motions approach theirs, bad data are refused."""

import numpy as np
import pytest
from refusals import refusals

import nonholo as nh

SLEIGH = nh.ChaplyginSleigh(mass=1.0, inertia=0.75, a=0.5, b=0.2)
BODIES = {
    "sleigh": (SLEIGH, (1.0, 0.5, 0.0)),
    "tilted top": (nh.SuslovTop(np.diag([1.0, 2.0, 2.5]), axis=np.array([2.0, 1.0, 2.0]) / 3), (0.3, 0.2, -0.4)),
    "veselova": (nh.VeselovaTop(np.diag([1.0, 2.0, 3.0])), (0.4, 0.9, 0.0)),
    "free in space": (nh.RigidBody(np.diag([1.0, 2.0, 3.0, 1.0]), nh.SE(3)), (0.4, 0.9, 0.3, 0.2, 0.1, 0.0)),
    "inertia operator": (
        nh.LLSystem(nh.SO(3), inertia_operator=np.diag([1.0, 2.0, 3.0]), annihilator=[[0.1, 0.2, 1.0]]),
        (0.4, -0.2, 0.0),
    ),
}


def run(name: str, h: float = 0.1, steps: int = 40) -> nh.Orbit:
    """Return a discrete orbit of a body."""
    system, velocity = BODIES[name]
    return nh.simulate(nh.discretize(system, h), body_velocity=velocity, steps=steps)


@pytest.mark.profile("routes", keep=["sleigh", "tilted top", "veselova", "free in space"])
@pytest.mark.parametrize("name", BODIES)
def test_poses_of_a_run_have_its_momenta(name: str) -> None:
    """At all states, the last one too; the rounding of poses, divided by the time step, is what remains."""
    orbit = run(name)
    again = nh.Orbit.from_poses(orbit.system, orbit.time, orbit.configuration)
    assert np.abs(again.restricted_momentum - orbit.restricted_momentum).max() <= 3e-13
    assert np.abs(again.momentum - orbit.momentum)[:-1].max() <= 3e-13
    assert np.abs(again.displacement - orbit.displacement)[:-1].max() <= 1e-14
    assert np.abs(again.energy - orbit.energy).max() <= 3e-13
    assert nh.invariants(again).constraint_residual <= 1e-13
    assert (len(again), again.time_step) == (len(orbit), pytest.approx(0.1, rel=1e-12))


def test_the_last_displacement_leads_back() -> None:
    """It is the inverse of the one before, and its momentum that at which the last step arrives."""
    orbit = run("sleigh")
    again = nh.Orbit.from_poses(SLEIGH, orbit.time, orbit.configuration)
    arrived = nh.discrete_legendre(orbit.motion, orbit.displacement[-2], side="right")
    assert np.abs(again.displacement[-1] @ again.displacement[-2] - np.eye(3)).max() <= 1e-15
    assert np.abs(again.momentum[-1] - arrived).max() <= 3e-13


def test_momenta_of_uneven_poses_are_of_second_order() -> None:
    """Of a flow at random times momenta are off by the square of the largest gap, a quarter at twice the times."""
    flow = nh.flow(SLEIGH, body_velocity=BODIES["sleigh"][1], times=(0.0, 6.0))
    times = np.cumsum(np.random.default_rng(5).uniform(0.5, 1.5, 60))
    times *= 6.0 / times[-1]
    errors = []
    for t in (times, np.sort([*times, *(times[1:] + times[:-1]) / 2])):
        orbit = nh.Orbit.from_poses(SLEIGH, t, flow.at(t).configuration)
        assert orbit.time_step is None
        errors.append(nh.compare(orbit, flow).largest)
    assert errors[0].pose <= 1e-15
    assert 3.4 <= errors[0].momentum / errors[1].momentum <= 4.6


def test_velocities_under_other_forces_are_of_second_order() -> None:
    """On a spiral that no free body follows, between the ends; the velocity of the definition is known there."""
    sleigh, errors = nh.ChaplyginSleigh(1.0, 1.0, 0.5), []
    for h in (0.1, 0.05):
        t = np.arange(0.0, 2.0 + h / 2, h) ** 1.5  # uneven, too
        s = t + 0.3 * np.sin(t)
        orbit = nh.Orbit.from_poses(sleigh, t, nh.SE(2).exp(np.stack([0.5 * s, s, 0 * s], axis=1)))
        rate = 1 + 0.3 * np.cos(t)
        velocity = np.stack([0.5 * rate, rate, 0 * rate], axis=1)
        errors.append(np.abs(orbit.body_velocity - velocity)[1:-1].max())
    assert errors[0] <= 2e-2
    assert 3.4 <= errors[0] / errors[1] <= 4.6


def test_a_skidding_blade_is_seen() -> None:
    """A body that drifts sideways at 0.3 has this residual; the velocity shown is the admissible part."""
    t = np.linspace(0.0, 2.0, 21)
    g = nh.SE(2).exp(np.stack([0 * t, t, 0.3 * t], axis=1))
    orbit = nh.Orbit.from_poses(nh.ChaplyginSleigh(1.0, 1.0, a=0.0), t, g)
    assert nh.invariants(orbit).constraint_residual == pytest.approx(0.3, rel=1e-12)
    assert np.abs(orbit.body_velocity - [0.0, 1.0, 0.0]).max() <= 1e-13


def test_two_poses_are_enough() -> None:
    """Both states then have the one velocity."""
    orbit = nh.Orbit.from_poses(SLEIGH, (0.0, 0.5), nh.SE(2).exp(np.array([[0.0, 0.0, 0.0], [0.0, 0.7, 0.0]])))
    assert np.abs(orbit.body_velocity - [0.0, 1.4, 0.0]).max() <= 1e-14


def test_poses_in_single_precision_are_put_on_the_group() -> None:
    """They are taken, and lie on the group to rounding afterwards."""
    orbit = run("tilted top")
    rough = orbit.configuration.astype(np.float32)
    again = nh.Orbit.from_poses(orbit.system, orbit.time, rough)
    assert nh.invariants(again).group_residual <= 1e-15
    assert 1e-9 <= np.abs(again.configuration - orbit.configuration).max() <= 1e-6


def test_given_poses_have_tables_pictures_and_stores(tmp_path) -> None:  # noqa: ANN001
    """The CSV holds the poses, the table all numbers, the store the same bits; the picture says what was given."""
    orbit = run("sleigh")
    again = nh.Orbit.from_poses(SLEIGH, orbit.time, orbit.configuration)
    again.to_csv(tmp_path / "poses.csv")
    rows = np.loadtxt(tmp_path / "poses.csv", delimiter=",", skiprows=1)
    assert np.abs(rows[:, 1:3] - orbit.position).max() <= 1e-15
    assert list(again.to_pandas().columns) == list(orbit.to_pandas().columns)
    assert "multipliers" not in again.to_dataset(decoded=True)
    nh.save_orbit(again, tmp_path / "poses.zarr")
    loaded = nh.load_orbit(tmp_path / "poses.zarr")
    assert np.array_equal(loaded.momentum, again.momentum)
    assert loaded.time_step == again.time_step
    words = " ".join(text.get_text() for text in again.plot().findobj(lambda artist: hasattr(artist, "get_text")))
    assert "41 given poses from time 0 to 4" in words
    assert "of given poses" in words
    assert "discrete orbit" not in words


GOOD = {"system": SLEIGH, "time": (0.0, 0.1, 0.2), "configuration": np.stack([np.eye(3)] * 3)}
TURNED = np.stack([np.eye(3), np.eye(3), np.diag([1.0, -1.0, 1.0])])


# Each message names the argument, what it must be, and the row.
test_bad_data_are_refused = refusals(
    ({"system": 5}, r"from_poses\(system=...\)` must be a system on a group"),
    ({"time": (0.0,), "configuration": np.eye(3)[None]}, "two times or more"),
    ({"time": (), "configuration": np.zeros((0, 3, 3))}, "two times or more"),
    ({"time": (0.0, 0.2, 0.1)}, "strictly increasing. Got 0.1 after 0.2"),
    ({"time": (0.0, 0.1, 0.1)}, "strictly increasing"),
    ({"time": (0.0, np.nan, 0.1)}, "finite"),
    ({"time": (0.0, 0.1)}, "one time for each pose. Got 2 times for 3 poses"),
    ({"configuration": np.eye(3)}, r"shape \(any, 3, 3\)"),
    ({"configuration": TURNED}, r"must lie in SE\(2\). Got .* in row 2"),
    ({"configuration": 1.001 * GOOD["configuration"]}, "in row 0"),
    ask=lambda change: nh.Orbit.from_poses(**GOOD | change),
)


# Forces of constraint, states between poses, crossings.
test_what_poses_cannot_tell_is_refused = refusals(
    (lambda orbit: orbit.multipliers, r"Orbit.multipliers` must be read from a run"),
    (lambda orbit: orbit.at(0.05), r"Orbit.at\(...\)` must be called on a flow"),
    (lambda orbit: nh.crossings(orbit, nh.cusp), "every single step of a discrete run"),
    ask=lambda question: question(nh.Orbit.from_poses(**GOOD)),
)


def _turning(angle: float) -> nh.Orbit:
    """Return the orbit of poses that are turned by an angle a row."""
    return nh.Orbit.from_poses(SLEIGH, 0.1 * np.arange(5), nh.SE(2).exp(np.outer(angle * np.arange(5), [1, 0, 0])))


@pytest.mark.parametrize("degrees", [92.0, 180.0, 230.0])
def test_turns_beyond_a_quarter_are_warned_of(degrees: float) -> None:
    """Beyond half a turn the velocity is another one, and nothing in the poses tells."""
    with pytest.warns(nh.AliasingWarning, match=r"row 0 to row 1. Velocities are those of the shorter turn") as records:
        _turning(np.radians(degrees))
    assert records[0].filename == __file__


def test_turns_within_a_quarter_are_not_warned_of() -> None:
    """Their discrete velocity has the sign of the turn that was taken: sin(angle) / h, here of W - W^-1 over 2 h."""
    assert np.abs(_turning(1.5).body_velocity[1:-1, 0] - np.sin(1.5) / 0.1).max() < 1e-12
