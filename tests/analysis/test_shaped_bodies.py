"""Bodies with a shape on SO(3), SE(3) and SE(2): connections, phases and brackets against closed forms and laws.

The connection of a body with rotors is the inertia of the rotor over the locked one, A = (I + j)^-1 j.
"""

import functools
import itertools
from typing import Any

import jax.numpy as jnp
import mpmath
import numpy as np
import pytest
from refusals import refusals

import nonholo as nh
from nonholo.base.types import Array

LONG = pytest.mark.profile("routes", instead="test_a_circle_of_the_shape_is_a_closed_form")
MOMENTS, ROTOR, REACH = np.array([1.0, 1.5, 2.0]), 0.5, 0.3
A1, A2 = np.random.default_rng(5).normal(size=(2, 6, 3)) / 4  # powers of the other shape variable, by columns


def satellite(_s: Array, xi: Array, ds: Array) -> Array:
    """Return the Lagrangian of a body with two rotors."""
    return (MOMENTS @ xi**2 + ROTOR * ((xi[:2] + ds) ** 2).sum()) / 2


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
def swimming() -> nh.ShapedBody:
    """Return the swimmer."""
    return nh.ShapedBody(nh.SE(3), ("a", "b"), constraint_forms=swimmer, name="Swimmer")


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


@LONG
def test_rotors_have_the_mechanical_connection() -> None:
    """A and F of a satellite to rounding, three momenta; with momentum its spatial angular momentum is kept."""
    connection = nh.local_connection(nh.ShapedBody(nh.SO(3), ("a", "b"), satellite))
    ratio = ROTOR / (MOMENTS[:2] + ROTOR)
    np.testing.assert_allclose(connection.matrix((0.3, 0.1)), np.diag([*ratio, 0.0])[:, :2], rtol=0, atol=1e-15)
    np.testing.assert_allclose(connection.curvature((0.0, 0.0))[:, 0, 1], [0, 0, -ratio.prod()], rtol=0, atol=1e-15)
    assert connection.momentum_components == connection.components
    assert_keeps_momentum(connection, [0.3, -0.2, 0.5])


@LONG
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


@LONG
def test_the_curvature_in_space_is_that_of_the_formula() -> None:
    """F = d_1 A_2 - d_2 A_1 - [A_1, A_2] of polynomials, to rounding; mixing the rows does not count."""
    connection = nh.local_connection(swimming())
    for s in np.random.default_rng(6).uniform(-1, 1, (5, 2)):
        a1, a2 = columns(s)
        slopes = A2 @ [0.0, 1.0, 2 * s[0]] - A1 @ [0.0, 1.0, 2 * s[1]]
        np.testing.assert_allclose(connection.matrix(s), np.stack([a1, a2], 1), rtol=0, atol=1e-13)
        exact = slopes - nh.SE(3).bracket(a1, a2)
        np.testing.assert_allclose(connection.curvature(s)[:, 0, 1], exact, rtol=0, atol=1e-13)


@LONG
def test_gaits_along_sides_in_space_are_products_of_exponentials() -> None:
    """Along each side the body velocity is constant: the phase against exponentials in 40 digits."""
    low, high, times = np.array([-0.3, 0.2]), np.array([0.6, 0.9]), np.arange(5.0)
    corners = np.array([low, (high[0], low[1]), high, (low[0], high[1]), low])
    gait = lambda t: jnp.stack([jnp.interp(t, times, side) for side in corners.T])  # noqa: E731
    phase = nh.geometric_phase(swimming(), gait, period=4.0, corners=[1, 2, 3])
    exact = mpmath.eye(4)
    with mpmath.workdps(40):
        for a, b in itertools.pairwise(corners):
            i = int(np.argmax(np.abs(b - a)))
            powers = [mpmath.mpf(float(a[1 - i])) ** k for k in range(3)]
            length = mpmath.mpf(float(b[i])) - mpmath.mpf(float(a[i]))
            xi = [-length * mpmath.fdot(row.tolist(), powers) for row in (A1, A2)[i]]
            exact *= mpmath.expm(mpmath.matrix(np.einsum("iab,i->ab", nh.SE(3).basis.astype(object), xi).tolist()))
    np.testing.assert_allclose(phase.holonomy, np.array(exact.tolist(), dtype=float), rtol=0, atol=1e-13)


@LONG
def test_the_area_rule_in_space_errs_by_the_third_power() -> None:
    """Halving a gait on SE(3) divides the error of the area rule by eight."""
    errors = []
    for size in (0.2, 0.1, 0.05):
        gait = lambda t, size=size: 0.2 + size * jnp.stack([jnp.cos(t), jnp.sin(t)])  # noqa: E731
        phase = nh.geometric_phase(swimming(), gait)
        errors.append(np.abs(phase.holonomy - phase.area_rule).max())
    assert np.log2(errors[0] / errors[1]) == pytest.approx(3, abs=0.15)
    assert np.log2(errors[1] / errors[2]) == pytest.approx(3, abs=0.15)


