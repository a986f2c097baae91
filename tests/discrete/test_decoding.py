"""What is read of orbits of closed forms, compiled, against NumPy and the definitions; bits of a row in any company."""

import dataclasses
from typing import Any

import numpy as np
import pytest

import nonholo as nh
from nonholo.discrete._decoder import ClosedDisplacementDecoder, DisplacementDecoder
from nonholo.orbit._decoder import BodyDecoder, ClosedDecoder

TENSOR = np.array([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]])
PLANE = nh.ChaplyginSleigh(2.0, 0.7, -0.5, 0.3).homogeneous_mass_tensor
OBLIQUE = [[1.0, 0.3, 0.2], [0.1, 1.0, -0.5]]
BODIES = {
    "top": nh.SuslovTop(TENSOR),
    "tilted top": nh.SuslovTop(TENSOR, axis=(0.6, 0.0, 0.8)),
    "oblique top": nh.LLSystem(nh.SO(3), TENSOR, constraint_subspace=OBLIQUE),
    "rod": nh.SuslovTop(np.diag([0.0, 0.0, 1e-8]) + 1e-3 * np.outer([1.0, 2.0, 3.0], [1.0, 2.0, 3.0])),
    "sleigh": nh.ChaplyginSleigh(1.0, 1.0, 0.5),
    "offset sleigh": nh.ChaplyginSleigh(2.0, 0.7, -0.5, 0.3),
    "oblique sleigh": nh.LLSystem(nh.SE(2), PLANE, constraint_subspace=OBLIQUE),
}
READINGS = (
    *("body_velocity", "configuration", "displacement", "energy", "momentum", "multipliers"),
    *("restricted_momentum", "spatial_displacement", "spatial_momentum", "tangent"),
)


@pytest.fixture(params=BODIES)
def discrete(request: pytest.FixtureRequest) -> nh.Discretization:
    """Return a closed form."""
    return nh.discretize(BODIES[request.param], 0.3)


def rows_of(discrete: nh.Discretization) -> nh.Orbit:
    """Return an orbit of no run: random rows, rest, turns near 180 degrees, large numbers, and NaN at the end."""
    rng = np.random.default_rng(0)
    turn, sizes = rng.normal(size=(40, 2)), np.repeat([1e-9, 1.0, 30.0, 1e8], 10)[:, None]
    charts = np.concatenate([[[0.0, 0.0]], turn * sizes, [[1e75, 1.0], [np.nan, np.nan]]])
    momenta = np.concatenate([[[0.0, 0.0]], rng.normal(size=(41, 2)) * 10.0 ** rng.integers(-9, 9, (41, 1))])
    poses = rng.normal(size=(42, 4))
    poses[0], poses[1] = (1.0, 0.0, 0.0, 0.0), (1e-12, 1.0, 1e-7, 0.0)
    end = np.full((1, 4), np.nan)
    momenta, poses = np.concatenate([momenta, end[:, :2]]), np.concatenate([poses, end])
    time, good = 0.3 * np.arange(43), nh.simulate(discrete, momentum=(0.0, 0.0), steps=42)
    return dataclasses.replace(good, time=time, reduced_momentum=momenta, cayley=charts, canonical_pose=poses)


def close(result: np.ndarray, wanted: np.ndarray, size: Any = 1.0) -> None:
    """Compare rows to rounding, relative to the largest number of each, or to sizes of theirs."""
    axes = tuple(range(1, wanted.ndim))
    scale = np.maximum(np.nan_to_num(np.abs(wanted).max(axis=axes, keepdims=True)), size)
    assert (np.isnan(result) == np.isnan(wanted)).all()
    assert not (np.abs(result - wanted) > 2e-14 * scale).any()


