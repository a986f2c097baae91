"""The discrete equations from their definition, the rules, the starts and the regularity matrix."""

import dataclasses

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from comparisons import assert_near

import nonholo as nh
from nonholo.lagrange_dalembert import CoordinateOrbit, LagrangeDAlembert

MASS = np.array([1.0, 2.0, 0.5])
START = {"configuration": np.array([0.3, 0.5, -0.2]), "body_velocity": np.array([1.0, 0.7, 0.5])}
RULES = ("midpoint", "trapezoidal")


def lagrangian(q, v):  # noqa: ANN001, ANN201
    """Return a Lagrangian with a mass that depends on position, a gyroscopic term and a potential."""
    return (1 + q[0] ** 2 / 4) * (MASS @ v**2) / 2 + 0.3 * q[0] * v[1] - (q @ q) / 2 - q[0] * q[2]


def forms(q):  # noqa: ANN001, ANN201
    """Return the contact form dz - y dx."""
    return jnp.array([[-q[1], 0.0, 1.0]])


SYSTEM = LagrangeDAlembert(lagrangian, forms, dimension=3)


def by_definition(rule: str, h: float):  # noqa: ANN201
    """Return L_d(q, q') and F(q, q') written out in end points."""

    def midpoint(q, r):  # noqa: ANN001, ANN202
        return h * lagrangian((q + r) / 2, (r - q) / h)

    def trapezoidal(q, r):  # noqa: ANN001, ANN202
        v = (r - q) / h
        return h / 2 * (lagrangian(q, v) + lagrangian(r, v))

    def constraint(q, r):  # noqa: ANN001, ANN202
        A = forms((q + r) / 2) if rule == "midpoint" else (forms(q) + forms(r)) / 2
        return A @ ((r - q) / h)

    return midpoint if rule == "midpoint" else trapezoidal, constraint


def run(rule: str, h: float, steps: int, **changes) -> CoordinateOrbit:  # noqa: ANN003
    """Return an orbit of the system with a rule."""
    return nh.simulate(nh.discretize(dataclasses.replace(SYSTEM, rule=rule), h), **(START | {"steps": steps} | changes))


@pytest.mark.profile("routes", keep=["midpoint"])
@pytest.mark.parametrize("rule", RULES)
def test_the_equations_hold_with_their_sign(rule: str) -> None:
    """D1 L_d(q_k, q_k+1) + D2 L_d(q_k-1, q_k) = -lambda A(q_k), with derivatives taken in end points."""
    h = 0.1
    orbit = run(rule, h, 50)
    action, constraint = by_definition(rule, h)
    with jax.enable_x64(True):
        for k in range(1, 50, 6):
            q, r, before = (jnp.asarray(orbit.configuration[j]) for j in (k, k + 1, k - 1))
            left = jax.grad(action)(q, r) + jax.grad(action, argnums=1)(before, q)
            # the velocity (r - q)/h loses a factor 1/h of the rounding unit
            assert np.abs(left + orbit.multipliers[k - 1] @ forms(q)).max() <= 1e-13
            assert np.abs(constraint(q, r)).max() <= 1e-13


@pytest.mark.profile("routes", keep=["midpoint*"])
@pytest.mark.parametrize("rule", RULES)
def test_momentum_and_energy_are_derivatives_of_the_action(rule: str) -> None:
    """Momentum is -D1 L_d and energy -dL_d/dh at fixed end points (centered difference, error h^2 1e-8)."""
    h = 0.1
    orbit = run(rule, h, 5)
    with jax.enable_x64(True):
        q, r = (jnp.asarray(orbit.configuration[j]) for j in (3, 4))
        assert np.abs(orbit.momentum[3] + jax.grad(by_definition(rule, h)[0])(q, r)).max() <= 1e-13
        later, earlier = (float(by_definition(rule, h + e)[0](q, r)) for e in (1e-5, -1e-5))
    assert abs(orbit.energy[3] + (later - earlier) / 2e-5) <= 1e-7


def test_blocks_join_without_a_seam() -> None:
    """A run longer than one compiled block is the run of its parts: it can be taken up by displacement."""
    whole = run("midpoint", 0.05, 2500)
    at = 1500
    start = {"configuration": whole.configuration[at], "displacement": whole.displacement[at]}
    rest = nh.simulate(nh.discretize(SYSTEM, 0.05), **start, steps=50)
    assert whole.configuration.shape == (2501, 3)
    assert whole.multipliers.shape == (2500, 1)
    assert np.abs(rest.configuration - whole.configuration[at : at + 51]).max() <= 1e-12


