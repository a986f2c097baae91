"""The step in O(n) against the general matrix step, in its singular cases, and with very many dimensions."""

import numpy as np
import pytest
from bodies import mass_tensor, random_rows
from refusals import refusals

import nonholo as nh
from nonholo import kernels
from nonholo.discrete.routes import make_route
from nonholo.kernels.general import _step
from nonholo.kernels.general._rows import decompose, solve_rows
from nonholo.kernels.secular._root import certain_radius, level_of


def top(n: int, rng: np.random.Generator) -> nh.SuslovTop:
    """Return a random top."""
    return nh.SuslovTop(mass_tensor(nh.SO(n), rng))


def sleigh(n: int, rng: np.random.Generator) -> nh.MultidimensionalSleigh:
    """Return a random sleigh."""
    return nh.MultidimensionalSleigh(1.3, 0.4 * rng.normal(size=n), mass_tensor(nh.SO(n), rng))


def arrowhead(n: int, rng: np.random.Generator) -> nh.MultidimensionalSleigh:
    """Return a random sleigh in the axes of its inertia."""
    diagonal, coupling = rng.uniform(1, 2, n), 0.1 * rng.normal(size=n - 1)
    return nh.MultidimensionalSleigh.arrowhead(1.3, 0.4 * rng.normal(size=n), diagonal, coupling)


SPECIAL = {
    "no coupling": nh.SuslovTop(np.diag([1.0, 2.0, 3.0, 4.0])),
    "equal eigenvalues": nh.SuslovTop(np.eye(5) + 0.1 * np.outer(*2 * [np.ones(5)])),
    "coupling along an eigenvector": nh.SuslovTop.arrowhead([1.0, 2.0, 3.0, 1.5], [0.0, 0.4, 0.0]).dense,
    "balanced sleigh": nh.MultidimensionalSleigh(1.0, [0.0, 0.0, 0.0], np.eye(3)),
    "sleigh without arm": nh.MultidimensionalSleigh(1.0, [0.0, 0.3, -0.2], [[1, 0.2, 0.1], [0.2, 2, 0], [0.1, 0, 1.5]]),
    "sleigh without coupling": nh.MultidimensionalSleigh(1.0, [-0.5, 0.0, 0.0], np.diag([1.0, 2.0, 3.0])),
    "flat top": nh.SuslovTop(np.diag([0.0, 0.0, 1.0, 2.0]) + 0.1 * np.eye(4)[::-1]),
}


def equal_steps(system: nh.SuslovTop | nh.MultidimensionalSleigh, h: float, rows: np.ndarray) -> None:
    """Compare one step of both kernels from states with these momenta."""
    discrete = nh.discretize(system, h)
    general, secular = make_route(discrete, "matrix"), discrete.route
    start = np.zeros_like(rows)
    for r in rows:
        code, state = kernels.runs_of(general.body).start(
            general.body, general.scale * r, np.eye(system.group.size).ravel()
        )
        other, same = kernels.runs_of(secular.body).start(secular.body, secular.encode(r), np.empty(0))
        assert code == other == 0
        chart = kernels.runs_of(general.body).chart_of(general.body, state)
        assert np.allclose(
            secular.from_kernel(kernels.runs_of(secular.body).chart_of(secular.body, same)), chart, rtol=0, atol=1e-13
        )
        one, _, _ = kernels.step_each(general.body, (general.scale * r[None], chart[None], None), start[:1], True)
        turned = secular.to_kernel(chart[None])
        two, _, _ = kernels.step_each(secular.body, (secular.encode(r)[None], turned, None), start[:1], True)
        scale = np.abs(r).max()
        assert np.allclose(secular.decode(two), one / general.scale, rtol=0, atol=1e-13 * scale)


@pytest.mark.parametrize("n", [4, 5, 9, 20])
@pytest.mark.parametrize("make", [top, sleigh])
def test_the_matrix_equations(make, n: int) -> None:  # noqa: ANN001
    """Displacements and momenta agree with those from the matrix equations, with turns up to about 60 degrees."""
    rng = np.random.default_rng(n)
    system = make(n, rng)
    rows = system.restricted_momentum(rng.normal(size=(6, system.rank)) / np.sqrt(n))
    equal_steps(system, 0.3, rows * np.linspace(0.1, 1.0, 6)[:, None])


