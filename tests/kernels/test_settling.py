"""Motions that decay onto an equilibrium, and those that leave one, at the smallest numbers there are."""

import math
from collections.abc import Callable

import numpy as np
import pytest

import nonholo as nh
from nonholo.kernels import _driver
from nonholo.kernels.secular import run as secular_run

SLEIGH = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1)
EIGENVECTOR = nh.discretize(nh.SuslovTop([[1.0, 0.0, 0.4], [0.0, 1.5, 0.0], [0.4, 0.0, 0.8]]), 0.1)


@pytest.mark.parametrize(("discrete", "across"), [(SLEIGH, 0), (EIGENVECTOR, 1)], ids=["sleigh", "top"])
def test_the_transverse_momentum_decays_to_zero_without_denormals(discrete: nh.Discretization, across: int) -> None:
    """The transverse momentum falls geometrically to 1e-150 of the other and is zero from then on, never denormal."""
    orbit = nh.simulate(discrete, restricted_velocity=(0.3, -0.9), steps=40_000)
    size = np.abs(orbit.reduced_momentum[:, across]) / np.abs(orbit.reduced_momentum[:, 1 - across])
    late = np.nonzero(size < 1e-100)[0][0]
    end = np.nonzero(size == 0)[0][0]
    rates = size[late + 1 : end] / size[late : end - 1]
    assert np.abs(rates / rates[0] - 1).max() < 1e-12
    assert size[end - 1] * rates[0] < 1e-150 <= size[end - 1]
    assert not size[end:].any()


@pytest.mark.parametrize("discrete", [SLEIGH, EIGENVECTOR], ids=["sleigh", "top"])
def test_a_repelling_equilibrium_is_left_from_however_near(discrete: nh.Discretization) -> None:
    """A transverse momentum of 1e-200 beside a repelling equilibrium grows until the motion is over."""
    attracting = discrete.system.canonical.restrict(
        discrete.system.canonical.inertia_operator @ discrete.system.canonical.equilibria().attracting
    )
    start = -attracting / np.linalg.norm(attracting)
    start[np.argmin(np.abs(start))] = 1e-200
    orbit = nh.simulate(discrete, momentum=np.linalg.solve(discrete.system.frame_map, start), steps=60_000)
    assert orbit.reduced_momentum[-1] @ attracting > 0
    assert nh.invariants(orbit).energy_drift <= 1e-13


Sum = Callable[[float, float, float, float], tuple[float, float]]


@pytest.mark.parametrize("add", [_driver.kahan_sum, secular_run._kahan_sum], ids=["two momenta", "many momenta"])
def test_rounding_does_not_gather(add: Sum) -> None:
    """After a hundred thousand terms a compensated sum is off by one rounding at most."""
    terms = np.random.default_rng(0).uniform(0.0, 0.1, 100_000).tolist()
    total, lost = 1.0, 0.0
    for term in terms:
        total, lost = add(total, lost, term, 0.0)
    exact = math.fsum([1.0, *terms])
    assert abs(total - exact) <= math.ulp(exact)