def test_momentum_starts_where_the_velocity_does() -> None:
    """p_0 = dL/dv, and p_0 plus any multiple of the constraint form, begin the same run and the same flow."""
    q, v = START["configuration"], START["body_velocity"]
    with jax.enable_x64(True):
        p = np.asarray(jax.grad(lagrangian, argnums=1)(q, v)) + 3.0 * np.array([-q[1], 0.0, 1.0])
    orbit = nh.simulate(nh.discretize(SYSTEM, 0.1), configuration=q, momentum=p, steps=5)
    assert np.abs(orbit.configuration - run("midpoint", 0.1, 5).configuration).max() <= 1e-14
    flow, other = (nh.flow(SYSTEM, **how, times=[0, 1.0]) for how in (START, {"configuration": q, "momentum": p}))
    assert np.abs(flow.configuration - other.configuration).max() <= 1e-14


@pytest.mark.profile("routes", keep=["midpoint"])
@pytest.mark.parametrize("rule", RULES)
def test_the_start_is_second_order_in_momentum(rule: str) -> None:
    """Along admissible directions P_k is the momentum of the flow to second order: slope 2.0 +- 0.1."""
    time, counts = 1.0, (20, 40, 80, 160)
    flow = nh.flow(SYSTEM, **START, times=[0.0, time], rtol=1e-13, atol=1e-14)
    errors = []
    for n in counts:
        orbit = run(rule, time / n, n)
        y = orbit.configuration[-1, 1]
        admissible = np.array([[1.0, 0.0, y], [0.0, 1.0, 0.0]])
        errors.append(np.abs(admissible @ (orbit.momentum[-1] - flow.momentum[-1])).max())
    assert abs(-np.polyfit(np.log(counts), np.log(errors), 1)[0] - 2.0) <= 0.1


def test_regularity_has_no_units() -> None:
    """Scaling coordinates, time and energy does not change the least singular value."""
    scale = np.array([10.0, 0.1, 3.0])

    def rescaled(q, v):  # noqa: ANN001, ANN202
        return 100 * lagrangian(q / scale, v / scale / 7)

    def rescaled_forms(q):  # noqa: ANN001, ANN202
        return 5 * forms(q / scale) / scale

    q, r = START["configuration"], START["configuration"] + [0.3, 0.2, 0.2]
    other = LagrangeDAlembert(lambda q, v: rescaled(q, 7 * 7 * v), rescaled_forms, dimension=3)
    there = other.regularity(q * scale, r * scale, time_step=0.1 * 7)
    assert abs(there - SYSTEM.regularity(q, r, time_step=0.1)) <= 1e-12


def test_regularity_of_one_constraint_is_the_golden_ratio() -> None:
    """For L = v.v/2 and one constant form the matrix is Id beside (0 -1; 1 1): least singular value 0.618."""
    plane = LagrangeDAlembert(lambda _, v: v @ v / 2, lambda _: jnp.ones((1, 3)), dimension=3)
    assert abs(plane.regularity(np.zeros(3), [1.0, -1.0, 0.0], time_step=0.1) - (np.sqrt(5) - 1) / 2) <= 1e-14


@pytest.mark.profile("routes", instead="test_the_equations_hold_with_their_sign")
def test_functions_of_two_configurations_are_taken_too() -> None:
    """An L_d(q, q') and F(q, q') made for one time step give the orbit of the rule that they spell out."""
    h = 0.1

    def action(q: jax.Array, r: jax.Array) -> jax.Array:
        return h * SYSTEM.lagrangian((q + r) / 2, (r - q) / h)

    def constraint(q: jax.Array, r: jax.Array) -> jax.Array:
        return SYSTEM.constraint_forms((q + r) / 2) @ (r - q) / h

    options = {"dimension": 3, "discrete_lagrangian": action, "discrete_constraints": constraint}
    result = nh.discretize(LagrangeDAlembert(SYSTEM.lagrangian, SYSTEM.constraint_forms, **options), h)
    expected = nh.simulate(nh.discretize(SYSTEM, h), **START, steps=20)
    orbit = nh.simulate(result, **START, steps=20)
    assert_near(orbit, expected, 1e-12, "configuration", "multipliers")
    assert np.abs(orbit.energy - expected.energy).max() <= 0.01 * np.abs(expected.energy).max()
    q, r = expected.configuration[:2]
    assert abs(result.regularity(q, r) - SYSTEM.regularity(q, r, time_step=h)) <= 1e-12


