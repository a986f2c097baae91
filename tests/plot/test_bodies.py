"""Bodies along their paths in the plane: outlines at their poses, arrows along the heading, to scale."""

from typing import Any

import numpy as np
import pytest
from refusals import refusals

import nonholo as nh
from nonholo.lagrange_dalembert import CoordinateOrbit, LagrangeDAlembert

PLANAR = {
    "driven_sleigh": "theta",
    "knife_edge_on_incline": "phi",
    "roller_racer": "theta",
    "rolling_disk": "phi",
    "snakeboard": "theta",
    "twistcar": "theta",
    "two_wheeled_robot": "theta",
}
CART = [[(-0.1, -0.2), (0.3, 0.0), (-0.1, 0.2)], [(0.0, 0.2), (0.1, 0.2)]]


def _free(**more: Any) -> LagrangeDAlembert:
    named = {"coordinates": ("x", "y", "a"), "heading": "a", "outline": CART} | more
    return LagrangeDAlembert(lambda _, v: v @ v / 2, None, dimension=3, **named)


def _orbit(system: LagrangeDAlembert, length: float = 4.0) -> CoordinateOrbit:
    """Return a path of given poses: a curve that turns by one radian."""
    t = np.linspace(0.0, 1.0, 81)
    q = np.zeros((81, system.dimension))
    q[:, 0], q[:, 1], q[:, 2] = length * t, length * t**2 / 2, t
    zeros = np.zeros((81, system.dimension))
    return CoordinateOrbit(t, q, zeros, zeros, zeros, zeros[:, :0], t + 1, 0 * t, system=system, time_step=0.0125)


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
    """A point has no outline; a space without x and y has no path to draw."""
    assert nh.plot.point_track(_orbit(_free(heading=None))).frames == ()
    with pytest.raises(ValueError, match=r"point_track\(orbit=...\)` must have coordinates named x and y. Got u, y, a"):
        nh.plot.point_track(_orbit(_free(coordinates=("u", "y", "a"), heading=None)))


@pytest.mark.parametrize("name", PLANAR)
def test_ready_systems_in_the_plane_have_bodies(name: str) -> None:
    """Each has its heading, and an outline as large as its lengths say."""
    ready = getattr(nh.examples, name)()
    assert ready.system.heading == PLANAR[name]
    parts = ready.system.parts(ready.configuration)
    assert 0.3 < max(np.linalg.norm(part, axis=1).max() for part in parts) < 2.0


# Before anything runs, with the argument and what it takes.
test_what_is_no_drawing_is_refused = refusals(
    ({"heading": "b"}, r"heading=...\)` must be a coordinate beside x and y of x, y, a. Got 'b'"),
    ({"heading": "x"}, r"heading=...\)` must be a coordinate beside"),
    ({"outline": 3}, r"outline=...\)` must be a list of parts"),
    ({"outline": [[(0, 0)]]}, r"outline=...\)` must have parts of at least two points"),
    ({"outline": [[(0, 0, 0), (1, 1, 1)]]}, r"outline=...\)` must have shape"),
    ask=lambda given: _free(**given),
)
