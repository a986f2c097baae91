"""Potentials that are functions, in JAX: exact derivatives beside differences, runs, and how numbers move them."""

import dataclasses
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from refusals import refusals

import nonholo as nh
from nonholo.simulation.traced import with_traced_potential

START = {"body_velocity": np.array([0.4, 0.7, 0.0]), "configuration": nh.SE(2).exp(np.array([0.3, 0.2, -0.1]))}


def _well(stiffness: Any, scheme: str | None = None) -> Any:
    """Return a sleigh in a well that is no harmonic one."""
    sleigh = nh.ChaplyginSleigh(mass=1.0, inertia=0.5, a=0.2)
    return nh.discretize(nh.Forced(sleigh, lambda g: stiffness * (g[0, 2] ** 2 + g[1, 2] ** 4) / 2, scheme=scheme), 0.1)


@pytest.mark.profile("routes", keep=["well"])
@pytest.mark.parametrize("discrete", [_well(0.8), nh.examples.heavy_suslov_top().discretize(0.1)], ids=["well", "top"])
def test_forces_are_those_of_differences(discrete: Any) -> None:
    """Energy, force and force of a step are those of `Forced`, which differences the function; at rest too."""
    rng, given, group = np.random.default_rng(6), discrete.system, discrete.system.group
    traced = with_traced_potential("rollout", discrete).system
    for size in (0.7, 1e-3, 1e-9, 0.0):
        g, W = group.exp(rng.normal(size=group.dim)), group.exp(size * rng.normal(size=group.dim))
        step = g[None], W[None], 0.1, np.zeros((1, group.dim))
        with jax.enable_x64(True):
            mean = traced.mean_force(jnp.asarray(g), jnp.asarray(W), 0.1, jnp.zeros(group.dim))
            pairs = (
                (mean, given.mean_force(*step, time=np.zeros(1))[0]),
                *(
                    (getattr(traced, name)(jnp.asarray(g)), getattr(given, name)(g))
                    for name in ("potential_energy", "potential_force")
                ),
            )
        for found, wanted in pairs:
            np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-11)


@pytest.mark.profile("routes", instead="test_forces_are_those_of_differences")
@pytest.mark.parametrize("scheme", ["energy", "variational"])
def test_rollout_is_the_run_and_its_derivatives_are_differences(scheme: str) -> None:
    """It has the numbers of `simulate`; derivatives by the start and by a number of the potential are differences."""
    orbit, states = (run(_well(0.8, scheme), steps=12, **START) for run in (nh.simulate, nh.rollout))
    for name in ("configuration", "momentum", "energy"):
        np.testing.assert_allclose(getattr(states, name), getattr(orbit, name), rtol=0, atol=1e-12)

    def end(stiffness: Any, turning: Any, run: Any = nh.rollout) -> Any:
        velocity = START["body_velocity"] * turning
        return run(_well(stiffness, scheme), steps=12, **{**START, "body_velocity": velocity}).configuration[-1, :2, 2]

    with jax.enable_x64(True):
        forward, reverse = (slope(end, (0, 1))(0.8, 1.0) for slope in (jax.jacfwd, jax.jacrev))
    h = 1e-5
    for i, found in enumerate(zip(forward, reverse, strict=True)):
        high, low = (end(*(np.array([0.8, 1.0]) + to), nh.simulate) for to in (h * np.eye(2)[i], -h * np.eye(2)[i]))
        wanted = (high - low) / (2 * h)
        for one in found:
            np.testing.assert_allclose(one, wanted, rtol=0, atol=1e-8)


def _branching(g: Any) -> Any:
    return g[0, 2] if g[0, 2] > 0 else 0.0


_BODY = dataclasses.replace(_well(1.0).system, potential=_branching)

# What JAX cannot trace is named; a force that is a function is none of numbers.
test_what_is_not_traced_is_refused = refusals(
    (_BODY, "be traceable by JAX on poses of SE.2."),
    (nh.Forced(_BODY.system, force=lambda _time, _g, v: 0 * v), "forces that are numbers"),
    ask=lambda system: nh.rollout(nh.discretize(system, 0.1), steps=2, **START),
)
