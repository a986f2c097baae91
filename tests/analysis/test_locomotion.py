"""Local connections, gaits and brackets against closed forms, the flow and exact algebra.

Closed forms are derived in docs/how-to/gaits.md: of the car omega = (rho / l) tan(phi) psi', v1 = rho psi'; of the
snakeboard v1 = (p - (J0 / r) tan(phi) psi') cos(phi)^2 / m, omega = v1 tan(phi) / r. The connection of a body with
rotors is the inertia of the rotor over the locked one, A = (I + j)^-1 j.
"""

import dataclasses
import functools
import itertools
from typing import Any, cast

import jax.numpy as jnp
import mpmath
import numpy as np
import pytest
import scipy
from refusals import refusals

import nonholo as nh
from nonholo.analysis import LocalConnection
from nonholo.analysis.locomotion import _equations
from nonholo.base.types import Array

LONG = pytest.mark.profile("routes", instead="test_the_car_has_the_connection_of_the_closed_form")
IN_SPACE = pytest.mark.profile("routes", instead="test_a_circle_of_the_shape_is_a_closed_form")
RADIUS, BASE = 0.3, 1.7
MASS, HALF, ROTOR = 1.3, 0.8, 0.6
MOMENTS, SPINNING, REACH = np.array([1.0, 1.5, 2.0]), 0.5, 0.3
A1, A2 = np.random.default_rng(5).normal(size=(2, 6, 3)) / 4  # powers of the other shape variable, by columns
FREE = nh.LagrangeDAlembert(lambda q, v: v @ v / 2 + 0 * q[0], None, dimension=4, coordinates=("x", "y", "theta", "s"))


@functools.cache
def car() -> LocalConnection:
    """Return the connection of a car."""
    return nh.local_connection(nh.examples.kinematic_car(wheel_radius=RADIUS, wheelbase=BASE).system)


@functools.cache
def board() -> LocalConnection:
    """Return the connection of a snakeboard."""
    return nh.local_connection(nh.examples.snakeboard(mass=MASS, half_length=HALF, rotor_inertia=ROTOR).system)


def rolling(phi: Any) -> np.ndarray:
    """Return the body velocity of a snakeboard without momentum, for psi' = 1."""
    v1 = -ROTOR / (MASS * HALF) * np.sin(phi) * np.cos(phi)
    return np.array([v1 * np.tan(phi) / HALF, v1, 0 * v1])


