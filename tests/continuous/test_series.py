"""Taylor series of the flow: their equations, what their steps depend on, accuracy over long times, singular starts."""

import functools
import itertools
import math
import pickle
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import mpmath
import numpy as np
import pytest
from comparisons import assert_same
from problems import EVERY as SYSTEMS
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

import nonholo as nh
from nonholo.continuous import _series
from nonholo.kernels import Quadratic, solve_series
from nonholo.kernels.taylor import _arrowhead, _solve, _steps
from nonholo.systems import AbstractSystem

TOP = nh.SuslovTop.from_inertia([[3.0, 0.1, 0.2], [0.1, 2.0, 0.3], [0.2, 0.3, 2.5]], (2 / 3, -1 / 3, 2 / 3))
SLEIGH = nh.ChaplyginSleigh(1.0, 1.0, 0.5, 0.3)
START = {"restricted_velocity": (0.8, -0.5)}


def _rate(f: Quadratic, x: np.ndarray) -> np.ndarray:
    """Return the rate that the quadratic equations state."""
    if len(f.forms):
        w = np.linalg.solve(f.forms @ x[-f.tensor.size :], f.momentum)
    else:
        w = f.velocities @ x[len(x) - len(f.velocities) :]
    z = np.append(np.concatenate([w, x[f.order]]), np.zeros(7))
    (left, eight), right = f.rows[:, :, None], np.arange(8)
    terms = f.factors[0] * np.append(z[left] * z[np.minimum(8 * eight + right, len(z) - 1)], w)[f.sources]
    rates = [terms[begin:end].sum() for begin, end in itertools.pairwise(f.first)]
    return np.array(rates)[np.argsort(f.order)]


