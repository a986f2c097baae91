"""How runs end: three failures that are never confused, and good steps that are kept."""

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from refusals import refusals

import nonholo as nh
from nonholo.lagrange_dalembert import LagrangeDAlembert, _discretization
from nonholo.lagrange_dalembert._newton import solve
from nonholo.lagrange_dalembert.functions import in_double

FORCE = 0.15


def pushed(q, v):  # noqa: ANN001, ANN201
    """Return the Lagrangian of a particle under a constant force."""
    return v @ v / 2 + FORCE * jnp.sum(q)


def folded(q, q_next, h):  # noqa: ANN001, ANN201
    """Return a discrete Lagrangian whose momentum is sin(q' - q) at most: a fold at a right angle."""
    return jnp.sum(1 - jnp.cos(q_next - q)) / h + h * FORCE * jnp.sum(q + q_next) / 2


FOLDING = LagrangeDAlembert(pushed, None, dimension=1, discrete_lagrangian=folded)


def test_a_run_ends_where_the_branch_folds() -> None:
    """sin(d_k) = sin(d_0) + k F exceeds 1 at a known step; the steps before it are kept."""
    orbit = nh.simulate(nh.discretize(FOLDING, 1.0), configuration=[0.0], body_velocity=[0.1], steps=20, throw=False)
    sines = 0.1 + FORCE / 2 + FORCE * np.arange(20)
    assert orbit.outcome == nh.Outcome.no_real_branch
    assert len(orbit) == np.sum(sines < 1)
    assert np.abs(np.sin(orbit.displacement[:, 0]) - sines[: len(orbit)]).max() <= 1e-14


def test_the_error_names_the_step_and_carries_the_orbit() -> None:
    """With throw the same run raises, with the good steps."""
    with pytest.raises(nh.OutcomeError, match=r"Step 6 of 20 \(time_step 1\): no_real_branch") as caught:
        nh.simulate(nh.discretize(FOLDING, 1.0), configuration=[0.0], body_velocity=[0.1], steps=20)
    assert len(caught.value.orbit) == 6


def test_blocks_end_where_the_branch_folds() -> None:
    """The good steps come first; then the run raises, or the last block says why it ends."""
    how = {"configuration": [0.0], "body_velocity": [0.1], "steps": 20, "block_steps": 4}
    blocks = nh.iterate(nh.discretize(FOLDING, 1.0), **how)
    assert [len(next(blocks)), len(next(blocks))] == [4, 2]
    with pytest.raises(nh.OutcomeError, match=r"Step 6 of 20 \(time_step 1\): no_real_branch"):
        next(blocks)
    *good, last = nh.iterate(nh.discretize(FOLDING, 1.0), **how, throw=False)
    assert [each.outcome for each in (*good, last)] == [nh.Outcome.successful, nh.Outcome.no_real_branch]
    with pytest.raises(nh.OutcomeError, match=r"Start of the run.*no_real_branch"):
        next(nh.iterate(nh.discretize(FOLDING, 1.0), **how | {"body_velocity": [1.5]}))


def test_a_step_that_is_not_trusted_is_taken_by_continuation(monkeypatch: pytest.MonkeyPatch) -> None:
    """Next to the fold Newton's corrections shrink too slowly: JAX takes that step alone, whatever is saved."""
    steps: list[str] = []

    def noted(function: Callable[..., Any], *arguments: Any) -> Any:
        steps.append(function.__name__)
        return in_double(function, *arguments)

    monkeypatch.setattr(_discretization, "in_double", noted)
    last = 1 - 1e-8
    how = {"configuration": [0.0], "displacement": [np.arcsin(last - 6 * FORCE)], "steps": 6}
    orbits = [nh.simulate(nh.discretize(FOLDING, 1.0), **how, save_every=every) for every in (1, 2, 3)]
    assert steps.count("_advance") == len(orbits)
    assert abs(orbits[0].displacement[-1, 0] - np.arcsin(last)) <= 1e-14 / np.sqrt(1 - last**2)
    for every, orbit in zip((2, 3), orbits[1:], strict=True):
        assert np.array_equal(orbit.displacement, orbits[0].displacement[::every])
        assert np.array_equal(orbit.multipliers, orbits[0].multipliers[::every])


# A momentum above the largest one, and the fold itself, where the matrix is singular to rounding.
test_a_start_at_or_beyond_the_fold_is_refused = refusals(
    ({"body_velocity": [1.5]}, "no_real_branch"),
    ({"displacement": [np.pi / 2]}, "no_real_branch"),
    ask=lambda start: nh.simulate(nh.discretize(FOLDING, 1.0), configuration=[0.0], steps=3, **start),
    kind=nh.OutcomeError,
    begin="Start of the run.*",
)


def test_regularity_vanishes_at_the_fold() -> None:
    """For this discrete Lagrangian the regularity is |cos d|."""
    for d in (0.5, 1.5, np.pi / 2):
        assert abs(FOLDING.regularity([0.0], [d], time_step=1.0) - np.cos(d)) <= 1e-15


def test_a_momentum_in_a_gap_is_not_a_fold() -> None:
    """A kink leaves out momenta between -1 and 1: the iteration fails though the matrix is regular."""
    kinked = LagrangeDAlembert(
        lambda _, v: v @ v / 2,
        None,
        dimension=1,
        discrete_lagrangian=lambda q, r, h: jnp.sum((r - q) ** 2 / (2 * h) + jnp.abs(r - q)),
    )
    orbit = nh.simulate(nh.discretize(kinked, 1.0), configuration=[0.0], momentum=[0.5], steps=3, throw=False)
    assert orbit.outcome == nh.Outcome.not_converged


def test_leaving_the_domain_is_nonfinite() -> None:
    """A potential that is undefined beyond 1 ends the run with the states before."""
    walled = LagrangeDAlembert(lambda q, v: v @ v / 2 + jnp.sqrt(1 - q @ q), None, dimension=1)
    orbit = nh.simulate(nh.discretize(walled, 0.1), configuration=[0.0], body_velocity=[3.0], steps=30, throw=False)
    assert orbit.outcome == nh.Outcome.nonfinite
    assert 1 <= len(orbit) <= 4
    assert np.all(np.isfinite(orbit.configuration))


@pytest.mark.parametrize(
    ("near", "guess", "outcome", "root"),
    [
        (0.5, 0.5, nh.Outcome.successful, 1.0),
        (0.5, 2.2, nh.Outcome.successful, 1.0),
        (2.2, 2.2, nh.Outcome.branch_unverified, None),
    ],
    ids=["plain", "guess on the other branch", "only the other branch"],
)
def test_the_branch_is_followed_not_guessed(near: float, guess: float, outcome: nh.Outcome, root: float | None) -> None:
    """Sin d = sin 1 has the roots 1 and pi - 1: a good guess of the wrong one is recognized by its orientation."""
    with jax.enable_x64(True):
        one = jnp.ones(())
        p = jnp.array([np.sin(1.0) + FORCE / 2 - FORCE])
        v, _, code = jax.jit(solve, static_argnums=0)(
            FOLDING, one, jnp.zeros(1), p + FORCE / 2, jnp.array([near]), jnp.array([guess]), one
        )
    assert int(code) == outcome
    assert root is None or abs(float(v[0]) - np.arcsin(np.sin(1.0) + FORCE / 2)) <= 0.1