@pytest.mark.profile("routes", instead="test_the_equations_hold_with_their_sign")
def test_the_sleigh_moves_as_on_its_group() -> None:
    """In (theta, x, y) with the discrete Lagrangian of the group route: the same poses, impulses and momenta.

    Poses of size 40 after 200 steps, impulses in size and sign, and <P_k, v> agree to rounding, below 1e-11.
    """
    sleigh, h = nh.ChaplyginSleigh(mass=1.3, inertia=0.7, a=0.5, b=0.2), 0.15

    def in_body(angle, v, xp=jnp):  # noqa: ANN001, ANN202
        c, s = xp.cos(angle), xp.sin(angle)
        return xp.stack([v[..., 0], c * v[..., 1] + s * v[..., 2], -s * v[..., 1] + c * v[..., 2]], axis=-1)

    def kinetic(q, v):  # noqa: ANN001, ANN202
        w = in_body(q[0], v)
        return w @ np.asarray(sleigh.inertia_operator) @ w / 2

    def pose(q):  # noqa: ANN001, ANN202
        c, s = jnp.cos(q[0]), jnp.sin(q[0])
        return jnp.array([[c, -s, q[1]], [s, c, q[2]], [0.0, 0.0, 1.0]])

    def action(q, r, h):  # noqa: ANN001, ANN202
        X = jnp.linalg.inv(pose(q)) @ pose(r) - jnp.eye(3)
        return jnp.trace(X @ np.asarray(sleigh.homogeneous_mass_tensor) @ X.T) / (2 * h)

    def blade(q):  # noqa: ANN001, ANN202
        return jnp.array([[0.0, -jnp.sin(q[0]), jnp.cos(q[0])]])

    own = {"discrete_lagrangian": action, "discrete_constraints": lambda q, r, _: blade((q + r) / 2) @ (r - q)}
    system = LagrangeDAlembert(kinetic, blade, dimension=3, **own)
    start, velocity = np.array([0.4, 1.0, -2.0]), np.array([1.0, -1.0, 0.0])
    run = {"configuration": start, "body_velocity": in_body(-start[0], velocity, np)}
    ours = nh.simulate(nh.discretize(system, h), **run, steps=200)
    g = nh.SE(2).matrix_from_pose(np.array([np.cos(start[0]), np.sin(start[0]), *start[1:]]))
    group = nh.simulate(nh.discretize(sleigh, h), body_velocity=velocity, configuration=g, steps=200)
    turned = ours.configuration[:, 0] - group.heading
    assert np.abs(turned - turned[0]).max() <= 1e-11
    assert np.abs(ours.configuration[:, 1:] - group.position).max() <= 1e-11
    assert np.abs(group.multipliers).max() > 0.1
    assert np.abs(ours.multipliers - group.multipliers).max() <= 1e-11
    assert np.abs(in_body(ours.configuration[:, 0], ours.momentum, np) - group.momentum).max() <= 1e-11


@pytest.mark.profile("routes", instead="test_the_midpoint_rule_is_reversible")
@pytest.mark.parametrize("rule", RULES)
def test_without_gyroscopic_terms_the_map_is_reversible(rule: str) -> None:
    """L_d is symmetric for a Lagrangian even in v: the reversed displacement leads back."""

    def even(q, v):  # noqa: ANN001, ANN202
        return lagrangian(q, v) - 0.3 * q[0] * v[1]

    discrete = nh.discretize(LagrangeDAlembert(even, forms, dimension=3, rule=rule), 0.1)
    there = nh.simulate(discrete, **START, steps=100)
    back = nh.simulate(discrete, configuration=there.configuration[-1], displacement=-there.displacement[-2], steps=99)
    # errors of 200 steps, each of a few rounding units, on a motion that is not unstable
    assert np.abs(back.configuration - there.configuration[:0:-1]).max() <= 1e-12


@pytest.mark.profile("routes", instead="test_the_equations_hold_with_their_sign")
def test_unconstrained_midpoint_conserves_quadratic_invariants() -> None:
    """Without constraints the rule is the implicit midpoint rule: a plane oscillator keeps q_0 p_1 - q_1 p_0."""
    free = LagrangeDAlembert(lambda q, v: (v @ v - q @ q) / 2, None, dimension=2)
    orbit = nh.simulate(nh.discretize(free, 0.2), configuration=[1.0, 0.0], body_velocity=[0.2, 0.9], steps=1000)
    q, p = orbit.configuration, orbit.momentum
    assert orbit.multipliers.shape == (1000, 0)
    assert np.ptp(q[:, 0] * p[:, 1] - q[:, 1] * p[:, 0]) <= 1e-12
