"""The picture of a curvature: the values of its cells, empty cells, gaits, and what is refused."""

import functools

import jax.numpy as jnp
import numpy as np
import pytest
from refusals import refusals

import nonholo as nh
from nonholo.analysis import LocalConnection
from nonholo.base.types import Array

pytestmark = pytest.mark.profile("routes", instead="test_the_car_has_the_connection_of_the_closed_form")


@functools.cache
def car() -> LocalConnection:
    """Return the connection of a car with rho / l = 1 / 4."""
    return nh.local_connection(nh.examples.kinematic_car(wheel_radius=0.25, wheelbase=1.0).system)


def middles(low: float, high: float) -> np.ndarray:
    """Return the middles of 120 cells."""
    return low + (np.arange(120) + 0.5) * (high - low) / 120


def test_cells_show_what_counterclockwise_gaits_gain() -> None:
    """Of the car -(rho / l) / cos(phi)^2 for turning, in the middle of each cell; nothing of the others."""
    picture = nh.plot.curvature(car(), bounds=((-1, 2), (-1.2, 0.9)))
    values = np.ma.getdata(picture.values.get_array())
    wanted = -0.25 / np.cos(middles(-1.2, 0.9)) ** 2
    np.testing.assert_allclose(values, np.broadcast_to(wanted[:, None], (120, 120)), rtol=1e-12)
    assert (picture.zero, picture.gait) == (None, None)
    swapped = nh.plot.curvature(car(), along=("phi", "psi"), bounds=((-1.2, 0.9), (-1, 2)))
    np.testing.assert_allclose(np.ma.getdata(swapped.values.get_array()), -values.T, rtol=1e-12)
    assert not np.ma.getdata(nh.plot.curvature(car(), "v2").values.get_array()).any()


def test_singular_cells_are_empty_and_the_colors_tell_the_others_apart() -> None:
    """Cells whose middle is at phi = pi / 2 are left out; the scale ends at three times the median."""
    edge = np.pi / 2 + 0.5 * 3 / 120
    picture = nh.plot.curvature(car(), bounds=((-1, 1), (edge - 3, edge)))
    values = picture.values.get_array()
    assert np.ma.getmaskarray(values)[-1].all()
    assert np.ma.getmaskarray(values).sum() == 120
    assert picture.values.norm.vmax == pytest.approx(3 * np.median(np.abs(values.compressed())), rel=1e-12)


def test_a_gait_is_drawn_within_its_range() -> None:
    """The line is the gait, and the map reaches beyond it on all sides; its name is the caller's."""

    def gait(time: Array) -> Array:
        return jnp.array([jnp.cos(time), 0.5 * jnp.sin(time)])

    phase = nh.geometric_phase(car(), gait)
    picture = nh.plot.curvature(car(), phase=phase, label="mine")
    np.testing.assert_array_equal(picture.gait.get_xydata(), phase.shape)
    np.testing.assert_allclose([*picture.axes.get_xlim(), *picture.axes.get_ylim()], [-1.6, 1.6, -0.8, 0.8], atol=1e-3)
    assert picture.gait.get_label() == "mine"


# Errors name the argument.
test_what_cannot_be_drawn_is_refused = refusals(
    ({"component": "v3"}, "component=...\\)` must be one of"),
    ({"along": ("psi", "psi")}, "name two shape variables"),
    ({"bounds": ((1, -1), (-1, 1))}, "have its lower end first"),
    ({"connection": nh.local_connection(nh.examples.roller_racer().system)}, "have two shape variables"),
    ask=lambda asked: nh.plot.curvature(**{"connection": car()} | asked),
)
