"""The principal root of the step in O(n): through angle pi, refused at folds, its pieces against dense matrices."""

from typing import Any

import numpy as np
import pytest
from bodies import PAST_PI
from fuzz.following import distance, followed
from fuzz.steps import equations_of

import nonholo as nh
from nonholo import kernels
from nonholo.discrete.branching._equations import frame_of
from nonholo.discrete.routes import SecularRoute, make_route
from nonholo.kernels.secular._root import principal
from nonholo.kernels.secular._sphere import holds, solve_linear, write_bends, write_box
from nonholo.kernels.secular._step import room_for_sums, secular_sleigh, secular_top

MOMENTUM = np.array([-1.718, -1.87, 1.66])
KINDS = ("top 4", "top 5", "top 6", "sleigh 3")


def random_system(kind: str, rng: np.random.Generator) -> nh.SuslovTop | nh.MultidimensionalSleigh:
    """Draw a body of a few mass points."""
    name, n = kind.split()
    points = rng.normal(size=(int(n) + 3, int(n)))
    J = points.T @ points / len(points)
    if name == "top":
        return nh.SuslovTop(J)
    return nh.MultidimensionalSleigh(rng.uniform(0.3, 2), 10 ** rng.uniform(-1, 0.3) * rng.normal(size=int(n)), J)


