"""Rates and multipliers of equilibria against differences, and steady motions that are found near a guess."""

from collections.abc import Callable
from typing import Any

import jax.numpy as jnp
import mpmath
import numpy as np
import pytest
from analysis.equations import G, hoop, momentum_rate
from bodies import ATTRACTING
from comparisons import derivatives
from refusals import refusals

import nonholo as nh
from nonholo.systems import AbstractLLSystem

SYSTEMS = ATTRACTING
STEP, ENERGY = 0.3, 0.4


def _momentum(system: AbstractLLSystem, velocity: np.ndarray) -> np.ndarray:
    return system.restrict(np.asarray(system.inertia_operator) @ velocity)


def _spectrum(function: Callable[[np.ndarray], np.ndarray], r: np.ndarray) -> np.ndarray:
    """Return the eigenvalues of the derivative of a function of the restricted momentum, by differences."""
    values = np.linalg.eigvals(derivatives(function, r))
    assert np.abs(values.imag).max() <= 1e-6
    return np.sort(values.real)


@pytest.mark.parametrize("name", SYSTEMS)
def test_rates_are_those_of_the_vector_field(name: str) -> None:
    """The linearized flow has the given rates, and zero along each direction of equilibria."""
    system, result, rate = SYSTEMS[name], nh.equilibria(SYSTEMS[name], ENERGY), momentum_rate(SYSTEMS[name])
    for sign in (1, -1):
        r = sign * _momentum(system, result.velocity)
        expected = np.sort(np.concatenate([sign * result.rates, np.zeros(len(result.subspace))]))
        assert np.abs(rate(r)).max() <= 1e-14
        assert np.abs(_spectrum(rate, r) - expected).max() <= 1e-7  # zero may be a Jordan block of the turning sleigh
    assert np.all(result.rates < 0)


@pytest.mark.parametrize("name", SYSTEMS)
def test_multipliers_are_those_of_the_map(name: str) -> None:
    """The linearized step has the given multipliers, reciprocals on the repelling half, and 1 along equilibria."""
    discrete = nh.discretize(SYSTEMS[name], STEP)
    system, result = discrete.system, nh.equilibria(discrete, ENERGY)

    def following(r: np.ndarray) -> np.ndarray:
        return nh.simulate(discrete, momentum=r, steps=1, reconstruct=False).restricted_momentum[1]

    for sign in (1, -1):
        r = sign * _momentum(system, result.velocity)
        expected = np.sort(np.concatenate([result.multipliers**sign, np.ones(len(result.subspace))]))
        assert np.abs(following(r) - r).max() <= 1e-13
        assert np.abs(_spectrum(following, r) - expected).max() <= 1e-7
    assert np.all(np.abs(result.multipliers) < 1)


@pytest.mark.parametrize("name", ["top 3", "sleigh 2"])
def test_multiplier_in_thirty_digits(name: str) -> None:
    """For n = 3 (D z0 - zeta q_c)/(D z0 + zeta q_c), for the sleigh (2I - a p_1)/(2I + a p_1), to 1e-14."""
    system = SYSTEMS[name]
    result = nh.equilibria(nh.discretize(system, STEP), ENERGY)
    with mpmath.workdps(30):
        h, E = mpmath.mpf(STEP), mpmath.mpf(ENERGY)
        if name == "sleigh 2":
            m, J, a = (mpmath.mpf(float(x)) for x in (system.mass, system.inertia, system.a))
            push = h * a * mpmath.sqrt(2 * m * E)
            expected = (2 * (J + m * a * a) - push) / (2 * (J + m * a * a) + push)
        else:
            (p, q), (_, r) = ([mpmath.mpf(x) for x in row] for row in system.constrained_inertia.tolist())
            c = [mpmath.mpf(x) for x in system.coupling.tolist()]
            D, qc, square = p * r - q * q, p * c[0] ** 2 + 2 * q * c[0] * c[1] + r * c[1] ** 2, c[0] ** 2 + c[1] ** 2
            half = mpmath.asin(h * mpmath.sqrt(2 * E / qc * square)) / 2
            z0, zeta = mpmath.cos(half), mpmath.sin(half) / mpmath.sqrt(square)
            expected = (D * z0 - zeta * qc) / (D * z0 + zeta * qc)
    assert abs(result.multipliers[0] - float(expected)) <= 1e-14


def test_large_steps_alternate() -> None:
    """For a large step the multiplier is negative, and the orbit then changes sides at each step."""
    discrete = nh.discretize(nh.ChaplyginSleigh(1.0, 0.1, 0.4), 1.0)
    result = nh.equilibria(discrete, energy=2.0)
    assert -1 < result.multipliers[0] < 0
    start = _momentum(discrete.system, result.velocity) + np.array([1e-6, 0.0])
    orbit = nh.simulate(discrete, momentum=start, steps=4, reconstruct=False)
    ratios = orbit.restricted_momentum[1:, 0] / orbit.restricted_momentum[:-1, 0]
    assert np.abs(ratios - result.multipliers[0]).max() <= 1e-5


