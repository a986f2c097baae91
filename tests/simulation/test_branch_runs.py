"""Runs by a branch rule: the same orbit where the rule means the same value, and orbits off the principal branch."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from bodies import GENERAL
from problems import EVERY
from refusals import refusals

import nonholo as nh

TOP = nh.discretize(nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]]), 0.3)
ALONG = {"restricted_velocity": None, "body_velocity": [[1.0, 0.0, 0.0]]}
FAMILIES = {"top": TOP, "tilted top": nh.discretize(EVERY["tilted top"], 0.2)}
FAMILIES |= {name: nh.discretize(EVERY[name], 0.1) for name in ("suslov 4", "offset sleigh", "sleigh 3")}


@pytest.mark.parametrize("branch", ["nearest", "smallest"])
@pytest.mark.parametrize("name", FAMILIES)
def test_small_steps_stay_principal(name: str, branch: str) -> None:
    """Where the step is small the nearest and the smallest value are the principal one, and all decodes alike."""
    discrete = FAMILIES[name]
    start = {"restricted_velocity": 0.3 * np.arange(1, 1 + discrete.system.rank), "steps": 20}
    principal, other = (nh.simulate(discrete, **start, branch=rule) for rule in ("principal", branch))
    for quantity in ("time", "momentum", "displacement", "configuration", "multipliers", "energy", "body_velocity"):
        missed = np.abs(getattr(other, quantity) - getattr(principal, quantity)).max()
        assert missed < 1e-13 * max(1.0, np.abs(getattr(principal, quantity)).max()), quantity


@pytest.mark.parametrize("name", FAMILIES)
def test_every_real_value_goes_on(name: str) -> None:
    """From each real displacement over a momentum "nearest" takes values of the map, on the variety, at one energy."""
    discrete = FAMILIES[name]
    found = nh.displacements_over(discrete, 0.2 * np.ones(len(discrete.system.constraint_subspace)))
    for W in found.displacement[found.is_real].real:
        orbit = nh.simulate(discrete, displacement=W, steps=20, branch="nearest")
        arriving = nh.discrete_legendre(discrete, orbit.displacement[:-1], "right")
        jump = discrete.system.restrict(orbit.momentum[1:] - arriving)
        assert np.abs(jump).max() < 1e-12 * np.abs(orbit.momentum).max()
        assert np.abs(discrete.constraint_residual(orbit)).max() < 1e-11  # logarithms of nearly half-turns
        assert np.ptp(orbit.energy) < 1e-12 * orbit.energy[0]
        posed = orbit.configuration[:-1] @ orbit.displacement[:-1]
        np.testing.assert_allclose(posed, orbit.configuration[1:], rtol=1e-12, atol=1e-12)


def _off_principal() -> np.ndarray:
    return nh.displacements_over(TOP, [0.2, 0.3]).displacement[1].real


def test_the_principal_rule_refuses_that_start() -> None:
    """And says how to continue from there."""
    with pytest.raises(nh.OutcomeError, match=r"Start of the run: branch_unverified.*branch='nearest' continues"):
        nh.simulate(TOP, displacement=_off_principal(), steps=3)


def test_a_full_momentum_names_the_same_start() -> None:
    """A full momentum on the locus off the principal branch starts at its displacement."""
    W = _off_principal()
    starts = {"displacement": W}, {"momentum": nh.discrete_legendre(TOP, W)}
    orbits = [nh.simulate(TOP, **start, steps=5, branch="nearest") for start in starts]
    np.testing.assert_allclose(orbits[0].displacement, orbits[1].displacement, rtol=0, atol=1e-12)


def test_the_definition_follows_the_same_values() -> None:
    """backend="jax" follows the root in matrices, here next to half a turn, and finds the same orbit."""
    start = {"displacement": _off_principal(), "steps": 5, "branch": "nearest"}
    compact, defined = nh.simulate(TOP, **start), nh.simulate(TOP, **start, backend="jax")
    np.testing.assert_allclose(defined.displacement, compact.displacement, rtol=0, atol=1e-12)


@pytest.mark.profile("routes", instead="test_the_definition_follows_the_same_values")
def test_other_systems_follow_by_their_definition() -> None:
    """Where not all values are known "nearest" continues a root: here from a later displacement of the same orbit."""
    discrete = nh.discretize(GENERAL["any d on SO(4)"][0], 0.1)
    whole = nh.simulate(discrete, restricted_velocity=GENERAL["any d on SO(4)"][1], steps=8)
    later = nh.simulate(discrete, displacement=whole.displacement[3], steps=5, branch="nearest")
    np.testing.assert_allclose(later.momentum, whole.momentum[3:], rtol=0, atol=1e-12)


def test_thinned_runs_keep_every_so_many_states() -> None:
    """Saved states are those of the whole run; multipliers of steps that are gone are refused with the remedy."""
    start = {"displacement": _off_principal(), "branch": "nearest"}
    whole, thin = nh.simulate(TOP, **start, steps=12), nh.simulate(TOP, **start, steps=13, save_every=4)
    assert np.array_equal(thin.displacement, whole.displacement[::4])
    assert np.array_equal(thin.configuration, whole.configuration[::4])
    assert whole.multipliers.shape == (12, 1)
    with pytest.raises(ValueError, match=r"`Orbit\.multipliers` must have all states.*Run with save_every=1"):
        _ = thin.multipliers


def test_stores_remember_the_rule(tmp_path: Path) -> None:
    """A loaded orbit knows by which rule it was made; a function is remembered as such."""
    for rule, name in (("largest", "largest"), (lambda found, _: int(np.flatnonzero(found.is_real)[0]), "callable")):
        orbit = nh.simulate(TOP, momentum=[0.2, 0.3], steps=2, branch=rule)
        nh.save_orbit(orbit, tmp_path / f"{name}.zarr")
        loaded = nh.load_orbit(tmp_path / f"{name}.zarr")
        assert loaded.branch == name
        assert np.array_equal(loaded.displacement, orbit.displacement)


def _chosen(found: Any, _: np.ndarray) -> int:
    """Choose the real value that comes last."""
    return int(np.flatnonzero(found.is_real)[-1])


@pytest.mark.parametrize("branch", ["nearest", "largest", "outer", _chosen])
def test_members_of_an_ensemble_take_the_rule(branch: Any) -> None:
    """Off the principal branch, from displacements, members have the bits of their runs alone, decoded too."""
    later = nh.simulate(TOP, momentum=[0.2, 0.3], steps=1).displacement[1]
    starts = np.stack([_off_principal(), later][: 1 if branch == "outer" else 2])
    batch = nh.ensemble(TOP, displacement=starts, steps=6, save_every=1, branch=branch)
    for member, W in enumerate(starts):
        alone, orbit = nh.simulate(TOP, displacement=W, steps=6, branch=branch), batch.orbit(member)
        assert orbit.branch == alone.branch == batch.branch
        for name in ("time", "displacement", "momentum", "multipliers", "configuration", "energy", "body_velocity"):
            assert np.array_equal(getattr(orbit, name), getattr(alone, name)), name
            assert np.array_equal(getattr(batch, name)[member][: len(getattr(alone, name))], getattr(alone, name)), name
    assert batch.to_dataset().attrs["branch"] == batch.branch
    principal = nh.ensemble(TOP, momentum=batch.restricted_momentum[:, 0], steps=1, save_every=1)
    assert np.abs(batch.displacement[0, 0] - principal.displacement[0, 0]).max() > 0.1


SLEIGH = nh.ChaplyginSleigh(1.0, 1.0, 0.5)
WITHOUT_RULES = (
    nh.discretize(SLEIGH, 0.1, order=4),
    nh.discretize(nh.Forced(SLEIGH, nh.Gravity([0.2, -1.0], [0.5, 0.1])), 0.1),
    nh.discretize(nh.examples.particle().system, 0.1),
)
# In the words of a single run, with the number of the member where it is that member's; motions without rules, too.
test_rules_that_members_cannot_take_are_refused = refusals(
    ({"branch": "next"}, r"`ensemble\(branch=\.\.\.\)` must be"),
    ({"branch": "nearest", "backend": "numba"}, r"`ensemble\(backend=\.\.\.\)` must be 'auto' or 'jax'"),
    ({"branch": "inner", "restricted_velocity": [[0.1, 0.1], [3.0, 0.0]]}, r"'inner' and an energy.*member 1\."),
    ({"branch": lambda found, _: len(found)}, r"return the index of a real branch.*member 0\."),
    ({"branch": "nearest", "events": [lambda orbit: orbit.energy]}, "part of a step"),
    *(({"discrete": each, **ALONG, "branch": "nearest"}, "branch") for each in WITHOUT_RULES),
    ({"discrete": SLEIGH, **ALONG, "branch": "nearest", "steps": None, "times": (0.0, 1.0)}, "branch"),
    ask=lambda given: nh.ensemble(**{"discrete": TOP, "restricted_velocity": [[0.1, 0.1]], "steps": 3} | given),
)