def dense(b: np.ndarray, c: np.ndarray, slides: bool, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    r"""Return the equations at (z0, z, w) without momenta, and their Jacobian: $z_0Bz + |z|^2c - (c\cdot z)z + wz$.

    Then the sphere $z_0^2 + |z|^2 = 1$, and $wz_0$, or $w$ of a top.
    """
    k, z0, z, w = len(c), x[0], x[1:-1], x[-1]
    along, square, J = c @ z, z @ z, np.zeros((len(x), len(x)))
    F = np.concatenate([z0 * b * z + square * c - along * z + w * z, [z0 * z0 + square - 1, w * z0 if slides else w]])
    J[:k, 0], J[:k, -1] = b * z, z
    J[:k, 1:-1] = np.diag(z0 * b) + 2 * c[:, None] * z - z[:, None] * c + (w - along) * np.eye(k)
    J[k, 0], J[k, 1:-1] = 2 * z0, 2 * z
    J[-1, 0], J[-1, -1] = (w, z0) if slides else (0.0, 1.0)
    return F, J


def by_path(step: SecularRoute, r: np.ndarray) -> tuple[int, np.ndarray]:
    """Return the outcome and (z0, z) up to their common sign."""
    body, m = step.body, step.encode(r)
    k = len(body.b)
    code, nu, tau = principal(body, m, m[-1] if body.slides else 0.0, room_for_sums())
    y = (m[:k] + tau * (m[:k] + body.c)) / (body.b + nu)
    return code, np.append(1.0, step.from_kernel(y)) / np.sqrt(1 + tau)


def outcome_of(step: Any, momentum: np.ndarray) -> int:
    """Return the outcome of the general step on SO(4)."""
    return kernels.runs_of(step.body).start(step.body, step.scale * momentum, np.eye(4).ravel())[0]


@pytest.mark.profile("routes", instead="test_a_half_turn")
def test_the_end_of_a_chart_is_no_fold() -> None:
    """`step` by the definition and the general kernel follow in Cayley coordinates: beyond pi they are unsure."""
    discrete = nh.discretize(nh.SuslovTop(PAST_PI), 1.0)
    assert int(nh.step(discrete, MOMENTUM).outcome) == nh.Outcome.branch_unverified
    step = make_route(discrete, "matrix")
    assert step is not None
    assert outcome_of(step, MOMENTUM) == nh.Outcome.branch_unverified
    assert int(nh.step(discrete, 20 * MOMENTUM[::-1]).outcome) == nh.Outcome.no_real_branch


@pytest.mark.parametrize("beyond", [False, True])
def test_a_half_turn(beyond: bool) -> None:
    """Where r is orthogonal to r - c the path ends at a half-turn, z0 = 0, and elsewhere beyond, as by continuation.

    It is the principal one among all displacements, and that of an orbit. At a half-turn the continuation ends short.
    """
    system = nh.SuslovTop(PAST_PI)
    discrete, along = nh.discretize(system, 1.0), MOMENTUM / np.linalg.norm(MOMENTUM)
    r = MOMENTUM if beyond else 2 * (along @ system.coupling) * along
    code, result = by_path(discrete.route, r)
    assert code == 0
    assert beyond or abs(result[0]) < 1e-12
    values, q = nh.displacements_over(discrete, r), np.append(result[1:], result[0])
    assert values.principal is not None
    W = values.displacement[values.principal].real
    assert np.abs(W - (np.eye(4) - 2 * np.outer(q, q)) * [1, 1, 1, -1]).max() < 1e-12
    assert np.abs(nh.simulate(discrete, momentum=r, steps=1).displacement[0] - W).max() < 1e-12
    equations, size = equations_of(system)
    assert distance(followed(equations, r[None] / size).roots, W[None]) < (1e-12 if beyond else 1e-7)


@pytest.mark.parametrize("past", [0.0, 1e-9, -1e-9, 1e-3])
def test_the_slide_of_a_sleigh_at_angle_pi(past: float) -> None:
    """At and near angle pi, where the momentum along the blade is -2 m a / h, the slide is as accurate as elsewhere."""
    mass, arm = 1.0, 2.0
    system = nh.MultidimensionalSleigh(mass, [arm, 0.3, -0.2], 0.1 * np.diag([1.0, 2.0, 3.0]) + 0.01)
    discrete = nh.discretize(system, 1.0)
    r = np.array([18.0, 7.0, -2 * mass * arm * (1 + past)])
    code, chart = discrete.route.first_root(r)
    assert code == 0
    values, frame = nh.displacements_over(discrete, r), frame_of("test", discrete)
    y = chart / np.linalg.norm(chart[:-1])  # without the sign and size of z0
    missed = []
    for W in values.displacement[values.is_real].real:
        exact = frame.chart(frame.point(W))
        exact /= np.linalg.norm(exact[:-1])
        missed.append(np.abs(y - exact * np.sign(y[:-1] @ exact[:-1])).max() / np.abs(exact).max())
    assert min(missed) < 1e-12
    assert np.linalg.norm(chart[:-1]) > 1e2


@pytest.mark.parametrize("past", [0.0, 1e-12, 1e-9, 1e-3])
@pytest.mark.parametrize("n", [3, 5])
def test_orbits_of_sleighs_at_angle_pi(n: int, past: float) -> None:
    """There the chart is nearly infinite; displacements are those of the poses, and full momenta are taken back."""
    arm = np.append(2.0, np.linspace(0.3, -0.2, n - 1))
    system = nh.MultidimensionalSleigh(1.0, arm, 0.1 * np.diag(np.arange(1.0, n + 1)) + 0.01)
    discrete = nh.discretize(system, 1.0)
    r = np.array([18.0, *np.linspace(7.0, 2.0, n - 2), -4.0 * (1 + past)])
    orbit = nh.simulate(discrete, momentum=r, steps=1)
    moved = system.group.inverse(orbit.configuration[0]) @ orbit.configuration[1]
    assert system.group.angle(system.group.log(moved)) == pytest.approx(np.pi, abs=1e-2)
    assert np.abs(orbit.displacement[0] - moved).max() < 1e-12
    batch = nh.ensemble(discrete, momentum=np.stack([r, r]), steps=1, save_every=1)
    assert np.abs(batch.displacement[:, 0] - moved).max() < 1e-12
    assert nh.simulate(discrete, momentum=orbit.momentum[0], steps=1).outcome == nh.Outcome.successful


@pytest.mark.parametrize("along", [0.0, 0.7])
def test_a_sleigh_without_arm_ends_at_angle_pi(along: float) -> None:
    """With a = 0 a turn by pi slides infinitely far, unless there is no momentum along the blade."""
    J = np.roll(np.array(PAST_PI), (1, 1), (0, 1))
    system = nh.MultidimensionalSleigh(1.0, [0.0, 0.0, 0.0, 0.0], J * np.outer([-1, 1, 1, 1], [-1, 1, 1, 1]))
    code, _ = by_path(nh.discretize(system, 1.0).route, np.append(MOMENTUM, along))
    assert code == (nh.Outcome.branch_unverified if along else 0)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("equal", [False, True])
def test_linear_equations(kind: str, equal: bool) -> None:
    """Sums of O(n) solve what the whole matrix of derivatives does, also where one factor z0 b + mu vanishes."""
    rng = np.random.default_rng(6)
    body = nh.discretize(random_system(kind, rng), 1.0).route.body
    k, signs = len(body.b), set()
    if equal:
        body = body._replace(b=np.full(k, body.b[0]))
    for trial in range(20):
        x, right, move = rng.normal(size=k + 2), rng.normal(size=k + 2), np.zeros(k + 2)
        x[1] *= body.slides
        right[1] *= body.slides
        if trial % 2 and not equal:  # z along c makes the factor of the first one vanish
            x[2:] -= body.c * (x[0] * body.b[0] + x[1] + body.c @ x[2:]) / (body.c @ body.c)
        det = solve_linear(body, x, right, move)
        J = dense(body.b, -body.c, body.slides, np.concatenate([x[:1], x[2:], x[1:2]]))[1]
        exact = np.linalg.solve(J, np.concatenate([right[2:], [2 * right[0]], [right[1]]]))
        result = np.concatenate([move[1::-1], move[2:]])
        assert np.abs(result - np.roll(exact, 1)).max() < 1e-9 * np.abs(exact).max()
        signs.add(np.sign(det * np.linalg.det(J)))
    assert len(signs) == 1


_UNEVEN = np.zeros((5, 5))
_UNEVEN[np.triu_indices(5)] = [
    0.028676609862390286, 0.00014396212485831282, -1.4045463232856376e-06, 2.1121169113529863e-06, -1.5240129550857e-06,
    1.3153847232685495e-05, 1.0384784089216e-08, -1.0226104249555853e-08, -2.0097347687898e-08,
    2.1465163318455576e-10, -4.59177093251508e-11, -2.81105265330166e-11,
    7.5121621301812e-10, -5.55532748228859e-10, 1.71851391226951e-09,
]  # fmt: skip
UNEVEN = _UNEVEN + np.triu(_UNEVEN, 1).T
"""A tensor whose directions differ by 1e8; by 120 digits its fold lies at 0.05888 of the momentum below."""


@pytest.mark.parametrize("share", [0.058, 0.0595, 0.09, 0.5, 1.0])
def test_tiny_folds_are_not_jumped_over(share: float) -> None:
    """Uneven bodies fold where the steps of the path would be longer than the way to the fold and back."""
    top = nh.SuslovTop(UNEVEN)
    momentum = np.array([-0.0011173302985360758, -6.31419512598405e-06, 5.38752802160346e-08, -8.1157260939562e-08])
    velocity = np.linalg.solve(top.constrained_inertia, share * momentum)
    orbit = nh.simulate(nh.discretize(top, 1.0), restricted_velocity=velocity, steps=1, throw=False)
    assert (len(orbit) > 0) == (share < 0.0588)


@pytest.mark.parametrize("share", [0.99, 0.999999, 1.000001, 1.01, 10.0, 1000.0])
def test_a_fold_at_an_angle_of_a_hundredth(share: float) -> None:
    """Directions differ by 1e12: by 256 bits the path folds at 0.00062078278975552 of the momentum below."""
    b = np.array([4.709575651449889e-13, 7.470241333923588e-12, 0.006708715317397309, 0.38361559189530325])
    c = np.array([3.1492572636921275e-14, -4.0386826248559647e-13, 1.2458990216061384e-08, -1.8545600676926565e-07])
    m = np.array([2.91881527073446e-16, -4.3553942711590654e-15, -9.063350779315726e-06, 0.0015343130131294299])
    m *= 0.00062078278975552 * share
    assert principal(secular_top(b, -c), m, 0.0, room_for_sums())[0] == (share > 1)


@pytest.mark.parametrize("kind", ["top", "sleigh", "sleigh without arm"])
def test_bends_are_bounded(kind: str) -> None:
    """No corner of a box has a second-order part, by dense matrices of the definition, beyond the bounds; some near."""
    rng, k, nearest = np.random.default_rng(8), 3, 0.0
    for _ in range(30):
        b, c = 10 ** rng.uniform(-3, 0, k), rng.normal(size=k)
        c *= b.min() / 2
        arm = 0.5 * (kind == "sleigh")
        body = secular_top(b, -c) if kind == "top" else secular_sleigh(b, c, 0.7, arm, np.zeros(k))
        x = np.concatenate([rng.normal(size=1), rng.normal(size=1) * (arm != 0), rng.normal(size=k)])
        R = np.append(np.abs(rng.normal(size=k + 2)), 0.0)
        R[1] *= arm != 0
        R[-1] = np.abs(c) @ R[2:-1] + R[1]
        G = np.empty(k + 3)
        write_bends(body, x, R, G)
        J, zero = dense(b, -c, arm != 0, np.concatenate([x[:1], x[2:], x[1:2]]))[1], dense(b, -c, arm != 0, 0 * x)[0]
        for corner in np.array(np.meshgrid(*[[-1.0, 1.0]] * (k + 2))).reshape(k + 2, -1).T:
            u = corner * R[:-1]
            moved = np.concatenate([u[:1], u[2:], u[1:2]])
            value, slope = dense(b, -c, arm != 0, moved)
            bend = np.linalg.solve(J, slope @ moved - (value - zero))
            bend = np.concatenate([bend[:1], bend[-1:], bend[1:-1], [c @ bend[1:-1] + bend[-1]]])
            assert np.all(np.abs(bend) <= G * (1 + 1e-9) + 1e-12 * G.max())
            nearest = max(nearest, float(np.max(np.abs(bend[2:]) / G[2:])))
    assert nearest > 0.5


def test_a_box_has_one_root() -> None:
    """Where roots merge, a box that is certain holds the next root of the path and not the one beyond the fold."""
    body, certain = secular_top(np.array([1.0, 1.0]), np.array([0.0, 0.5])), 0
    x, box = np.zeros(4), np.empty(5)
    for angle in np.linspace(0.1, 1.5, 15):  # b z0 z + (c.z) z - |z|^2 c = m is known from its root
        x[0], x[2] = np.cos(angle), np.sin(angle)
        for size in (1e-3, 1e-2, 0.1, 1.0):
            way = size * np.array([-np.sin(angle), 0.0, np.cos(angle), 0.0])
            if write_box(body, x, way, box) < 1:
                certain += 1
                assert holds(body, x, box, x)
                assert not holds(body, x, box, np.append(x[:2], -x[2:]))
    assert certain > 10


@pytest.mark.parametrize("share", [0.99, 1.01, 22.07])
def test_the_general_step_sees_tiny_folds(share: float) -> None:
    """A top that folds at a small angle: the general step continued to another branch."""
    tensor = [
        [1.0, 0.0007355764, 0.001473202, -0.001420035],
        [0.0007355764, 4.991517e-06, 1.089421e-07, -1.168234e-06],
        [0.001473202, 1.089421e-07, 1.145525e-05, -1.056824e-05],
        [-0.001420035, -1.168234e-06, -1.056824e-05, 2.55948e-05],
    ]
    step = make_route(nh.discretize(nh.SuslovTop(tensor), 1.0), "matrix").compiled_route
    assert step is not None
    momentum = share * 0.04532060048 * np.array([-0.9221329, -0.0006786948, -0.001358454])
    assert (outcome_of(step, momentum) == 0) == (share < 1)