def test_momenta_and_poses_are_those_of_any_body(discrete: nh.Discretization) -> None:
    """Compiled and by NumPy velocities, energies, matrices and positions are the same, of nasty rows too."""
    orbit, plain = rows_of(discrete), BodyDecoder(discrete.system)
    assert isinstance(discrete.decoder, ClosedDecoder)
    for name in ("body_velocity", "kinetic_energy", "configuration"):
        result, wanted = (getattr(decoder, name)(orbit) for decoder in (discrete.decoder, plain))
        close(result, wanted, 0.0 if name != "configuration" else 1.0)
    if discrete.system.group == nh.SE(2):
        close(discrete.decoder.position(orbit), plain.position(orbit))


def test_displacements_are_those_of_any_map(discrete: nh.Discretization) -> None:
    """Compiled and by NumPy momenta, matrices and multipliers are the same, of nasty rows too."""
    closed, plain, charts = discrete.displacement_decoder, DisplacementDecoder(discrete), rows_of(discrete).cayley
    assert isinstance(closed, ClosedDisplacementDecoder)
    assert charts is not None
    unit = np.abs(np.asarray(discrete.system.inertia_operator)).max() / 0.3  # of momenta: a half-turn in a step
    for side in ("left", "right"):
        close(closed.momentum(charts, side), plain.momentum(charts, side), unit)
    sound = charts[np.isfinite(charts).all(axis=1)]
    close(closed.displacement(sound), plain.displacement(sound))
    close(closed.displacement(sound[:6].reshape(2, 3, 2)), plain.displacement(sound[:6].reshape(2, 3, 2)))
    sizes = np.abs(plain.momentum(charts, "left")).max(axis=1, keepdims=True)
    ends = np.maximum(np.maximum(sizes[1:], sizes[:-1]), unit)
    close(closed.multipliers(charts[:-1], charts[1:]), plain.multipliers(charts[:-1], charts[1:]), np.nan_to_num(ends))


def test_tangents_are_those_of_any_map(discrete: nh.Discretization) -> None:
    """Compiled and by NumPy derivatives of steps are the same; where W + I cancels, NumPy loses its square."""
    charts = np.random.default_rng(1).normal(size=(200, 2)) / 2
    closed, plain = discrete.displacement_decoder, DisplacementDecoder(discrete)
    result, wanted = closed.tangent(charts), plain.tangent(charts)
    sizes = np.abs(wanted).max(axis=(1, 2), keepdims=True)  # near a fold they grow, and lose what they grow by
    lost = 1e-13 * sizes * (1 + sizes) * (1 + (charts**2).sum(axis=1)[:, None, None]) ** 2
    assert (np.abs(result - wanted) <= lost).all()
    assert np.array_equal(closed.tangent(np.zeros((1, 2)))[0], np.eye(2))
    assert np.isnan(closed.tangent(np.full((1, 2), np.nan))).all()


def test_tangents_near_a_half_turn() -> None:
    """Of a sleigh without arm turning and sliding part: derivatives are the identity at any angle."""
    charts = np.array([[1e2, 0.3], [1e4, -2.0], [1e6, 1e6]])
    result = nh.discretize(nh.ChaplyginSleigh(1.0, 2.0, 0.0), 0.1).displacement_decoder.tangent(charts)
    assert np.abs(result - np.eye(2)).max() <= 1e-9


@pytest.mark.parametrize("name", READINGS)
def test_a_row_has_its_bits_in_any_company(discrete: nh.Discretization, name: str) -> None:
    """What is read of two states alone, or of every second one, is what is read of all, to the bit."""
    orbit = nh.simulate(discrete, restricted_velocity=(0.4, -0.7), steps=30)
    whole = getattr(orbit, name)
    between = name in {"multipliers", "tangent"}
    for k in (0, 7, 29):
        assert np.array_equal(getattr(orbit[k : k + 2], name), whole[k : k + (1 if between else 2)])
    if not between:
        assert np.array_equal(getattr(orbit[::2], name), whole[::2])
    frozen = {each: rows.copy() for each, rows in orbit.rows().items()}
    for rows in frozen.values():
        rows.flags.writeable = False
    assert np.array_equal(getattr(orbit.of_rows(frozen), name), whole)