@pytest.mark.parametrize("compact", [True, False])
@pytest.mark.parametrize("name", SYSTEMS)
def test_quadratic_equations_are_the_vector_field(name: str, compact: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """At random momenta and poses, compact or matrices; the tensor in space moves with the pose."""
    monkeypatch.setattr(_series, "_COMPACT", 1000 if compact else 0)
    system = SYSTEMS[name].canonical
    group, k, rng = system.group, len(system.constraint_subspace), np.random.default_rng(5)
    r, g = rng.normal(size=k), group.random(rng)
    f, expected = _series.quadratic.__wrapped__(system), nh.vector_field(system)(0.0, np.concatenate([r, g.ravel()]))
    velocity = system.restricted_velocity(r, g) @ system.constraint_subspace
    sizes = _series._own_numbers(system)[2]
    head, rates, pose, moved = r / sizes, expected[:k] / sizes, g.ravel(), expected[k:]
    if system.is_spatial:
        tensor, rate = system.homogeneous_mass_tensor, moved.reshape(g.shape)
        f, head = f._replace(momentum=r), (g @ tensor @ g.T).ravel()
        rates = (rate @ tensor @ g.T + g @ tensor @ rate.T).ravel()
    elif compact:
        pose = group.pose_from_matrix(g)
        moved = group.pose_rate(pose, velocity)
    turning = velocity[: 1 if group == nh.SE(2) else 0]
    result = _rate(f, np.concatenate([pose, np.ones_like(turning), head]))
    scale = 1e-13 * (1 + np.abs(expected).max(initial=0.0)) * (1 + np.abs(head).max(initial=0.0))
    assert np.abs(result - np.concatenate([moved, turning, rates])).max() <= scale


@pytest.mark.profile(
    "routes", cases=["right-invariant on SE(3)", "product", "veselova 4", "point*", "free on S?([34])", "any d*"]
)
@pytest.mark.parametrize("name", SYSTEMS)
def test_compact_poses_and_matrices_arrive_at_the_same_states(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Two systems of equations for one motion, backward in time, agree to 1e-12."""
    system = SYSTEMS[name]
    start = {"restricted_velocity": np.cos(1.0 + np.arange(len(system.constraint_subspace)))}
    result = []
    for compact in (1000, 0):
        monkeypatch.setattr(_series, "_COMPACT", compact)
        _series.quadratic.cache_clear()
        result.append(nh.flow(system, **start, times=(0.0, -1.0, -7.0)))
    _series.quadratic.cache_clear()
    for value in ("momentum", "configuration"):
        one, other = (getattr(orbit, value) for orbit in result)
        assert np.abs(one - other).max(initial=0.0) <= 1e-12 * (1 + np.abs(one).max(initial=0.0))


def test_blocks_are_the_components_that_reach_each_other() -> None:
    """Blocks of random edges are the strong components that SciPy finds; closed are those that nothing else moves."""
    rng = np.random.default_rng(3)
    for size in rng.integers(1, 20, 300):
        edges, lone = rng.integers(0, size, (2, rng.integers(0, 2 * size))), rng.integers(0, size, rng.integers(0, 3))
        labels, is_closed = _series._blocks(size, edges, lone)
        matrix = coo_array((np.ones(edges.shape[1]), tuple(edges)), (size, size))
        count, expected = connected_components(matrix, connection="strong")
        assert len(set(zip(labels.tolist(), expected.tolist(), strict=True))) == count == len(is_closed)
        for block in range(count):
            comes_from = labels[edges[0, labels[edges[1]] == block]]
            assert is_closed[block] == (not np.isin(block, labels[lone]) and bool((comes_from == block).all()))


def test_units_of_many_motions_are_those_of_each() -> None:
    """The power of two above a row is that of the row alone: at powers, beside them, of tiny numbers, and of none."""
    rows = np.random.default_rng(0).normal(size=(200, 3)) * 10.0 ** np.linspace(-320, 150, 200)[:, None]
    rows = np.vstack([rows, np.zeros(3), [0, -4, 1], [np.nextafter(4, 0), 0, 3.9], [np.nextafter(4, 5), 0, 0]])
    units = _series.power_of_two(rows)
    assert units.tolist() == [_series.power_of_two(row) for row in rows]
    assert units.tolist() == [math.ldexp(1.0, math.frexp(np.abs(row).max())[1]) for row in rows]
    assert units[-3:].tolist() == [8.0, 4.0, 8.0]


def test_kept_room_leaves_no_trace() -> None:
    """A flow has the same bits after another one of as many components, in its thread and in a new one."""
    flows = [functools.partial(nh.flow, TOP, restricted_velocity=w, times=(0.0, 9.0)) for w in ((0.8, -0.5), (90, 7))]
    result = [flow().canonical_pose for flow in (*flows, flows[0])]
    with ThreadPoolExecutor(1) as pool:
        result.append(pool.submit(flows[0]).result().canonical_pose)
    assert all(np.array_equal(result[0], again) for again in result[2:])
    assert not np.array_equal(result[0], result[1])


@pytest.mark.parametrize("size", [2.0**-400, 2.0**-40, 2.0**300])
@pytest.mark.parametrize(("system", "posed"), [(TOP, True), (SYSTEMS["sleigh 5"], False)], ids=["poses", "momenta"])
def test_units_of_time_change_no_bit(system: AbstractSystem, posed: bool, size: float) -> None:
    """A motion slower or quicker by a power of two takes the same path to the last bit."""
    velocity, times = np.cos(1.0 + np.arange(system.rank)) / 2, np.array([0.0, 3.0, 20.0])
    path, other = (
        nh.flow(system, restricted_velocity=velocity * factor, times=times / factor, reconstruct=posed)
        for factor in (1.0, size)
    )
    assert np.array_equal(path.reduced_momentum * size, other.reduced_momentum)
    assert not posed or np.array_equal(path.configuration, other.configuration)


@pytest.mark.parametrize("rtol", [1e-4, 1e-8, 1e-12])
def test_the_error_is_what_was_asked_for(rtol: float) -> None:
    """Over ten units of time the error is at most 30 times that of a step, and the end costs less than it."""
    for system in (TOP, SLEIGH):
        exact, result = (nh.flow(system, **START, times=(0.0, 10.0), rtol=r).configuration[-1] for r in (1e-14, rtol))
        assert 0 < np.abs(result - exact).max() <= 30 * rtol


@pytest.mark.parametrize(
    ("name", "end", "posed"),
    [
        ("veselova 4", 1e3, True),
        ("right-invariant on SE(2)", 1e3, True),
        ("suslov 6", 1e4, False),
        ("sleigh 5", 1e4, False),
    ],
)
def test_energy_is_kept_over_a_long_time(name: str, end: float, posed: bool) -> None:
    """Under constraints in space, and of momenta alone, to 1e-13: nothing in the equations knows of it."""
    velocity, times = np.cos(1.0 + np.arange(SYSTEMS[name].rank)) / 2, np.linspace(0.0, end, 11)
    orbit = nh.flow(SYSTEMS[name], restricted_velocity=velocity, times=times, reconstruct=posed)
    assert np.abs(orbit.energy / orbit.energy[0] - 1).max() <= 1e-13


@pytest.mark.parametrize("name", ["balanced top", "free body on SE(3)", "top on SO(7)"])
def test_nothing_gathers_over_a_long_time(name: str) -> None:
    """Over 1e4 units of time energy and group are kept to 1e-13 by the series alone: nothing is projected."""
    system = SYSTEMS[name].canonical
    group, k = system.group, len(system.constraint_subspace)
    r = system.restricted_momentum(np.cos(1.0 + np.arange(k)) / 2)
    compact = group.pose_size <= 40
    pose = group.pose_from_matrix(group.identity) if compact else group.identity.ravel()
    parts = pose, np.zeros(0), r
    (poses, _, momenta), _ = solve_series(_series.quadratic(system), parts, np.linspace(0.0, 1e4, 11), 1e-16)
    energies = (system.restricted_velocity(momenta) * momenta).sum(axis=-1)
    assert np.abs(energies / energies[0] - 1).max() <= 1e-13
    if group == nh.SO(3):
        assert np.abs((poses**2).sum(axis=-1) - 1).max() <= 1e-13
    else:
        g = group.matrix_from_pose(poses) if compact else poses.reshape(-1, group.size, group.size)
        g = g[:, : group.n, : group.n]
        assert np.abs(g @ g.swapaxes(-1, -2) - np.eye(group.n)).max() <= 1e-13


@pytest.mark.parametrize("degree", [8, 19, 28])
def test_roots_from_bits(degree: int) -> None:
    """To two digits of any positive number, also of one that is not normal; of none and of too much what is safe."""
    for x in (5e-324, 1e-310, 2.2e-308, 1e-300, 3e-17, 0.5, 1.0 - 2**-53, 1.0, 1.9999, 2.0, 7e5, 1.7e308):
        assert abs(_steps.root(x, degree) / float(mpmath.root(mpmath.mpf(x), degree)) - 1) <= 0.01
    assert 0 < _steps.root(0.0, degree) <= _steps.root(5e-324, degree)
    assert _steps.root(np.inf, degree) == np.inf


def test_a_sleigh_through_its_cusps() -> None:
    """Where the blade reverses the path has no velocity; so at the very start, and at rest."""
    still = nh.flow(SLEIGH, restricted_velocity=(0.0, 0.0), times=(0.0, 1.0, 1e140))
    assert np.array_equal(still.configuration, np.broadcast_to(np.eye(3), (3, 3, 3)))
    for velocity in ((0.8, 0.0), (1e-120, 0.0), (0.8, 1e-9), (0.0, 0.7)):
        length = 10.0 / max(velocity)
        orbits = [
            nh.flow(SLEIGH, restricted_velocity=velocity, times=np.linspace(-length, length, 9), method=method)
            for method in (None, "closed_form")
        ]
        reach = np.abs(orbits[1].position).max() + 1
        assert np.abs(orbits[0].position - orbits[1].position).max() <= 1e-12 * reach
        assert np.abs(orbits[0].heading - orbits[1].heading).max() <= 1e-12


@pytest.mark.parametrize("few", [False, True])
@pytest.mark.parametrize("posed", [True, False], ids=["poses", "momenta alone"])
@pytest.mark.parametrize("name", ["sleigh", "balanced top", "top on SO(7)", "right-invariant on SE(2)"])
def test_states_between_are_those_that_had_been_requested(
    name: str, posed: bool, few: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """`Orbit.at` gives the same bits in any order, forward and backward, also where most nodes were left out."""
    if few:
        monkeypatch.setattr(_solve, "_NUMBERS", 1000)
        monkeypatch.setattr(_arrowhead, "_NUMBERS", 0)
    k, rng = len(SYSTEMS[name].constraint_subspace), np.random.default_rng(2)
    start = {"restricted_velocity": np.cos(np.arange(k)), "reconstruct": posed}
    for first, last in ((1.0, 40.0), (40.0, 1.0)):
        times = np.sort(np.append(rng.uniform(1.0, 40.0, 50), [1.0, 40.0]))[:: 1 if last > first else -1]
        wanted, ends = (nh.flow(SYSTEMS[name], **start, times=t) for t in (times, (first, last)))
        columns = [x for x in ("reduced_momentum", "canonical_pose", "turned") if getattr(wanted, x) is not None]
        assert_same(ends, wanted.chosen(np.array([0, -1])), *columns)
        mixed = rng.permutation(len(times))
        result = ends[-1:].at(times[mixed])
        assert_same(result, wanted.chosen(mixed), *columns)
        one = pickle.loads(pickle.dumps(ends)).at(times[7])  # noqa: S301
        assert np.array_equal(one.reduced_momentum[0], wanted.reduced_momentum[7])


def test_what_a_long_flow_keeps_is_bounded(monkeypatch: pytest.MonkeyPatch) -> None:
    """Beginnings of steps fill no more than their room, also where more steps lie between two than one block takes."""
    monkeypatch.setattr(_solve, "_NUMBERS", 1000)
    orbit = nh.flow(SYSTEMS["balanced top"], restricted_velocity=(1.0, 0.5), times=(0.0, 20_000.0))
    assert orbit.motion.solution.nodes.size <= 1000


@pytest.mark.parametrize("method", ["closed_form", "diffrax"])
def test_states_between_by_other_methods(method: str) -> None:
    """Closed forms are evaluated, diffrax solves again; times may repeat."""
    for system in (SLEIGH, TOP):
        ends = nh.flow(system, **START, times=(2.0, -6.0), method=method, rtol=1e-12)
        wanted = nh.flow(system, **START, times=(2.0, 2.0 - 1e-3, -4.0, -6.0))
        result = ends.at((-4.0, 2.0, -4.0, -6.0, 2.0 - 1e-3))
        at = [2, 0, 2, 3, 1]
        assert np.abs(result.momentum - wanted.momentum[at]).max() <= 1e-9
        assert np.abs(result.configuration - wanted.configuration[at]).max() <= 1e-9


def test_states_between_that_nobody_knows(tmp_path: Path) -> None:
    """Times outside, what is no time, discrete orbits, flows from files."""
    orbit = nh.flow(SLEIGH, **START, times=(0.0, 1.0))
    for times in (1.0 + 1e-12, [0.5, -0.1], np.nan, "0.5", [[0.5]], None):
        with pytest.raises(ValueError, match=r"Orbit.at\(times=...\)"):
            orbit.at(times)
    assert len(orbit.at([])) == 0
    nh.save_orbit(orbit, tmp_path / "flow.zarr")
    loaded = nh.load_orbit(tmp_path / "flow.zarr")
    for other in (loaded, nh.simulate(nh.discretize(SLEIGH, 0.1), **START, steps=3)):
        with pytest.raises(ValueError, match=r"Orbit.at\(...\)"):
            other.at(0.1)


def test_a_failed_flow_is_known_up_to_where_it_came() -> None:
    """A solve that cannot meet the tolerances ends with the good states; past the last one nothing is known."""
    start = {"restricted_velocity": (1e140, 2e140), "rtol": 1e-14, "atol": 1e-300}
    with pytest.raises(nh.OutcomeError, match=r"from time 2e-141 to 1 \(rtol 1e-14, atol 1e-300\)") as failure:
        nh.flow(TOP, **start, times=(0.0, 1e-141, 2e-141, 1.0))
    orbit = failure.value.orbit
    assert (failure.value.outcome, len(orbit)) == (nh.Outcome.not_converged, 3)
    assert len(orbit.at(1.5e-141)) == 1
    with pytest.raises(ValueError, match="lie between"):
        orbit.at(3e-141)
