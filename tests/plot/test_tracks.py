"""Tracks of a sleigh: contact points, blades, the cusp."""

from typing import Any

import numpy as np
import pytest
from plot.runs import along, sleigh_run, top_run
from refusals import refusals

import nonholo as nh
from nonholo.lagrange_dalembert import CoordinateOrbit, LagrangeDAlembert


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


@pytest.mark.parametrize("velocity", [(0.1, 1.0, 0.0), (0.0, 1.0, 0.0), (0, 0, 0)], ids=["ahead", "straight", "rest"])
def test_no_cusp_without_reversal(velocity: tuple[float, float, float]) -> None:
    """A sleigh whose blade never reverses has no star and nothing enlarged."""
    drawn = nh.plot.blade_track(sleigh_run(velocity, steps=50))
    assert drawn.cusps is drawn.enlarged is None


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
    assert np.linalg.norm(drawn[:, None] - flow.position, axis=2).min(axis=0).max() < 1e-13
    exact = nh.flow(flow.system, body_velocity=(0.1, -1.0, 0.0), times=np.linspace(0.0, 20.0, 2000)).position
    assert len(drawn) > 1000
    assert np.linalg.norm(drawn[:, None] - exact, axis=2).min(axis=1).max() < 0.01


def test_points_are_the_forbidden_axis_in_space(top_orbit: nh.Orbit) -> None:
    """The path is R_k gamma for every state of a short orbit."""
    drawn = nh.plot.body_axis_track(top_orbit)
    assert np.allclose(drawn.points, top_orbit.configuration[:, :, 2], atol=1e-15)
    flat = drawn.view(drawn.points)[0]
    assert np.allclose(np.sort(drawn.dots.get_offsets()[:, 0]), np.sort(flat[:, 0]))


def test_tilted_axis() -> None:
    """With a forbidden axis other than e_3 the path is that of the axis in the user's frame."""
    axis = np.array([2.0, 1.0, 2.0]) / 3
    top = nh.SuslovTop.from_inertia(np.diag([3.0, 2.0, 1.5]), axis=axis)
    orbit = nh.simulate(nh.discretize(top, 0.1), restricted_velocity=(0.3, 0.5), steps=30)
    assert np.allclose(nh.plot.body_axis_track(orbit).points, orbit.configuration @ axis)


def test_axes_of_the_permanent_rotations() -> None:
    """The axes are the spatial angular velocities at the ends: along +c in the body before, along -c after."""
    orbit = top_run((0.465, 0.75, 0.0), steps=1500)
    drawn = nh.plot.body_axis_track(orbit)
    spin = np.einsum("kij,kj->ki", orbit.configuration, orbit.body_velocity)
    spin /= np.linalg.norm(spin, axis=1)[:, None]
    assert np.allclose(drawn.axis_after, spin[-1], atol=1e-8)  # settled
    assert np.allclose(drawn.axis_before, spin[0], atol=0.03)  # starts at sine 0.01 from the equilibrium
    line = orbit.system.equilibria().subspace[0] / np.linalg.norm(orbit.system.equilibria().subspace[0])
    assert np.allclose(drawn.axis_before, orbit.configuration[0] @ line)
    assert np.allclose(drawn.axis_after, orbit.configuration[-1] @ -line)


def test_balanced_top_has_one_axis() -> None:
    """Every motion of a balanced top is a permanent rotation, with the same axis before and after."""
    discrete = nh.discretize(nh.SuslovTop(np.diag([1.4, 1.0, 0.9])), 0.1)
    drawn = nh.plot.body_axis_track(nh.simulate(discrete, body_velocity=(0.4, 0.9, 0.0), steps=50))
    assert np.allclose(drawn.axis_before, drawn.axis_after, atol=1e-13)


def test_axes_are_left_out_where_the_orbit_is_not_near() -> None:
    """An orbit in the midst of its transition has neither axis."""
    drawn = nh.plot.body_axis_track(top_run((0.4, 0.9, 0.0), steps=40))
    assert drawn.axis_before is drawn.axis_after is None


CART = [[(-0.1, -0.2), (0.3, 0.0), (-0.1, 0.2)], [(0.0, 0.2), (0.1, 0.2)]]


def _free(**more: Any) -> LagrangeDAlembert:
    named = {"coordinates": ("x", "y", "a"), "heading": "a", "outline": CART} | more
    return LagrangeDAlembert(lambda _, v: v @ v / 2, None, dimension=3, **named)


