"""Tracks of a sleigh: contact points, blades, the cusp."""

import numpy as np
import pytest
from plot.runs import sleigh_run

import nonholo as nh


def test_dots_are_the_contact_points(sleigh_orbit: nh.Orbit) -> None:
    """The dots are the positions of all states, colored by their times, from the first to the last."""
    drawn = nh.plot.blade_track(sleigh_orbit)
    assert np.array_equal(drawn.track.get_offsets(), sleigh_orbit.position)
    assert np.array_equal(drawn.track.get_array(), sleigh_orbit.time)
    assert np.array_equal(drawn.ends.get_offsets(), sleigh_orbit.position[[0, -1]])
    assert drawn.axes.get_aspect() == 1.0


def test_blades_lie_along_the_heading(sleigh_orbit: nh.Orbit) -> None:
    """Each stroke is centered at a contact point and has its heading; the mass is where the body carries it."""
    drawn = nh.plot.blade_track(sleigh_orbit)
    strokes = np.array(drawn.blades.get_segments())
    centers = strokes.mean(axis=1)
    nearest = np.linalg.norm(centers[:, None] - sleigh_orbit.position, axis=-1).argmin(axis=1)
    assert np.allclose(centers, sleigh_orbit.position[nearest])
    along = (strokes[:, 1] - strokes[:, 0]) / np.linalg.norm(strokes[:, 1] - strokes[:, 0], axis=1)[:, None]
    assert np.allclose(along, sleigh_orbit.configuration[nearest, :2, 0])
    carried = sleigh_orbit.configuration[nearest] @ [0.5, 0.3, 1.0]
    assert np.allclose(drawn.masses.get_offsets(), carried[:, :2])


@pytest.mark.parametrize("b", [0.0, 0.3, -0.4])
def test_cusp_is_where_the_blade_reverses(b: float) -> None:
    """The star lies between the last state with v_1 < 0 and the first with v_1 > 0."""
    orbit = sleigh_run((0.1, -1.0, 0.0), b=b, steps=200)
    cusps = nh.plot.blade_track(orbit).cusps.get_offsets()
    after = int(np.argmax(orbit.body_velocity[:, 1] > 0))
    before, beyond = orbit.position[after - 1], orbit.position[after]
    assert len(cusps) == 1
    assert np.isclose(
        np.linalg.norm(cusps[0] - before) + np.linalg.norm(cusps[0] - beyond), np.linalg.norm(beyond - before)
    )


@pytest.mark.parametrize(
    "velocity", [(0.1, 1.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 0.0)], ids=["ahead", "straight", "rest"]
)
def test_no_cusp_without_reversal(velocity: tuple[float, float, float]) -> None:
    """A sleigh whose blade never reverses has no star and nothing enlarged."""
    drawn = nh.plot.blade_track(sleigh_run(velocity, steps=50))
    assert drawn.cusps is None
    assert drawn.enlarged is None


def test_long_runs_are_thinned_but_keep_the_turn() -> None:
    """Of 20001 states at most some thousand dots are drawn, and the whole turn is shown in the corner."""
    orbit = sleigh_run((0.1, -1.0, 0.0), steps=20000)
    drawn = nh.plot.blade_track(orbit)
    assert len(drawn.track.get_offsets()) <= 1502
    assert np.array_equal(drawn.track.get_offsets()[[0, -1]], orbit.position[[0, -1]])
    cusp = drawn.cusps.get_offsets()[0]
    dots = drawn.enlarged.collections[0].get_offsets()
    assert len(dots) > 50
    assert np.linalg.norm(dots - cusp, axis=1).min() < 0.1


def test_the_flow_is_drawn_over_it(sleigh_orbit: nh.Orbit) -> None:
    """The continuous curve has the positions of the flow at its times, and many more between them."""
    flow = nh.flow(sleigh_orbit.system, body_velocity=(0.1, -1.0, 0.0), times=np.linspace(0.0, 20.0, 300))
    line = nh.plot.blade_track(sleigh_orbit, flow=flow).flow
    drawn = line.get_xydata()
    missed = np.linalg.norm(drawn[:, None] - flow.position, axis=2).min(axis=0)
    assert missed.max() < 1e-13
    exact = nh.flow(flow.system, body_velocity=(0.1, -1.0, 0.0), times=np.linspace(0.0, 20.0, 2000)).position
    assert len(drawn) > 1000
    assert np.linalg.norm(drawn[:, None] - exact, axis=2).min(axis=1).max() < 0.01


def test_refuses_a_top_and_an_orbit_without_poses(top_orbit: nh.Orbit) -> None:
    """A top has no blade, and without poses there is no track; both refusals say what to do."""
    with pytest.raises(ValueError, match=r"must be an orbit of a sleigh in the plane. .* `body_axis_track` for a top"):
        nh.plot.blade_track(top_orbit)
    with pytest.raises(ValueError, match=r"must have poses. .* Run with reconstruct=True"):
        nh.plot.blade_track(sleigh_run((0.1, -1.0, 0.0), steps=5, reconstruct=False))
    with pytest.raises(ValueError, match=r"must be an orbit of a system on a group. Got 3. Pass what `simulate`"):
        nh.plot.blade_track(3)