@pytest.mark.parametrize("name", SPECIAL)
def test_singular_bodies(name: str) -> None:
    """Without coupling, arm or distinct eigenvalues, and at rest, the matrix equations still give the same step."""
    system = SPECIAL[name]
    rows = system.restricted_momentum(np.random.default_rng(0).normal(size=(3, system.rank)))
    equal_steps(system, 0.2, rows * np.array([[0.0], [0.5], [1.0]]))


@pytest.mark.parametrize("make", [top, sleigh])
def test_no_other_root_is_certain(make) -> None:  # noqa: ANN001
    """Of all real displacements over momenta that the ball certifies, only the principal one lies in it."""
    rng, others = np.random.default_rng(7), 0
    for _ in range(12):
        system = make(4 if make is top else 3, rng)
        discrete = nh.discretize(system, 1.0)
        step = discrete.route
        k = len(step.body.b)
        r = system.restricted_momentum(rng.normal(size=system.rank))
        for share in 2.0 ** -np.arange(10):
            m = step.encode(share * r)
            radius = certain_radius(step.body, level_of(step.body, m[:k], m[-1] if step.body.slides else 0.0))
            if radius > 0:
                break
        assert radius > 0
        result = nh.displacements_over(discrete, share * r)
        for index in np.flatnonzero(result.is_real):
            W = result.displacement[index].real
            K = system.group.vee((W - system.group.inverse(W)) / 2) @ system.constraint_subspace.T
            x = step.to_kernel(K)[:k]
            lever = step.body.mass * step.body.arm**2
            below_right_angle = np.trace(W[: system.group.n, : system.group.n]) > system.group.n - 2
            certain = (step.body.b + lever) @ x**2 <= radius and below_right_angle
            assert certain == (index == result.principal)
            others += index != result.principal
    assert others >= 6


@pytest.mark.parametrize("make", [top, sleigh, arrowhead])
def test_poses_and_energy_over_many_steps(make) -> None:  # noqa: ANN001
    """Group and energy are kept to rounding over 20,000 steps; poses follow from the displacements."""
    rng = np.random.default_rng(3)
    system = make(6, rng)
    orbit = nh.simulate(nh.discretize(system, 0.1), restricted_velocity=0.5 * rng.normal(size=system.rank), steps=20000)
    assert np.ptp(orbit.energy) <= 1e-14 * orbit.energy[0]
    states = orbit[19_900:]
    g, W = states.configuration, states.displacement
    scale = np.abs(g).max()
    assert np.abs(g[1:] - g[:-1] @ W[:-1]).max() <= 1e-12 * scale  # rounding of 20,000 reflections, before projection
    rotations = orbit.pose[-1][: system.group.n**2].reshape(system.group.n, -1)
    assert np.abs(rotations @ rotations.T - np.eye(system.group.n)).max() <= 1e-12


def test_a_hundred_thousand_dimensions() -> None:
    """Momenta, charts and energy of SO(100000) need no matrix; energy is exact."""
    n, rng = 100_000, np.random.default_rng(0)
    system = nh.SuslovTop.arrowhead(rng.uniform(1, 2, n), rng.normal(size=n - 1) / n)
    velocity = rng.normal(size=n - 1) / np.sqrt(n)
    orbit = nh.simulate(nh.discretize(system, 0.1), restricted_velocity=velocity, steps=20, reconstruct=False)
    assert orbit.chart.shape == orbit.restricted_momentum.shape == (21, n - 1)
    assert np.ptp(orbit.energy) <= 1e-14 * orbit.energy[0]


_WIDE, _WIDER = (nh.discretize(nh.SuslovTop.arrowhead(np.ones(n), np.zeros(n - 1)), 0.1) for n in (1000, 10_000))
_BARE = nh.simulate(_WIDE, restricted_velocity=np.full(999, 0.03), steps=1, reconstruct=False)
# Full momenta and matrices of a wide body, and poses that fill the memory, are refused with the remedy.
test_what_grows_with_the_square_is_refused = refusals(
    *((lambda name=name: getattr(_BARE, name), "reconstruct") for name in ("momentum", "multipliers", "displacement")),
    *((lambda name=name: getattr(_BARE, name), "reconstruct") for name in ("configuration", "body_velocity")),
    (lambda: nh.simulate(_WIDER, restricted_velocity=np.ones(9_999), steps=100), "save_every"),
)


