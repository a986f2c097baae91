"""States of rest and steady motions that `equilibria` finds near a guess, against closed forms and balances."""

from collections.abc import Callable
from typing import Any

import jax.numpy as jnp
import numpy as np
import pytest
from refusals import refusals

import nonholo as nh
from nonholo.base.types import Array

G, SPEED = 9.81, 4.0


def hoop() -> nh.LagrangeDAlembert:
    """Return a bead on a hoop of radius 1 that is turned about its vertical diameter."""

    def lagrangian(q: Array, v: Array) -> Array:
        return (v[0] ** 2 + (v[1] * jnp.sin(q[0])) ** 2) / 2 + G * jnp.cos(q[0])

    return nh.LagrangeDAlembert(lagrangian, None, dimension=2, prescribed={1: lambda t: SPEED * t})


@pytest.mark.profile("routes", instead="test_rest_under_a_constraint")
def test_a_bead_finds_its_place_on_a_turning_hoop() -> None:
    r"""$\cos\theta = g/\Omega^2$, stable; the bottom is not; the map has the same places."""
    still, aside = [0.0, SPEED], np.arccos(G / SPEED**2)
    for subject in (hoop(), nh.discretize(hoop(), 0.05)):
        found = nh.equilibria(subject, configuration=[0.7, 0.0], body_velocity=still)
        np.testing.assert_allclose(found.configuration, [aside, 0.0], rtol=0, atol=1e-12)
        np.testing.assert_allclose(found.body_velocity, still, rtol=0, atol=1e-12)
        assert found.is_stable
        bottom = nh.equilibria(subject, configuration=[0.1, 0.0], body_velocity=still)
        np.testing.assert_allclose(bottom.configuration, 0, rtol=0, atol=1e-12)
        assert not bottom.is_stable
        assert (found.rates is None) == (found.multipliers is not None) == (subject.__class__ is not type(hoop()))


def test_rest_under_a_constraint() -> None:
    """A sled on a hill whose sides the blade takes up: the slope vanishes ahead of it."""
    hill: Callable[..., Any] = lambda q, v: v @ v / 2 - jnp.cosh(q[0] - 0.5 * q[1])  # noqa: E731
    sled = nh.LagrangeDAlembert(
        hill, lambda q: jnp.array([[-jnp.sin(q[2]), jnp.cos(q[2]), 0.0]]), dimension=3, coordinates=("x", "y", "turn")
    )
    found = nh.equilibria(sled, configuration=[0.4, -0.2, 0.3])
    x, y, turn = found.configuration
    assert abs(np.sinh(x - 0.5 * y) * (np.cos(turn) - 0.5 * np.sin(turn))) < 1e-13
    np.testing.assert_allclose(found.body_velocity, 0, rtol=0, atol=1e-13)
    assert found.linearization.names[:3] == ("x", "y", "turn")


def test_the_shortest_correction_is_taken() -> None:
    """Of two bodies on one spring that may slide together: the guess is moved across the line of equilibria."""
    pair = nh.LagrangeDAlembert(lambda q, v: v @ v / 2 - (q[1] - q[0] - 1) ** 2 / 2, None, dimension=2)
    found = nh.equilibria(pair, configuration=[0.0, 1.6])
    np.testing.assert_allclose(found.configuration, [0.3, 1.3], rtol=0, atol=1e-13)
    assert found.is_stable


@pytest.mark.profile("routes", instead="test_rest_under_a_constraint")
def test_a_heavy_top_hangs() -> None:
    """Under weight a top is at rest with its center of mass below or above, of the flow and the map."""
    point = np.array([0.1, 0.05, -0.3])
    heavy = nh.Forced(nh.SuslovTop(np.diag([1.0, 1.2, 0.6]) + 0.1), nh.Gravity([0.0, 0.0, -G], point))
    for subject in (heavy, nh.discretize(heavy, 0.05)):
        for pose, is_stable in ((np.eye(3), True), (np.diag([1.0, -1.0, -1.0]), False)):
            found = nh.equilibria(subject, configuration=pose)
            down = found.configuration @ point / np.linalg.norm(point)
            np.testing.assert_allclose(down, [0, 0, -1 if is_stable else 1], rtol=0, atol=1e-12)
            assert found.is_stable == is_stable


REFUSED = {
    "a slope": (
        nh.LagrangeDAlembert(lambda q, v: v @ v / 2 - jnp.exp(q[0]), None, dimension=1),
        {"configuration": [0.0]},
        "must be near a steady motion",
    ),
    "an energy": (hoop(), {"configuration": [0.0, 0.0], "energy": 2.0}, "must be left out beside a configuration"),
    "no configuration": (hoop(), {}, "configuration= to look near"),
    "a moving joint at rest": (hoop(), {"configuration": [0.0, 0.0]}, "must satisfy the constraint"),
}


# Where there is no equilibrium, and what is no question, is refused in words.
test_refusals = refusals(*REFUSED.values(), ask=lambda system, given: nh.equilibria(system, **given))