@LONG
def test_a_car_in_its_own_frame_is_the_car_in_coordinates() -> None:
    """On SE(2) a `ShapedBody` has the connection, the curvature and the phase of the system in coordinates."""
    planar = nh.local_connection(nh.examples.kinematic_car(wheel_radius=0.3, wheelbase=1.7).system)

    def rows(s: Array) -> Array:
        rates = jnp.array([0.3 / 1.7 * jnp.tan(s[1]), 0.3, 0.0])
        return jnp.concatenate([jnp.eye(3), -jnp.stack([rates, jnp.zeros(3)], 1)], 1)

    car = nh.local_connection(nh.ShapedBody(nh.SE(2), ("psi", "phi"), constraint_forms=rows))
    shapes = np.random.default_rng(7).uniform(-1, 1, (6, 2))
    np.testing.assert_allclose(car.matrix(shapes), planar.matrix(shapes), rtol=0, atol=1e-14)
    np.testing.assert_allclose(car.curvature(shapes), planar.curvature(shapes), rtol=0, atol=1e-13)
    gait = lambda t: jnp.stack([2 * jnp.sin(t), 0.5 * jnp.cos(t)])  # noqa: E731
    one, other = (nh.geometric_phase(each, gait) for each in (car, planar))
    np.testing.assert_allclose(one.holonomy, other.holonomy, rtol=0, atol=1e-13)
    np.testing.assert_allclose(one.heading, other.heading, rtol=0, atol=1e-13)
    assert nh.accessibility(car.system, (0.2, 0.3)).growth == (2, 3, 4, 5)


@LONG
def test_brackets_on_groups_are_those_of_the_algebra() -> None:
    """With a constant connection the brackets are those of the vectors (-A_i, e_i) of the algebra."""
    A = np.random.default_rng(8).normal(size=(6, 2))
    body = nh.ShapedBody(nh.SE(3), ("a", "b"), constraint_forms=lambda s: jnp.hstack([jnp.eye(6), A]) + 0 * s[0])
    found = nh.accessibility(body, (0.3, -0.2), depth=5)
    fields = layer = [(-a, e) for a, e in zip(A.T, np.eye(2), strict=True)]
    ranks = []
    while len(ranks) < len(found.growth):
        ranks.append(int(np.linalg.matrix_rank(np.array([np.append(*field) for field in fields]), rtol=1e-9)))
        layer = [(nh.SE(3).bracket(-a, x), np.zeros(2)) for a in A.T for x, _ in layer]
        fields = fields + layer
    assert found.growth == tuple(ranks)
    assert found.is_accessible


@LONG
def test_a_pose_that_is_a_function_of_the_shape_stays_one() -> None:
    r"""With $g = e^{s_1e_1}e^{s_2e_2}$ motions fill a surface: brackets add nothing, the curvature is zero."""

    def rows(s: Array) -> Array:
        first = jnp.stack([jnp.cos(s[1]), 0.0, jnp.sin(s[1])])  # of g^-1 dg
        return jnp.concatenate([jnp.eye(3), -jnp.stack([first, jnp.eye(3)[1]], 1)], 1)

    body, s = nh.ShapedBody(nh.SO(3), ("a", "b"), constraint_forms=rows), (0.3, -0.7)
    np.testing.assert_allclose(nh.local_connection(body).curvature(s), 0.0, rtol=0, atol=1e-15)
    assert set(nh.accessibility(body, s).growth) == {2}


# The message names the argument.
test_others_are_refused = refusals(
    ({"group": "SO(3)"}, "be a matrix group"),
    ({"shape_coordinates": ["a", "b"]}, "Pass a tuple of strings"),
    ({"shape_coordinates": ("a", "a")}, "be different names"),
    ({"shape_coordinates": ()}, "be different names"),
    ({"constraint_forms": None}, "have a Lagrangian or constraints"),
    ({"constraint_forms": lambda s: jnp.ones((3, 3)) + s[0]}, r"shape \(s, 5\)"),
    ({"lagrangian": lambda s, xi, ds: xi * ds[0] + s[0]}, "a scalar"),
    ask=lambda given: nh.ShapedBody(
        **{"group": nh.SO(3), "shape_coordinates": ("a", "b"), "constraint_forms": turner} | given
    ),
    kind=(TypeError, ValueError),
)


def test_a_body_with_free_components_needs_a_lagrangian() -> None:
    """Fewer constraints than components say nothing of the rest of the motion."""
    body = nh.ShapedBody(nh.SO(3), ("a", "b"), constraint_forms=lambda s: turner(s)[:2])
    with pytest.raises(ValueError, match="determine 3 components of the body velocity"):
        nh.local_connection(body)
