"""Momenta of tops and sleighs without poses, in O(n): against the definition, with poses, and in many dimensions."""

import tracemalloc

import numpy as np
import pytest
from bodies import ATTRACTING, mass_tensor, random_rows
from problems import EVERY

import nonholo as nh
from nonholo.continuous import _solvers
from nonholo.systems import AbstractLLSystem

RNG = np.random.default_rng(29)


def _top(n: int, coupling: np.ndarray, values: np.ndarray) -> nh.SuslovTop:
    """Return a top with an axis and principal axes of B that are turned at random."""
    J = np.diag(np.append(values, 1.0))
    J[-1, :-1] = J[:-1, -1] = coupling
    turn = np.eye(n)
    turn[:-1, :-1] = nh.SO(n - 1).random(RNG)
    return nh.SuslovTop(turn @ J @ turn.T)


def _in_other_axes(n: int) -> nh.LLSystem:
    """Return a top with oblique rows about an oblique axis."""
    g = nh.SO(n).random(RNG)
    rows = random_rows(nh.SO(n), n - 1, RNG)[:, : n - 1] @ nh.SuslovTop(np.eye(n)).constraint_subspace
    return nh.LLSystem(nh.SO(n), mass_tensor(nh.SO(n), RNG), rows @ nh.SO(n).adjoint(g).T)


SYSTEMS = {
    **{name: EVERY[name] for name in ("top", "tilted top", "suslov 4", "top on SO(7)", "sleigh 3", "sleigh 5")},
    "top 12": nh.SuslovTop(mass_tensor(nh.SO(12), RNG)),
    "plane sleigh": nh.ChaplyginSleigh(1.0, 1.0, 0.5, 0.3),
    "sleigh without an arm": ATTRACTING["turning sleigh 4"],
    "top in other axes": _in_other_axes(5),
    "balanced": _top(5, np.zeros(4), np.arange(1.0, 5.0)),
    "c along an eigenvector": _top(5, np.array([0.0, 0.3, 0.0, 0.0]), np.arange(1.0, 5.0)),
    "equal eigenvalues": _top(5, 0.2 * RNG.normal(size=4), np.ones(4)),
    "a long body": _top(6, 1e-4 * RNG.normal(size=5), np.logspace(-6, 6, 5)),
    "arrowhead top": nh.SuslovTop.arrowhead(RNG.uniform(1, 2, 6), 0.3 * RNG.normal(size=5)),
    "arrowhead sleigh": nh.MultidimensionalSleigh.arrowhead(
        0.7, RNG.normal(size=6), RNG.uniform(1, 2, 6), 0.3 * RNG.normal(size=5)
    ),
}


def _velocity(system: AbstractLLSystem) -> np.ndarray:
    return np.cos(1.0 + np.arange(system.rank)) / 2


@pytest.mark.parametrize("name", SYSTEMS)
def test_the_equations_are_the_vector_field(name: str) -> None:
    """The rates of the momenta are those of the definition, at several momenta and at rest."""
    system = SYSTEMS[name].canonical
    form, field = system.normal_form, nh.vector_field(system)
    f, pose = _solvers.arrowhead(form)[0], system.group.identity.ravel()
    for size in (1.0, 1e3, 0.0):
        r = system.restricted_momentum(size * RNG.normal(size=system.rank))
        x = _solvers.encode(form, r)
        rate = (f.coupling @ x) * f.rates * x - (f.rates * x @ x) * f.coupling
        expected = field(0.0, np.append(r, pose))[: system.rank]
        scale = np.abs(f.coupling).max() * f.rates.max() * (x @ x) * np.abs(_solvers.decode(form, np.eye(len(x)))).max()
        assert np.abs(_solvers.decode(form, rate[None])[0] - expected).max() <= 1e-13 * scale
        assert np.abs(_solvers.decode(form, x[None])[0] - r).max() <= 1e-14 * np.abs(r).max()