def board_laws(phi: np.ndarray, rates: np.ndarray, p: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the curvature of a snakeboard, F_12, and the rate of its momentum."""
    F = -ROTOR / (MASS * HALF) * np.stack([np.sin(2 * phi) / HALF, np.cos(2 * phi), 0 * phi], -1)
    return F, np.tan(phi) * rates[:, 1] * p[:, 0] + ROTOR / HALF * rates[:, 0] * rates[:, 1]


def both_signs(F: np.ndarray) -> np.ndarray:
    """Return a curvature from F_12."""
    return np.stack([np.stack([0 * F, F], -1), np.stack([-F, 0 * F], -1)], -2)


def around(corners: list) -> tuple:
    """Return a gait along straight sides at unit intervals, its period and the times of its corners."""
    points = np.array([*corners, corners[0]], dtype=float)
    times = np.arange(len(points), dtype=float)

    def gait(time: Array) -> Array:
        return jnp.stack([jnp.interp(time, times, side) for side in points.T])

    return gait, float(times[-1]), times[1:-1]


def placed(x: float, y: float, theta: float) -> np.ndarray:
    """Return the matrix of a pose."""
    return np.array([[np.cos(theta), -np.sin(theta), x], [np.sin(theta), np.cos(theta), y], [0.0, 0.0, 1.0]])


def satellite(_s: Array, xi: Array, ds: Array) -> Array:
    """Return the Lagrangian of a body with two rotors."""
    return (MOMENTS @ xi**2 + SPINNING * ((xi[:2] + ds) ** 2).sum()) / 2


def turner(s: Array) -> Array:
    """Return rows of a body on SO(3) that turns about its first two axes in proportion to the shape."""
    return jnp.concatenate([jnp.eye(3), REACH * jnp.eye(3)[:, :2]], 1) + 0 * s[0]


def columns(s: Any, stack: Any = np.stack) -> Any:
    """Return A_1(s_2) and A_2(s_1) on SE(3)."""
    return A1 @ stack([s[1] ** 0, s[1], s[1] ** 2]), A2 @ stack([s[0] ** 0, s[0], s[0] ** 2])


def swimmer(s: Array) -> Array:
    """Return rows of a body on SE(3) with such a connection, mixed among each other."""
    mixed = jnp.eye(6) + 0.2 * jnp.sin(s[0]) * jnp.eye(6, k=2)
    return mixed @ jnp.concatenate([jnp.eye(6), jnp.stack(columns(s, jnp.stack), 1)], 1)


@functools.cache
def swimming() -> LocalConnection:
    """Return its connection."""
    return nh.local_connection(nh.ShapedBody(nh.SE(3), ("a", "b"), constraint_forms=swimmer, name="Swimmer"))


def test_the_car_has_the_connection_of_the_closed_form() -> None:
    """A and F at random shapes, to rounding; NaN where the front wheels are across."""
    shapes = np.random.default_rng(1).uniform(-1.4, 1.4, (3, 4, 2))
    tan, wanted = np.tan(shapes[..., 1]), np.zeros((3, 4, 3, 2))
    wanted[..., 0, 0], wanted[..., 1, 0] = -RADIUS / BASE * tan, -RADIUS
    np.testing.assert_allclose(car().matrix(shapes), wanted, rtol=0, atol=1e-13)
    F = np.stack([RADIUS / BASE * (1 + tan**2), 0 * tan, 0 * tan], -1)
    np.testing.assert_allclose(car().curvature(shapes), both_signs(F), rtol=0, atol=1e-11)
    assert np.isnan(car().matrix((0.3, np.pi / 2))).all()
    assert car().momentum_components == ()


@LONG
def test_the_snakeboard_has_the_connection_of_the_closed_form() -> None:
    """A, F and the momentum equation at random shapes, to 1e-12."""
    rng = np.random.default_rng(2)
    shapes, rates, p = rng.uniform(-1.3, 1.3, (20, 2)), rng.normal(size=(20, 2)), rng.normal(size=(20, 1))
    phi, A = shapes[:, 1], np.zeros((20, 3, 2))
    A[:, :, 0] = -rolling(phi).T
    np.testing.assert_allclose(board().matrix(shapes), A, rtol=0, atol=1e-13)
    F, rate = board_laws(phi, rates, p)
    np.testing.assert_allclose(board().curvature(shapes), both_signs(F), rtol=0, atol=1e-12)
    np.testing.assert_allclose(board().momentum_rate(shapes, rates, p)[:, 0], rate, rtol=0, atol=1e-12)
    speed = p[:, 0] * np.cos(phi) ** 2 / MASS
    wanted = np.stack([speed * np.tan(phi) / HALF, speed, 0 * speed], -1) - np.einsum("tai,ti->ta", A, rates)
    np.testing.assert_allclose(board().body_velocity(shapes, rates, p), wanted, rtol=0, atol=1e-12)
    assert board().momentum_components == ("v1",)


@LONG
def test_gaits_along_sides_are_products_of_exponentials() -> None:
    """While one shape variable rests the body velocity is constant: both phases to 1e-13 by exact algebra."""
    gait, period, corners = around([(0, 0), (2.0, 0), (2.0, 0.7), (0, 0.7)])
    forth, back = np.array([0.0, 2 * RADIUS, 0.0]), -2 * RADIUS * np.array([np.tan(0.7) / BASE, 1.0, 0.0])
    exact = nh.SE(2).exp(forth) @ nh.SE(2).exp(back)
    phase = nh.geometric_phase(car(), gait, period=period, corners=corners)
    np.testing.assert_allclose(phase.holonomy, exact, rtol=0, atol=1e-13)
    np.testing.assert_allclose(phase.configuration[-1], exact, rtol=0, atol=1e-13)
    inside = nh.SE(2).exp([-2 * RADIUS / BASE * np.tan(0.7), 0.0, 0.0])  # the integral of (rho / l) / cos(phi)^2
    np.testing.assert_allclose(phase.area_rule, inside, rtol=0, atol=1e-13)
    gait, period, corners = around([(0, -0.3), (2.0, -0.3), (2.0, 0.7), (0, 0.7)])
    exact = nh.SE(2).exp(2 * rolling(-0.3)) @ nh.SE(2).exp(-2 * rolling(0.7))
    phase = nh.geometric_phase(board(), gait, period=period, corners=corners)
    np.testing.assert_allclose(phase.holonomy, exact, rtol=0, atol=1e-13)
    np.testing.assert_allclose(phase.configuration[-1], exact, rtol=0, atol=1e-13)  # no momentum is ever made


@LONG
def test_the_momentum_after_a_gait_is_a_quadrature() -> None:
    """(p cos phi)' = (J0 / r) cos(phi) phi' psi': against 30 digits, over three periods, from a moving start."""

    def gait(time: Array) -> Array:
        return jnp.array([0.9 * jnp.sin(time), 0.2 + 0.6 * jnp.sin(time + 0.4)])

    def things(t: Any) -> Any:
        phi = mpmath.mpf("0.2") + 0.6 * mpmath.sin(t + mpmath.mpf("0.4"))
        return mpmath.cos(phi) * 0.6 * mpmath.cos(t + mpmath.mpf("0.4")) * 0.9 * mpmath.cos(t) * ROTOR / HALF

    with mpmath.workdps(30):
        gained = 3 * float(str(mpmath.quad(things, mpmath.linspace(0, 2 * mpmath.pi, 9))))
    phase = nh.geometric_phase(board(), gait, period=6 * np.pi, momentum=[0.5])
    cosine = float(np.cos(phase.shape[0, 1]))
    np.testing.assert_allclose(phase.momentum[-1, 0], 0.5 + gained / cosine, rtol=1e-12)


@LONG
@pytest.mark.parametrize("name", ["snakeboard", "roller_racer", "kinematic_car"])
def test_the_phase_is_the_flow_with_a_prescribed_shape(name: str) -> None:
    """From rest, momenta included: the pose of the Lagrange-d'Alembert equations, whose steps err by 1e-13."""
    ready = getattr(nh.examples, name)()
    connection = nh.local_connection(ready.system)
    sizes = [0.7, 0.5][-len(connection.shape_coordinates) :]

    def gait(time: Array) -> Array:
        return jnp.array([size * (1 - jnp.cos(time + 0.9 * i * jnp.sin(time))) for i, size in enumerate(sizes)])

    prescribed = {3 + i: lambda time, i=i: gait(time)[i] for i in range(len(sizes))}
    driven = dataclasses.replace(ready.system.plain, prescribed=prescribed)
    at = np.zeros(3 + len(sizes))
    times = np.linspace(0.0, 2 * np.pi, 3)
    end = nh.flow(driven, configuration=at, body_velocity=at, times=times, rtol=1e-13, atol=1e-14).configuration[-1]
    phase = nh.geometric_phase(connection, gait)
    np.testing.assert_allclose(phase.configuration[-1], placed(*end[:3]), rtol=0, atol=2e-10)
    np.testing.assert_allclose(phase.heading[-1], end[2], rtol=0, atol=2e-10)


@LONG
@pytest.mark.parametrize("connection", [car, board, swimming])
def test_the_area_rule_errs_by_the_third_power_of_the_size(connection: functools.partial) -> None:
    """Halving a gait divides the error by eight, and the displacement by four."""
    errors, moved = [], []
    for size in 0.4 * 0.5 ** np.arange(5):

        def gait(time: Array, size: float = size) -> Array:
            return jnp.array([size * jnp.cos(time), 0.3 + size * jnp.sin(time)])

        phase = nh.geometric_phase(connection(), gait)
        errors.append(np.abs(phase.holonomy - phase.area_rule).max())
        moved.append(np.abs(phase.holonomy - connection().group.identity).max())
    slope = -np.diff(np.log2(errors))
    assert abs(slope[-1] - 3) < 0.1
    assert abs(-np.diff(np.log2(moved))[-1] - 2) < 0.1


@LONG
def test_without_constraints_the_momentum_is_that_of_the_body() -> None:
    """A rotor on a free body: A = J / (I + J), no curvature, and p' = ad*_xi p."""
    mass, body, rotor = 1.4, 0.9, 0.3

    def lagrangian(q: Array, v: Array) -> Array:
        del q
        return (mass * (v[0] ** 2 + v[1] ** 2) + body * v[2] ** 2 + rotor * (v[2] + v[3]) ** 2) / 2

    names = ("x", "y", "theta", "rotor")
    free = nh.local_connection(nh.LagrangeDAlembert(lagrangian, None, dimension=4, coordinates=names))
    assert free.momentum_components == ("omega", "v1", "v2")
    np.testing.assert_allclose(free.matrix([0.4])[:, 0], [rotor / (body + rotor), 0, 0], rtol=0, atol=1e-15)
    np.testing.assert_array_equal(free.curvature([0.4]), np.zeros((3, 1, 1)))
    p = np.array([0.3, -0.5, 0.7])
    xi = free.body_velocity([0.4], [2.0], p)
    np.testing.assert_allclose(xi, [(p[0] - 2 * rotor) / (body + rotor), *(p[1:] / mass)], rtol=1e-14)
    np.testing.assert_allclose(free.momentum_rate([0.4], [2.0], p), nh.SE(2).coad(xi, p), rtol=0, atol=1e-14)


@LONG
def test_names_say_where_pose_and_shape_are() -> None:
    """The car with its coordinates in another order and by other names has the same connection."""
    order = [3, 2, 4, 1, 0]
    system: Any = nh.examples.kinematic_car(wheel_radius=RADIUS, wheelbase=BASE).system.plain
    back = np.argsort(order)

    def forms(q: Array) -> Array:
        return system.constraint_forms(q[back])[:, np.array(order)]

    names = ("psi", "heading", "phi", "north", "east")
    other = nh.LagrangeDAlembert(lambda q, v: v @ v + 0 * q[0], forms, dimension=5, coordinates=names)
    connection = nh.local_connection(other, pose=("east", "north", "heading"))
    assert connection.shape_coordinates == ("psi", "phi")
    np.testing.assert_allclose(connection.matrix((0.1, 0.7)), car().matrix((0.1, 0.7)), rtol=0, atol=1e-15)


@LONG
@pytest.mark.parametrize(
    ("name", "growth"),
    [("kinematic_car", (2, 3, 4, 5)), ("two_wheeled_robot", (2, 3, 4, 4)), ("snakeboard", (3, 4, 5))],
)
def test_brackets_grow_as_known(name: str, growth: tuple[int, ...]) -> None:
    """The car reaches everything; the robot keeps theta - R (right - left) / (2 c), and its directions do."""
    ready = getattr(nh.examples, name)()
    result = nh.accessibility(ready.system, ready.configuration + np.array([0.3, -0.2, 0.5, 0.1, 0.2]))
    assert result.growth == growth
    assert result.is_accessible == (growth[-1] == 5)
    if name == "two_wheeled_robot":
        covector = np.array([0.0, 0.0, 1.0, -0.25, 0.25])
        np.testing.assert_allclose(result.directions @ covector, 0.0, rtol=0, atol=1e-12)


@LONG
def test_longer_brackets_help_where_the_ranks_jump() -> None:
    """The plane field z' = y^2 x' (Martinet): (2, 3), but (2, 2, 3) where y = 0, seen with brackets of length 3."""
    martinet = nh.LagrangeDAlembert(
        lambda q, v: v @ v + 0 * q[0], lambda q: jnp.array([[-(q[1] ** 2), 0.0, 1.0]]), dimension=3
    )
    assert nh.accessibility(martinet, (0.0, 0.5, 0.0)).growth == (2, 3)
    flat = nh.accessibility(martinet, (0.0, 0.0, 0.0))
    assert (flat.growth, flat.is_accessible) == ((2, 2), False)
    assert nh.accessibility(martinet, (0.0, 0.0, 0.0), depth=3).growth == (2, 2, 3)


def with_forms(forms: object, **others: object) -> nh.LagrangeDAlembert:
    """Return a system in x, y, theta and a shape variable s."""
    return dataclasses.replace(FREE, constraint_forms=forms, **others)


def with_two_forms() -> nh.ShapedBody:
    """Return a body with a free component and no Lagrangian."""
    return nh.ShapedBody(nh.SO(3), ("a", "b"), constraint_forms=lambda s: turner(s)[:2])


# Errors say what is required.
test_others_are_refused = refusals(
    (lambda: nh.local_connection(nh.examples.kinematic_car()), "be a system in coordinates"),
    (lambda: nh.local_connection(nh.examples.particle().system), "pose=...\\)` must be one of"),
    (lambda: nh.local_connection(FREE, pose=("x", "y", "s2")), "pose=...\\)` must be one of"),
    (lambda: nh.local_connection(FREE, pose=("x", "y", "x")), "three different names"),
    (lambda: nh.local_connection(nh.examples.chaplygin_ball().system), "be a system in coordinates"),
    (lambda: nh.local_connection(with_forms(lambda _, time: jnp.eye(1, 4) * time)), "not depend on time"),
    (lambda: nh.local_connection(dataclasses.replace(FREE, holonomic=lambda q: q[:1])), "same at every pose"),
    (lambda: nh.local_connection(dataclasses.replace(FREE, holonomic=lambda q: q[3:])), "bind the body"),
    (lambda: nh.accessibility(dataclasses.replace(FREE, holonomic=lambda q: q[:1] - 1), np.zeros(4)), "satisfy the"),
    (lambda: nh.local_connection(with_forms(lambda q: jnp.array([[q[0], 1.0, 0.0, 0.0]]))), "same at every pose"),
    (lambda: nh.local_connection(with_forms(lambda q: jnp.array([[0.0, 0.0, 0.0, 1 + q[3]]]))), "bind the body"),
    (lambda: nh.geometric_phase(car(), lambda t: jnp.array([t, 0.0])), "be closed"),
    (lambda: nh.geometric_phase(car(), lambda t: jnp.array([t])), "return an array of shape"),
    (lambda: nh.geometric_phase(car(), lambda t: jnp.array([jnp.sin(t), 2 * jnp.sin(t)])), "singular shapes"),
    (lambda: nh.accessibility(FREE, np.zeros(4), depth=9), "be at most 8"),
    (lambda: nh.accessibility(with_forms(lambda q: jnp.zeros((1, 4)) * q), np.zeros(4)), "independent constraints"),
    (lambda: nh.local_connection(with_two_forms()), "determine 3 components of the body velocity"),
)


@LONG
def test_a_lagrangian_must_not_depend_on_the_pose() -> None:
    """Gravity in the plane and a term linear in the velocity are refused; a spring of the shape is not."""
    heavy = dataclasses.replace(FREE, lagrangian=lambda q, v: v @ v - q[1])
    with pytest.raises(ValueError, match="Lagrangian that is the same at every pose"):
        nh.local_connection(heavy)
    with pytest.raises(ValueError, match="quadratic"):
        nh.local_connection(dataclasses.replace(FREE, lagrangian=lambda q, v: v @ v + v[3] * q[3]))
    assert nh.local_connection(dataclasses.replace(FREE, lagrangian=lambda q, v: v @ v - q[3] ** 2))


def test_momenta_and_curvature_of_the_snakeboard_follow_from_its_matrices() -> None:
    """Rows, inertia and their slopes by hand: curvature and momentum equation of the closed form, without JAX."""
    rng = np.random.default_rng(3)
    phi, ds, p = rng.uniform(-1.3, 1.3, 9), rng.normal(size=(9, 2)), rng.normal(size=(9, 1))
    W, dW = np.zeros((9, 2, 5)), np.zeros((9, 2, 5, 2))
    for row, side in enumerate((1.0, -1.0)):
        W[:, row, :3] = np.stack([side * HALF * np.cos(phi), -side * np.sin(phi), np.cos(phi)], -1)
        dW[:, row, :3, 1] = np.stack([-side * HALF * np.sin(phi), -side * np.cos(phi), -np.sin(phi)], -1)
    M = np.diag([MASS * HALF**2, MASS, MASS, ROTOR, 0.2])
    M[0, 3] = M[3, 0] = ROTOR
    at = _equations.terms((1,), np.ones(3), W, dW, np.broadcast_to(M, (9, 5, 5)), np.zeros((9, 5, 5, 2)))
    F, rate = board_laws(phi, ds, p)
    np.testing.assert_allclose(_equations.curvature(nh.SE(2), at)[:, :, 0, 1], F, rtol=0, atol=1e-12)
    np.testing.assert_allclose(_equations.motion(nh.SE(2), at, ds, p)[1][:, 0], rate, rtol=0, atol=1e-12)


def test_the_curvature_of_two_wheels_is_a_bracket() -> None:
    """A is constant, so F = -[A_right, A_left]: a robot that turns one wheel after the other moves aside."""
    turn, ahead = 0.25 / (2 * 0.5), 0.25 / 2
    W, dW = np.array([[0.0, 0, 1, 0, 0], [0, 1, 0, -ahead, -ahead], [1, 0, 0, -turn, turn]]), np.zeros((3, 5, 2))
    at = _equations.terms((), np.ones(3), W, dW, W, dW)
    F = _equations.curvature(nh.SE(2), at)[:, 0, 1]
    np.testing.assert_allclose(F, [0, 0, -2 * turn * ahead], rtol=0, atol=1e-16)


@LONG
def test_forces_leave_the_connection_as_it_is() -> None:
    """Under friction and a push a car whose shape is driven has the body velocity that the connection says."""
    ready = nh.examples.kinematic_car(wheel_radius=RADIUS, wheelbase=BASE)
    force = nh.Friction(np.linspace(0.5, 1.0, 5)), lambda time, q, v, _: jnp.cos(time + q) - v * jnp.abs(v)
    rubbed = dataclasses.replace(cast(Any, ready.system), force=force)
    connection = nh.local_connection(rubbed)
    np.testing.assert_array_equal(connection.matrix((0.1, 0.3)), car().matrix((0.1, 0.3)))
    orbit = nh.flow(rubbed, configuration=ready.configuration, body_velocity=ready.body_velocity, times=(0, 0.5, 1.0))
    theta, v = orbit.configuration[:, 2], orbit.body_velocity
    cos, sin = np.cos(theta), np.sin(theta)
    xi = np.stack([v[:, 2], cos * v[:, 0] + sin * v[:, 1], cos * v[:, 1] - sin * v[:, 0]], axis=1)
    np.testing.assert_allclose(connection.body_velocity(orbit.configuration[:, 3:], v[:, 3:]), xi, 0, 1e-12)


@LONG
def test_gradients_of_holonomic_constraints_are_rows() -> None:
    """A blade whose heading is geared to its shape: connection, curvature and brackets are those of the rows."""
    blade = lambda q: jnp.array([[-jnp.sin(q[2]), jnp.cos(q[2]), 0.0, 0.0], [jnp.cos(q[2]), jnp.sin(q[2]), 0.0, -0.5]])  # noqa: E731
    geared = with_forms(blade, holonomic=lambda q: jnp.array([q[2] - jnp.sin(q[3])]))
    gear = lambda q: jnp.concatenate([blade(q), jnp.array([[0.0, 0.0, 1.0, -jnp.cos(q[3])]])])  # noqa: E731
    rows, ours, s = nh.local_connection(with_forms(gear)), nh.local_connection(geared), np.linspace(-1, 1, 5)[:, None]
    assert ours.momentum_components == rows.momentum_components == ()
    np.testing.assert_allclose(ours.matrix(s), rows.matrix(s), 0, 1e-15)
    np.testing.assert_allclose(ours.matrix(s)[..., 0], np.stack([-np.cos(s), -0.5 + 0 * s, 0 * s], 1)[..., 0], 0, 1e-15)
    gear_only = with_forms(lambda q: blade(q)[:1], holonomic=lambda q: jnp.array([q[2] - jnp.sin(q[3])]))
    result = nh.accessibility(gear_only, np.zeros(4))
    assert (result.growth, result.is_accessible) == ((2, 3), True)
    assert np.abs(result.directions @ [0.0, 0.0, 1.0, -1.0]).max() <= 1e-15
    as_form = with_forms(lambda q: jnp.concatenate([blade(q)[:1], jnp.array([[0.0, 0.0, 1.0, -jnp.cos(q[3])]])]))
    assert nh.accessibility(as_form, np.zeros(4)).growth[:2] == (2, 3)
    assert not nh.accessibility(as_form, np.zeros(4)).is_accessible


def test_a_circle_of_the_shape_is_a_closed_form() -> None:
    """In axes that go around with the shape the equation has constant coefficients: g = exp 2 pi (e3 - r A e2)."""
    body = nh.ShapedBody(nh.SO(3), ("a", "b"), constraint_forms=turner)
    connection = nh.local_connection(body)
    assert connection.components == ("omega1", "omega2", "omega3")
    np.testing.assert_allclose(connection.curvature((0.1, 0.2))[:, 0, 1], [0, 0, -(REACH**2)], rtol=0, atol=1e-15)
    phase = nh.geometric_phase(connection, lambda t: 0.7 * jnp.stack([jnp.cos(t), jnp.sin(t)]))
    exact = nh.SO(3).exp(2 * np.pi * np.array([0.0, -0.7 * REACH, 1.0]))
    np.testing.assert_allclose(phase.holonomy, exact, rtol=0, atol=1e-13)
    np.testing.assert_allclose(nh.SO(3).log(phase.area_rule), [0, 0, 0.49 * np.pi * REACH**2], rtol=0, atol=1e-13)
    assert phase.heading is None


@IN_SPACE
def test_rotors_have_the_mechanical_connection() -> None:
    """A and F of a satellite to rounding, three momenta; with momentum its spatial angular momentum is kept."""
    connection = nh.local_connection(nh.ShapedBody(nh.SO(3), ("a", "b"), satellite))
    ratio = SPINNING / (MOMENTS[:2] + SPINNING)
    np.testing.assert_allclose(connection.matrix((0.3, 0.1)), np.diag([*ratio, 0.0])[:, :2], rtol=0, atol=1e-15)
    np.testing.assert_allclose(connection.curvature((0.0, 0.0))[:, 0, 1], [0, 0, -ratio.prod()], rtol=0, atol=1e-15)
    assert connection.momentum_components == connection.components
    assert_keeps_momentum(connection, [0.3, -0.2, 0.5])
    still = nh.geometric_phase(connection, lambda t: jnp.stack([jnp.cos(t), jnp.sin(t)]))  # momenta are rounding alone
    assert np.abs(still.momentum).max() < 1e-14
    np.testing.assert_allclose(still.configuration[-1], still.holonomy, rtol=0, atol=1e-12)


@IN_SPACE
def test_masses_that_slide_in_space_keep_the_spatial_momentum() -> None:
    """A body on SE(3) with masses sliding along two axes, whose inertia depends on the shape."""

    def sliding(s: Array, xi: Array, ds: Array) -> Array:
        turn, shift = xi[:3], xi[3:]
        energy = (MOMENTS @ turn**2 + 2.0 * shift @ shift) / 2
        for i, mass in enumerate((0.4, 0.7)):
            place = s[i] * jnp.eye(3)[i] + 0.2
            velocity = shift + jnp.cross(turn, place) + ds[i] * jnp.eye(3)[i]
            energy += mass * velocity @ velocity / 2
        return energy

    connection = nh.local_connection(nh.ShapedBody(nh.SE(3), ("a", "b"), sliding))
    assert connection.momentum_components == ("omega1", "omega2", "omega3", "v1", "v2", "v3")
    assert_keeps_momentum(connection, [0.3, -0.2, 0.5, 0.1, 0.4, -0.3])


def assert_keeps_momentum(connection: Any, start: list[float]) -> None:
    """Check that the momentum of a free body is constant in space along a gait, though not in the body."""
    gait = lambda t: jnp.stack([0.5 * jnp.cos(t), 0.4 * jnp.sin(t + 0.3)])  # noqa: E731
    phase, group = nh.geometric_phase(connection, gait, momentum=start), connection.group
    spatial = [group.coadjoint(group.inverse(g), p) for g, p in zip(phase.configuration, phase.momentum, strict=True)]
    np.testing.assert_allclose(spatial, np.broadcast_to(start, np.shape(spatial)), rtol=0, atol=1e-12)
    assert np.ptp(phase.momentum, axis=0).max() > 0.05
    assert float(group.residual(phase.configuration[-1])) < 1e-13


@IN_SPACE
def test_the_curvature_in_space_is_that_of_the_formula() -> None:
    """F = d_1 A_2 - d_2 A_1 - [A_1, A_2] of polynomials, to rounding; mixing the rows does not count."""
    connection = swimming()
    for s in np.random.default_rng(6).uniform(-1, 1, (5, 2)):
        a1, a2 = columns(s)
        slopes = A2 @ [0.0, 1.0, 2 * s[0]] - A1 @ [0.0, 1.0, 2 * s[1]]
        np.testing.assert_allclose(connection.matrix(s), np.stack([a1, a2], 1), rtol=0, atol=1e-13)
        exact = slopes - nh.SE(3).bracket(a1, a2)
        np.testing.assert_allclose(connection.curvature(s)[:, 0, 1], exact, rtol=0, atol=1e-13)


@IN_SPACE
def test_gaits_along_sides_in_space_are_products_of_exponentials() -> None:
    """Along each side the body velocity is constant: the phase is a product of exponentials."""
    places = [(-0.3, 0.2), (0.6, 0.2), (0.6, 0.9), (-0.3, 0.9)]
    gait, period, corners = around(places)
    phase = nh.geometric_phase(swimming(), gait, period=period, corners=corners)
    exact = np.eye(4)
    for a, b in itertools.pairwise([*places, places[0]]):
        exact = exact @ scipy.linalg.expm(nh.SE(3).hat(-np.subtract(b, a) @ columns(a)))
    np.testing.assert_allclose(phase.holonomy, exact, rtol=0, atol=1e-13)


@IN_SPACE
def test_a_car_in_its_own_frame_is_the_car_in_coordinates() -> None:
    """On SE(2) a `ShapedBody` has the connection, the curvature and the phase of the system in coordinates."""

    def rows(s: Array) -> Array:
        rates = jnp.array([RADIUS / BASE * jnp.tan(s[1]), RADIUS, 0.0])
        return jnp.concatenate([jnp.eye(3), -jnp.stack([rates, jnp.zeros(3)], 1)], 1)

    own = nh.local_connection(nh.ShapedBody(nh.SE(2), ("psi", "phi"), constraint_forms=rows))
    shapes = np.random.default_rng(7).uniform(-1, 1, (6, 2))
    np.testing.assert_allclose(own.matrix(shapes), car().matrix(shapes), rtol=0, atol=1e-14)
    np.testing.assert_allclose(own.curvature(shapes), car().curvature(shapes), rtol=0, atol=1e-13)
    gait = lambda t: jnp.stack([2 * jnp.sin(t), 0.5 * jnp.cos(t)])  # noqa: E731
    one, other = (nh.geometric_phase(each, gait) for each in (own, car()))
    np.testing.assert_allclose(one.holonomy, other.holonomy, rtol=0, atol=1e-13)
    np.testing.assert_allclose(one.heading, other.heading, rtol=0, atol=1e-13)
    assert nh.accessibility(own.system, (0.2, 0.3)).growth == (2, 3, 4, 5)


@IN_SPACE
def test_brackets_on_groups_are_those_of_the_algebra() -> None:
    """With a constant connection the brackets are those of the vectors (-A_i, e_i) of the algebra."""
    A = np.random.default_rng(8).normal(size=(6, 2))
    body = nh.ShapedBody(nh.SE(3), ("a", "b"), constraint_forms=lambda s: jnp.hstack([jnp.eye(6), A]) + 0 * s[0])
    result = nh.accessibility(body, (0.3, -0.2), depth=5)
    fields = layer = [(-a, e) for a, e in zip(A.T, np.eye(2), strict=True)]
    ranks = []
    while len(ranks) < len(result.growth):
        ranks.append(int(np.linalg.matrix_rank(np.array([np.append(*field) for field in fields]), rtol=1e-9)))
        layer = [(nh.SE(3).bracket(-a, x), np.zeros(2)) for a in A.T for x, _ in layer]
        fields = fields + layer
    assert result.growth == tuple(ranks)
    assert result.is_accessible


@IN_SPACE
def test_a_pose_that_is_a_function_of_the_shape_stays_one() -> None:
    r"""With $g = e^{s_1e_1}e^{s_2e_2}$ motions fill a surface: brackets add nothing, the curvature is zero."""

    def rows(s: Array) -> Array:
        first = jnp.stack([jnp.cos(s[1]), 0.0, jnp.sin(s[1])])  # of g^-1 dg
        return jnp.concatenate([jnp.eye(3), -jnp.stack([first, jnp.eye(3)[1]], 1)], 1)

    body, s = nh.ShapedBody(nh.SO(3), ("a", "b"), constraint_forms=rows), (0.3, -0.7)
    np.testing.assert_allclose(nh.local_connection(body).curvature(s), 0.0, rtol=0, atol=1e-15)
    assert set(nh.accessibility(body, s).growth) == {2}


# The message names the argument.
test_no_shaped_bodies_are_refused = refusals(
    ({"group": "SO(3)"}, "be a matrix group"),
    ({"shape_coordinates": ["a", "b"]}, "Pass a tuple of strings"),
    ({"shape_coordinates": ("a", "a")}, "be different names"),
    ({"shape_coordinates": ()}, "be different names"),
    ({"constraint_forms": None}, "have a Lagrangian or constraints"),
    ({"name": 1}, "be a text"),
    ({"constraint_forms": lambda s: jnp.ones((3, 3)) + s[0]}, r"shape \(s, 5\)"),
    ({"lagrangian": lambda s, xi, ds: xi * ds[0] + s[0]}, "a scalar"),
    ask=lambda given: nh.ShapedBody(
        **{"group": nh.SO(3), "shape_coordinates": ("a", "b"), "constraint_forms": turner} | given
    ),
    kind=(TypeError, ValueError),
)
