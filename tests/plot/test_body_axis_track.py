"""Paths of the forbidden axis on the sphere, the two permanent rotations, the projection."""

import numpy as np
import pytest
from plot.runs import top_run

import nonholo as nh


def test_points_are_the_forbidden_axis_in_space(top_orbit: nh.Orbit) -> None:
    """The path is R_k gamma for every state of a short orbit."""
    drawn = nh.plot.body_axis_track(top_orbit)
    assert np.allclose(drawn.points, top_orbit.configuration[:, :, 2], atol=1e-15)
    flat = drawn.view(drawn.points)[0]
    dots = drawn.dots.get_offsets()
    assert np.allclose(np.sort(dots[:, 0]), np.sort(flat[:, 0]))


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
    assert drawn.axis_before is None
    assert drawn.axis_after is None


def test_refuses_a_sleigh(sleigh_orbit: nh.Orbit) -> None:
    """A sleigh has no forbidden axis of rotation; the refusal names the picture for it."""
    with pytest.raises(ValueError, match=r"must be an orbit on SO\(3\). .* Use `blade_track` for a sleigh"):
        nh.plot.body_axis_track(sleigh_orbit)