LANES = 8


@pytest.mark.parametrize("size", [1e-9, 0.1, 1.0, 30.0, 3000.0])
@pytest.mark.parametrize("group", [nh.SO(2), nh.SO(3), nh.SO(4), nh.SE(2), nh.SE(3), nh.SE(4)], ids=str)
def test_displacements_in_closed_form(group: nh.SO, size: float) -> None:
    """They are those by elimination to rounding times the condition, up to angles of nearly pi, also two equal ones."""
    rng, n = np.random.default_rng(3), group.size - (not np.any(group.basis[:, -1]))
    for y in (*rng.normal(size=(20, group.dim)), *np.eye(group.dim), np.ones(group.dim)):
        Y, closed, X = group.hat(size * y), np.zeros((group.size,) * 2), np.zeros((group.size,) * 2)
        _step.displace_by_squares(Y, n, (Y[:n, :n] ** 2).sum() / 2, closed)
        assert _step.displace_by_elimination(Y.copy(), X) > 0
        np.testing.assert_allclose(closed, X, rtol=0, atol=1e-15 * (1 + np.abs(Y).max()) * np.abs(X).max())


@pytest.mark.parametrize("group", [nh.SO(3), nh.SO(4), nh.SO(5), nh.SE(2), nh.SE(3), nh.SE(4)], ids=str)
def test_jacobian_is_the_derivative_of_the_residual(group: nh.SO) -> None:
    """Against difference quotients, for a general d and for the whole algebra."""
    rng = np.random.default_rng(5)
    for k in (2, group.dim):
        system = nh.LLSystem(group, mass_tensor(group, rng), random_rows(group, k, rng))
        body = make_route(nh.discretize(system, 1.0), "matrix").body
        w, m, y = _step.workspace(body), rng.normal(size=k), 0.3 * rng.normal(size=len(body.stretch))
        _step.displace(body, w, y)
        _step.residual(body, w, 0.7, m)
        _step.jacobian(body, w)
        result, at = w.slope.copy(), []
        for a in range(len(y)):
            for sign in (1, -1):
                _step.displace(body, w, y + sign * 1e-5 * np.eye(len(y))[a])
                _step.residual(body, w, 0.7, m)
                at.append(w.sums[0].copy())
        quotients = (np.array(at[::2]) - np.array(at[1::2])) / 2e-5
        np.testing.assert_allclose(result, quotients, rtol=0, atol=1e-8 * np.abs(result).max())


@pytest.mark.parametrize("size", [1, 3, 8, 11])
def test_solutions_side_by_side(size: int) -> None:
    """The solution and the determinant are NumPy's, with pivots; a second right side needs no second elimination."""
    rng = np.random.default_rng(size)
    J, width = rng.normal(size=(size, size)), (size + LANES - 1) // LANES * LANES
    J[0, 0] = 0.0 if size > 1 else 2.0
    A, x = np.zeros((size, width)), np.zeros(size)
    A[:, :size] = J.T
    order, inverses, others = np.zeros(size, dtype=np.int64), np.zeros(size), 1.0 - np.eye(LANES)
    np.testing.assert_allclose(decompose(A, order, inverses, others), np.linalg.det(J), rtol=1e-12)
    for b in rng.normal(size=(2, size)):
        sums = np.zeros((1, width))
        sums[0, :size] = b
        solve_rows(A, order, inverses, sums, x)
        np.testing.assert_allclose(x, np.linalg.solve(J, b), rtol=1e-10)


def test_singular_jacobians_have_no_determinant() -> None:
    """Equations that depend on each other, and those with NaN."""
    order, inverses, others = np.zeros(2, dtype=np.int64), np.zeros(2), 1.0 - np.eye(LANES)
    A = np.zeros((2, LANES))
    A[:, :2] = [[1.0, 2.0], [2.0, 4.0]]
    assert decompose(A, order, inverses, others) == 0
    assert np.isnan(decompose(np.full((2, LANES), np.nan), order, inverses, others))