def _orbit(system: LagrangeDAlembert, length: float = 4.0) -> CoordinateOrbit:
    """Return a path of given poses: a curve that turns by one radian."""
    t = np.linspace(0.0, 1.0, 81)
    return along(system, np.stack([length * t, length * t**2 / 2, t], axis=1))


def test_outlines_are_at_their_poses() -> None:
    """Every drawn part is a part of the outline, turned by the heading and moved to the place, bodies apart."""
    orbit = _orbit(_free())
    drawn = nh.plot.point_track(orbit)
    bodies, carried, arrows = drawn.frames
    assert len(bodies.get_paths()) == len(carried.get_paths()) == len(arrows.X) > 4
    for body, wheel, x, y, u, v in zip(
        bodies.get_paths(), carried.get_paths(), arrows.X, arrows.Y, arrows.U, arrows.V, strict=True
    ):
        (k,) = np.flatnonzero(orbit.configuration[:, 0] == x)
        angle = orbit.configuration[k, 2]
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        for path, part in ((body, CART[0]), (wheel, CART[1])):
            assert np.allclose(path.vertices[: len(part)], [x, y] + np.array(part) @ turn.T, atol=1e-14)
        assert np.allclose([u, v], np.hypot(u, v) * turn[:, 0], atol=1e-14)
    assert np.array_equal(drawn.points, orbit.configuration[:, :2])
    assert "body" not in " ".join(drawn.axes.get_legend_handles_labels()[1])


def test_a_function_gives_moving_parts() -> None:
    """The outline of each pose is that of its configuration."""
    system = _free(outline=lambda q: [CART[0], [(0.0, 0.0), (q[2], 1.0)]])
    ends = [path.vertices[1] for path in nh.plot.point_track(_orbit(system)).frames[1].get_paths()]
    assert len({tuple(np.round(end, 9)) for end in ends}) == len(ends)
    assert system.parts(np.array([0.0, 0.0, 0.7]))[1].tolist() == [[0.0, 0.0], [0.7, 1.0]]


def test_small_bodies_are_drawn_larger() -> None:
    """The legend says by how much; the drawn body is as many times as large."""
    drawn = nh.plot.point_track(_orbit(_free(), length=100.0))
    (words,) = [label for label in drawn.axes.get_legend_handles_labels()[1] if label.startswith("body")]
    larger = float(words.split()[1])
    corners = drawn.frames[0].get_paths()[0].vertices[:3]  # at the first pose, which is not turned
    assert np.allclose(corners, larger * np.array(CART[0]), rtol=0.05, atol=1e-12)
    assert larger > 2


def test_without_heading_there_is_a_path() -> None:
    """A point has no outline."""
    assert nh.plot.point_track(_orbit(_free(heading=None))).frames == ()


# Before anything runs, with the argument and what it takes.
test_what_is_no_drawing_is_refused = refusals(
    ({"heading": "b"}, r"heading=...\)` must be a coordinate beside x and y of x, y, a. Got 'b'"),
    ({"heading": "x"}, r"heading=...\)` must be a coordinate beside"),
    ({"outline": 3}, r"outline=...\)` must be a list of parts"),
    ({"outline": [[(0, 0)]]}, r"outline=...\)` must have parts of at least two points"),
    ({"outline": [[(0, 0, 0), (1, 1, 1)]]}, r"outline=...\)` must have shape"),
    ask=lambda given: _free(**given),
)


_SLEIGH, _BARE = (0.1, -1.0, 0.0), {"steps": 5, "reconstruct": False}
_TOP = top_run((0.4, 0.9, 0.0), steps=5)
# A picture of another body, and of an orbit without poses, says what to do or to draw.
test_orbits_without_such_a_track_are_refused = refusals(
    (nh.plot.blade_track, _TOP, r"a sleigh in the plane. .* `body_axis_track` for a top"),
    (nh.plot.blade_track, sleigh_run(_SLEIGH, **_BARE), "must have poses. .* with reconstruct=True"),
    (nh.plot.blade_track, 3, "must be an orbit of a system on a group. Got 3. Pass what `simulate`"),
    (nh.plot.body_axis_track, sleigh_run(_SLEIGH, steps=5), r"on SO\(3\). .* Use `blade_track` for a sleigh"),
    (
        nh.plot.point_track,
        _orbit(_free(coordinates=("u", "y", "a"), heading=None)),
        r"point_track\(orbit=...\)` must have coordinates named x and y. Got u, y, a",
    ),
    ask=lambda draw, orbit: draw(orbit),
)