@pytest.mark.parametrize("system", [nh.SuslovTop(np.diag([1.0, 2.0, 3.0])), nh.ChaplyginSleigh(1.0, 1.0, 0.0)])
def test_balanced_bodies_have_no_transverse_direction(system: AbstractLLSystem) -> None:
    """Where all velocities stay constant the spectrum is empty."""
    result = nh.equilibria(nh.discretize(system, 0.1))
    assert result.attracting is None
    assert result.velocity is None
    assert result.rates.shape == result.multipliers.shape == (0,)
    assert np.array_equal(result.subspace, system.constraint_subspace)


# Systems without such equilibria, energies without a step and other maps are refused.
test_refusals = refusals(
    (nh.VeselovaTop(np.diag([1.0, 2.0, 3.0])), {}, "left-invariant"),
    (SYSTEMS["top 3"], {"energy": 0.0}, "positive"),
    (nh.discretize(SYSTEMS["top 3"], 2.0), {"energy": 5.0}, "90 degrees"),
    (nh.discretize(SYSTEMS["top 3"], 0.1, difference="logarithmic"), {}, "conserve the energy"),
    ask=lambda subject, options: nh.equilibria(subject, **options),
)


SPEED = 4.0
HOOP = hoop(lambda t: SPEED * t)


@pytest.mark.profile("routes", instead="test_rest_under_a_constraint")
def test_a_bead_finds_its_place_on_a_turning_hoop() -> None:
    r"""$\cos\theta = g/\Omega^2$, stable; the bottom is not; the map has the same places."""
    still, aside = [0.0, SPEED], np.arccos(G / SPEED**2)
    for subject in (HOOP, nh.discretize(HOOP, 0.05)):
        result = nh.equilibria(subject, configuration=[0.7, 0.0], body_velocity=still)
        np.testing.assert_allclose(result.configuration, [aside, 0.0], rtol=0, atol=1e-12)
        np.testing.assert_allclose(result.body_velocity, still, rtol=0, atol=1e-12)
        assert result.is_stable
        bottom = nh.equilibria(subject, configuration=[0.1, 0.0], body_velocity=still)
        np.testing.assert_allclose(bottom.configuration, 0, rtol=0, atol=1e-12)
        assert not bottom.is_stable
        assert (result.rates is None) == (result.multipliers is not None) == (subject is not HOOP)


def test_rest_under_a_constraint() -> None:
    """A sled on a hill whose sides the blade takes up: the slope vanishes ahead of it."""
    sled = nh.LagrangeDAlembert(
        lambda q, v: v @ v / 2 - jnp.cosh(q[0] - 0.5 * q[1]),
        lambda q: jnp.array([[-jnp.sin(q[2]), jnp.cos(q[2]), 0.0]]),
        dimension=3,
        coordinates=("x", "y", "turn"),
    )
    result = nh.equilibria(sled, configuration=[0.4, -0.2, 0.3])
    x, y, turn = result.configuration
    assert abs(np.sinh(x - 0.5 * y) * (np.cos(turn) - 0.5 * np.sin(turn))) < 1e-13
    np.testing.assert_allclose(result.body_velocity, 0, rtol=0, atol=1e-13)
    assert result.linearization.names[:3] == ("x", "y", "turn")


def test_the_shortest_correction_is_taken() -> None:
    """Of two bodies on one spring that may slide together: the guess is moved across the line of equilibria."""
    pair = nh.LagrangeDAlembert(lambda q, v: v @ v / 2 - (q[1] - q[0] - 1) ** 2 / 2, None, dimension=2)
    result = nh.equilibria(pair, configuration=[0.0, 1.6])
    np.testing.assert_allclose(result.configuration, [0.3, 1.3], rtol=0, atol=1e-13)
    assert result.is_stable


def of_potential(potential: Callable[..., Any]) -> nh.LagrangeDAlembert:
    """Return a particle on a line under a potential."""
    return nh.LagrangeDAlembert(lambda q, v: v @ v / 2 - potential(q[0]), None, dimension=1)


# Where there is no equilibrium, and what is no question, is refused in words.
test_guesses_are_refused = refusals(
    (of_potential(jnp.exp), {"configuration": [0.0]}, "must be near a steady motion"),
    (of_potential(lambda x: -jnp.cos(x)), {"configuration": [0.3], "body_velocity": [0.3]}, "corrections lead to rest"),
    (HOOP, {"configuration": [0.0, 0.0], "energy": 2.0}, "must be left out beside a configuration"),
    (HOOP, {}, "configuration= to look near"),
    (HOOP, {"configuration": [0.0, 0.0]}, "must satisfy the constraint"),
    ask=lambda system, given: nh.equilibria(system, **given),
)