@pytest.mark.profile("routes", cases=["top in other axes", "top 12"])
@pytest.mark.parametrize("name", SYSTEMS)
def test_momenta_alone_are_those_with_poses(name: str) -> None:
    """Forward and backward, to rounding; the energy too."""
    system = SYSTEMS[name]
    start = {"restricted_velocity": _velocity(system), "times": np.array([2.0, 2.5, 9.0]) * (-1) ** len(name)}
    alone, posed = (nh.flow(system, **start, reconstruct=poses) for poses in (False, True))
    size = np.abs(posed.restricted_momentum).max()
    assert np.abs(alone.restricted_momentum - posed.restricted_momentum).max() <= 1e-14 * size
    assert np.abs(alone.energy / posed.energy - 1).max() <= 1e-14
    assert alone.pose is None
    assert alone.turned is None


def test_at_rest_and_at_an_equilibrium() -> None:
    """Nothing moves from rest; a turn along c stays."""
    top = SYSTEMS["arrowhead top"]
    for velocity in (np.zeros(5), -top.coupling):
        orbit = nh.flow(top, restricted_velocity=velocity, times=(0.0, 1.0, 5.0), reconstruct=False)
        first = top.restricted_momentum(velocity)
        assert np.abs(orbit.restricted_momentum - first).max() <= 1e-15 * np.abs(first).max()


def test_a_hundred_thousand_dimensions() -> None:
    """Memory is that of the series, the energy is kept; what has n x n numbers is refused, with what to do."""
    n = 100_000
    top = nh.SuslovTop.arrowhead(RNG.uniform(1, 2, n), RNG.normal(size=n - 1) / np.sqrt(n))
    start = {"restricted_velocity": RNG.normal(size=n - 1) / np.sqrt(n), "times": (0.0, 0.1, 0.2)}
    tracemalloc.start()
    orbit = nh.flow(top, **start, reconstruct=False)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak <= 60 * 8 * n
    assert np.ptp(orbit.energy) <= 1e-14
    assert np.abs(np.diff(orbit.restricted_momentum, axis=0)).max() >= 1e-4
    for name in ("momentum", "body_velocity", "multipliers"):
        with pytest.raises(ValueError, match=r"Use restricted_momentum, chart and energy, and reconstruct=False"):
            getattr(orbit, name)
    with pytest.raises(ValueError, match=r"flow\(times=...\).*reconstruct=False"):
        nh.flow(top, **start)
    again = nh.flow(top, momentum=orbit.restricted_momentum[1], times=(0.1, 0.2), reconstruct=False)
    assert np.abs(again.restricted_momentum[-1] - orbit.restricted_momentum[-1]).max() <= 1e-15


@pytest.mark.parametrize("method", [None, "closed_form"])
def test_other_motions_leave_their_poses_out(method: str | None) -> None:
    """Other systems and methods solve for poses and do not keep them: the momenta have the same bits."""
    body = nh.RigidBody(np.diag([1.0, 2.0, 3.0])) if method is None else SYSTEMS["plane sleigh"]
    start = {"restricted_velocity": np.ones(body.rank), "times": (0.0, 1.0, 3.0), "method": method}
    alone, posed = (nh.flow(body, **start, reconstruct=poses) for poses in (False, True))
    assert np.array_equal(alone.reduced_momentum, posed.reduced_momentum)
    assert np.array_equal(alone.at(2.0).reduced_momentum, posed.at(2.0).reduced_momentum)
    assert alone.pose is alone.turned is alone.at(2.0).pose is None


def test_an_event_of_momenta_alone() -> None:
    """A crossing is found on the series, where poses are not known."""
    top = SYSTEMS["suslov 4"]
    start = {"restricted_velocity": _velocity(top), "times": (0.0, 9.0), "reconstruct": False}
    middle = nh.flow(top, **start).at(4.0).restricted_momentum[0, 0]
    result = nh.flow(top, **start, events=[lambda orbit: orbit.restricted_momentum[:, 0] - middle]).events[0]
    assert np.abs(result.time - 4.0).min() <= 1e-12
