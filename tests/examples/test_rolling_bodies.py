"""Disk, rattleback, ball on a turntable, trailers and snake: flows against equations derived another way."""

import functools
from collections.abc import Callable

import jax
import jax.numpy as jnp
import numpy as np
import published
import pytest
from accelerations import acceleration
from comparisons import derivatives
from refusals import refusals
from scipy.integrate import solve_ivp

import nonholo as nh
from nonholo.base.numerics import double_precision
from nonholo.base.types import Array

X = nh.examples
ACCURATE = {"rtol": 1e-13, "atol": 1e-13}
ROUTES = pytest.mark.profile("routes", instead="test_the_disk_has_the_equations_that_a_page_of_sympy_lacks")


def solved(rate: Callable, first: Array, times: Array, **to: float) -> Array:
    """Return the solution at the times, a row each."""
    return solve_ivp(rate, (0.0, times[-1]), first, t_eval=times, method="DOP853", **(to or ACCURATE)).y.T


def order(ready: nh.examples.Example, flow: nh.lagrange_dalembert.CoordinateOrbit, steps: int) -> float:
    """Return how fast the ends of runs tend to that of the flow, between two numbers of steps."""
    runs = (ready.simulate(steps=n, time_step=flow.time[-1] / n) for n in (steps, 2 * steps))
    coarse, fine = (np.abs(run.configuration[-1] - flow.configuration[-1]).max() for run in runs)
    return np.log2(coarse / fine)


def disk_by_newton_and_euler(_time: float, z: Array) -> list[float]:
    """Lean, its rate, the turning across, the spin; heading, roll, contact: from forces, and torques at the middle."""
    m, R, axle, J, g = 1.2, 0.7, 0.3, 0.11, 9.81
    lean, dlean, w3, w2, heading = z[:5]
    sin, cos = np.sin(lean), np.cos(lean)
    turning = w3 / cos
    dw2 = -m * R**2 * w3 * dlean / (axle + m * R**2)  # the force ahead, m R (w2' + w3 lean'), slows the spin
    spun = np.cross([dlean, turning * sin, w3], [J * dlean, axle * w2, J * w3])
    across = m * R * w3 * w2 + m * g * sin  # force to the left, but for m R lean''
    ddlean = (R * across - spun[0]) / (J + m * R**2)
    roll = w2 - turning * sin
    return [dlean, ddlean, -spun[2] / J, dw2, turning, roll, R * roll * np.cos(heading), R * roll * np.sin(heading)]


@pytest.mark.profile("routes", instead="test_the_disk_has_the_equations_that_a_page_of_sympy_lacks")
def test_the_disk_moves_as_balances_of_momentum_say() -> None:
    """A disk that wobbles, to 1e-10; the map is of order two."""
    body = {"mass": 1.2, "radius": 0.7, "rolling_inertia": 0.3, "turning_inertia": 0.11, "gravity": 9.81}
    start = {"configuration": (0.1, -0.2, 0.3, 0.25, 0.0), "turning": 1.3, "lean_rate": -0.4, "rolling": 2.0}
    ready, times = X.tilting_disk(**body, **start), np.linspace(0.0, 2.0, 9)
    sin, cos = np.sin(0.25), np.cos(0.25)
    first = np.array([0.25, -0.4, 1.3 * cos, 2.0 + 1.3 * sin, 0.3, 0.0, 0.1, -0.2])
    exact = solved(disk_by_newton_and_euler, first, times)
    result = ready.flow(times=times, **ACCURATE)
    assert np.abs(result.configuration - exact[:, [6, 7, 4, 0, 5]]).max() <= 1e-10
    assert abs(order(ready, result, 400) - 2.0) <= 0.1


@pytest.mark.parametrize("seed", range(6))
def test_the_disk_has_the_equations_that_a_page_of_sympy_lacks(seed: int) -> None:
    """Of a uniform disk, at random leans and rates: those of sympy#27631, which corrects that page."""
    rng = np.random.default_rng(seed)
    lean, rates, gravity = rng.uniform(-1.3, 1.3), rng.normal(size=3) * 2, 3.0
    q, v = np.array([0.0, 0.0, 0.4, lean, 0.0]), np.array([np.cos(0.4) * rates[2], np.sin(0.4) * rates[2], *rates])
    with double_precision():
        result = np.asarray(of_the_disk(gravity)(jnp.asarray(q), jnp.asarray(v)))
    wanted = published.rolling_disk(gravity, rates, lean)
    assert np.abs(result[2:] - wanted).max() <= 1e-13 * np.abs(wanted).max()


@functools.cache
def of_the_disk(gravity: float) -> Callable:
    """Return the accelerations of a uniform disk, compiled once."""
    return jax.jit(functools.partial(acceleration, X.tilting_disk(gravity=gravity).system.plain))


@ROUTES
@pytest.mark.parametrize("lean", [-0.6, 0.05, 0.9])
@pytest.mark.parametrize("turning", [-2.0, 0.4, 1.5])
def test_steady_circles_are_the_closed_form(lean: float, turning: float) -> None:
    """Whatever lean and turning."""
    ready = X.tilting_disk(configuration=(0.2, -0.1, 0.7, lean, 0.3), turning=turning, gravity=2.0)
    orbit = ready.flow(times=np.linspace(0.0, 1.0, 5), **ACCURATE)
    assert np.abs(orbit.configuration - ready.exact(orbit.time)).max() <= 1e-11
    whole = ready.body_velocity[4] + turning * np.sin(lean)
    balance = (0.25 * turning * np.sin(lean) - 1.5 * whole) * turning * np.cos(lean)
    assert abs(balance - 2.0 * np.sin(lean)) <= 1e-13


@ROUTES
def test_a_fast_disk_stays_upright() -> None:
    """A tenth below the speed sqrt(g R / 3) a small lean grows a thousandfold, above it sways about another one."""
    limit = np.sqrt(1 / 3)
    grown = []
    for speed in (0.9 * limit, 1.1 * limit):
        ready = X.tilting_disk(configuration=(0.0, 0.0, 0.0, 1e-6, 0.0), turning=0.0, rolling=speed)
        grown.append(np.abs(ready.flow(times=np.linspace(0.0, 24.0, 121)).configuration[:, 3]).max() / 1e-6)
    assert grown[0] > 1000 > 20 > grown[1]


def boat_by_newton_and_euler(a2: Array, low: float, tensor: Array, g: float) -> Callable[[float, Array], Array]:
    """Return rates of (vertical, its forward axis, angular velocity) of the rattleback, seen from the body."""

    def rates(_time: float, z: Array) -> Array:
        up, ahead, w = z.reshape(3, 3)
        width = np.sqrt(up @ (a2 * up))
        contact = np.array([0.0, 0.0, low]) - a2 * up / width  # from the center of mass
        dup = np.cross(up, w)
        dcontact = a2 * up * (up @ (a2 * dup)) / width**3 - a2 * dup / width
        # v = contact x w; force F = (v' + w x v) + g up; torque contact x F = tensor w' + w x tensor w
        reference = np.cross(dcontact, w) + np.cross(w, np.cross(contact, w)) + g * up
        about = tensor + (contact @ contact) * np.eye(3) - np.outer(contact, contact)
        dw = np.linalg.solve(about, np.cross(contact, reference) - np.cross(w, tensor @ w))
        return np.concatenate([dup, np.cross(ahead, w), dw])

    return rates


@ROUTES
def test_the_rattleback_moves_as_balances_of_momentum_say() -> None:
    """The published body over its reversal: heading to 1e-6, lean and pitch to 1e-7; rattling multiplies 1e-11."""
    ready, times = X.rattleback(), np.linspace(0.0, 8.5, 18)
    tensor = np.array([[2.0, 0.2, 0.0], [0.2, 16.0, 0.0], [0.0, 0.0, 17.0]])
    lean = 0.01
    first = np.array([0.0, np.sin(lean), np.cos(lean), 1.0, 0.0, 0.0, 0.0, 5 * np.sin(lean), 5 * np.cos(lean)])
    exact = solved(boat_by_newton_and_euler(np.array([20.0, 3.0, 2.0]) ** 2, 1.0, tensor, 980.665), first, times)
    result = ready.flow(times=times, rtol=1e-11, atol=1e-11)
    up, ahead = exact[:, :3], exact[:, 3:6]
    lean, pitch = np.arcsin(up[:, 1]), np.arctan2(-up[:, 0], up[:, 2])
    assert np.abs(result.configuration[:, 3:] - np.stack([lean, pitch], axis=1)).max() <= 1e-7
    # x of space in the body is e(-heading) of the level axes of the body
    level = np.stack([np.cos(pitch), np.zeros(18), np.sin(pitch)], axis=1)
    left = np.cross(up, level)
    heading = np.arctan2(-(ahead * left).sum(axis=1), (ahead * level).sum(axis=1))
    assert np.abs(np.exp(1j * heading) - np.exp(1j * result.configuration[:, 2])).max() <= 1e-6
    assert result.body_velocity[0, 2] == 5.0
    assert result.body_velocity[-1, 2] < -4.0  # turned back
    assert np.ptp(result.energy) <= 1e-9 * result.energy[0]


@ROUTES
def test_the_rattleback_turns_on_in_the_other_direction() -> None:
    """The map as the flow: the spin of one sign reverses within ten seconds, that of the other stays."""
    ends = [X.rattleback(spin=spin).simulate(steps=4000, time_step=0.0025).body_velocity[-1, 2] for spin in (5.0, -5.0)]
    assert ends[0] < -4.9
    assert ends[1] < -4.5


def test_the_ball_on_the_turntable_runs_on_circles() -> None:
    """The flow is the closed form; the middle of the map turns by 2 arctan(h kappa / 2) each step; two sevenths."""
    for table_rate in (0.0, 1e-5, -2.0):
        ready = X.ball_on_turntable(
            table_rate=table_rate, place=(0.3, -0.8), velocity=(0.6, 0.2), radius=0.5, inertia=0.1
        )
        orbit = ready.flow(times=np.linspace(0.0, 8.0, 9), **ACCURATE)
        assert np.abs(orbit.configuration - ready.exact(orbit.time)).max() <= 1e-11
        result = [f(orbit.configuration, orbit.body_velocity) for f in ready.conserved.values()]
        assert np.ptp(result, axis=1).max() <= 1e-11
        x, y = ready.simulate(steps=100, time_step=0.2).configuration[:, :2].T
        chord = np.diff(x + 1j * y)
        assert np.abs(np.angle(chord[1:] / chord[:-1]) - 2 * np.arctan(0.1 * 2 / 7 * table_rate)).max() <= 1e-12
    with pytest.raises(ValueError, match="nearest admissible"):
        ready.simulate(steps=1, body_velocity=np.zeros(4))


@pytest.mark.parametrize("spin", [0.0, -4.0])
def test_the_ball_in_the_bowl_is_a_spherical_pendulum_in_a_magnetic_field(spin: float) -> None:
    """The equation of its normal, solved alone, to 1e-10; what is said to be constant is; the map is of order two."""
    m, r, J, rho, g = 0.7, 0.3, 0.05, 1.4, 2.0
    body = {"mass": m, "radius": r, "inertia": J, "reach": rho, "gravity": g}
    ready = X.ball_in_bowl(**body, place=(0.5, -0.8), velocity=(0.7, 0.3), spin=spin)
    kappa, share = J * r / (rho * (J + m * r**2)), m * r**2 / (J + m * r**2)

    def rates(_time: float, z: Array) -> Array:
        n, dn = z[:3], z[3:]
        torque = kappa * spin * dn + share / rho * np.cross(n, [0.0, 0.0, -g])
        return np.concatenate([dn, np.cross(torque, n) - (dn @ dn) * n])  # n x n'' known, n.n'' = -|n'|^2

    depth = np.sqrt(rho**2 - 0.25 - 0.64)
    first = np.array([0.5, -0.8, -depth, 0.7, 0.3, (0.5 * 0.7 - 0.8 * 0.3) / depth]) / rho
    times = np.linspace(0.0, 4.0, 9)
    result = ready.flow(times=times, **ACCURATE)
    assert np.abs(result.configuration[:, :2] - rho * solved(rates, first, times)[:, :2]).max() <= 1e-10
    constants = [f(result.configuration, result.body_velocity) for f in ready.conserved.values()]
    assert np.ptp(constants, axis=1).max() <= 1e-10
    assert abs(order(ready, result, 200) - 2.0) <= 0.1


@pytest.mark.profile("routes", keep=["one"])
@pytest.mark.parametrize("hitches", [(1.0,), (0.7, 1.2, 0.5)], ids=["one", "three"])
def test_trailers_follow_by_the_recursion_of_speeds(hitches: tuple[float, ...]) -> None:
    """Headings and place to 1e-10 from the speed along the axle that the energy leaves; the map keeps the turning."""
    m, J, trailer, turned = 1.3, 0.3, 0.6, 0.2
    angles = np.linspace(0.3, -0.5, len(hitches) + 1)
    body = {"mass": m, "inertia": J, "trailer_mass": trailer, "trailer_inertia": turned}
    ready = X.trailers(hitches=hitches, **body, angles=tuple(angles), speed=0.8, turning=-0.5)

    def followed(headings: Array) -> tuple[Array, float]:
        """Return turning rates of the trailers, and the energy, both for unit speed."""
        rates, speed, energy = [], 1.0, m / 2
        for d, bend in zip(hitches, headings[:-1] - headings[1:], strict=True):
            rates.append(speed * np.sin(bend) / d)
            speed *= np.cos(bend)
            energy += trailer * speed**2 / 2 + turned * rates[-1] ** 2 / 2
        return np.array(rates), energy

    whole = 0.8**2 * followed(angles)[1]

    def rates(_time: float, z: Array) -> Array:
        turning, energy = followed(z[2:])
        u = np.sqrt(whole / energy)
        return np.array([u * np.cos(z[2]), u * np.sin(z[2]), -0.5, *(u * turning)])

    times = np.linspace(0.0, 4.0, 9)
    result = ready.flow(times=times, **ACCURATE)
    assert np.abs(result.configuration - solved(rates, ready.configuration, times)).max() <= 1e-10
    assert np.ptp(ready.simulate(steps=80).body_velocity[:, 2]) <= 1e-13


@ROUTES
def test_the_snake_moves_as_its_joints_and_its_energy_say() -> None:
    """Its two free rates by Gauss's principle: accelerations of the links projected to what the joints can do."""
    half, m, J, times = 0.5, 1.0, 0.1, np.linspace(0.0, 2.0, 9)
    ready = X.snake()

    def velocity(q: Array) -> Array:
        """Return the matrix from joint rates to all velocities, by the two equations of the docstring."""
        a, b = q[3:]
        rows = np.array([[np.sin(a), -half * (1 + np.cos(a))], [-np.sin(b), half * (1 + np.cos(b))]])
        u, w = np.linalg.solve(rows, -half * np.eye(2))
        return np.stack([u * np.cos(q[2]), u * np.sin(q[2]), w, [1.0, 0.0], [0.0, 1.0]])

    def links(q: Array) -> Array:
        """Return places and headings of the links."""
        angle = q[2] + np.array([-q[3], 0.0, q[4]])
        e = np.exp(1j * angle)
        z = q[0] + 1j * q[1] + half * np.array([-e[0] - e[1], 0.0, e[1] + e[2]])
        return np.concatenate([z.real, z.imag, angle])

    masses = np.array([m, m, m, m, m, m, J, J, J])

    def moved(q: Array) -> Array:
        return derivatives(links, q) @ velocity(q)

    def rates(_time: float, z: Array) -> Array:
        """Gauss's principle: accelerations of the links, projected to the motions of the constraint."""
        q, joints = z[:5], z[5:]
        v = velocity(q) @ joints
        B, bias = moved(q), derivatives(lambda s: moved(q + s * v) @ joints, np.zeros(1))[:, 0]
        return np.concatenate([v, np.linalg.solve(B.T * masses @ B, -(B.T * masses) @ bias)])

    loose = solved(rates, np.array([*ready.configuration, 0.3, 0.5]), times, rtol=1e-10, atol=1e-10)
    result = ready.flow(times=times, **ACCURATE)
    assert np.abs(result.configuration - loose[:, :5]).max() <= 1e-8
    assert np.ptp(ready.conserved["energy"](result.configuration, result.body_velocity)) <= 1e-11


@ROUTES
def test_the_snake_passes_where_it_is_an_arc() -> None:
    """Where the joints become alike they move oppositely, and the motion continues."""
    ready = X.snake()
    event = nh.Event(lambda states: states.configuration[:, 3] - states.configuration[:, 4], name="arc")
    rates = ready.flow(times=np.linspace(0.0, 13.0, 131), events=[event]).events["arc"].states.body_velocity[:, 3:]
    assert len(rates) == 2
    assert np.abs(rates.sum(axis=1)).max() <= 1e-8 < 0.1 < np.abs(rates).min()


# Each refusal names the argument and what it must be.
test_bad_parameters_are_refused = refusals(
    (lambda: X.tilting_disk(configuration=(0, 0, 0, 1.6, 0)), r"have \|lean\| < pi/2"),
    (lambda: X.tilting_disk(turning=0.0), "not be zero on a circle"),
    (lambda: X.rattleback(semi_axes=(1.0, -2.0, 3.0)), r"semi_axes\[1\]=...\)` must be positive"),
    (lambda: X.ball_on_turntable(inertia=0.0), r"inertia=...\)` must be positive"),
    (lambda: X.ball_in_bowl(place=(0.8, 0.7)), "be less than 1 from the axis"),
    (lambda: X.trailers(hitches=()), "at least one length"),
    (lambda: X.trailers(angles=(0.0,)), r"angles=...\)` must have shape \(4,\)"),
    (lambda: X.snake(joints=(0.5, 0.5)), "differ and be between"),
    (lambda: X.bicycle(rear_wheel=(0.3, 2.0, 0.0, 0.1)), r"rear_wheel\[2\]=...\)` must be positive"),
)


@pytest.mark.profile("routes", instead="test_accelerations_far_from_upright_are_published")
def test_the_linear_equations_are_those_of_the_benchmark() -> None:
    """M from torques, C1, K0 and K2 from derivatives at two speeds: 14 digits of the largest entry of each."""
    matrices = published.M, published.C1, published.K0, published.K2
    for result, wanted in zip(published.linear_equations(), matrices, strict=True):
        assert np.abs(result - wanted).max() <= 1e-14 * np.abs(wanted).max()


@pytest.mark.profile("routes", instead="test_accelerations_far_from_upright_are_published")
@pytest.mark.parametrize("speed", published.EIGENVALUES)
def test_eigenvalues_are_those_of_the_table(speed: int) -> None:
    """To the last of its 14 decimals but one."""
    listed = np.array(published.EIGENVALUES[speed])
    gaps = np.abs(published.spectrum(float(speed)) - np.concatenate([listed, listed.conj()])[:, None])
    assert gaps.min(axis=1).max() <= 2e-12


def test_accelerations_far_from_upright_are_published() -> None:
    """Of a turning, leaning, steered state: table 1 of Basu-Mandal et al., in its 13 digits, turned into our axes."""
    height, slip, result, wanted = published.turning_state()
    assert abs(height) <= 1e-13
    assert slip <= 1e-12
    assert np.abs(result - wanted).max() <= 2e-12


@pytest.mark.profile("routes", instead="test_accelerations_far_from_upright_are_published")
def test_the_front_wheel_stays_on_the_ground() -> None:
    """The height of its lowest point is zero to rounding, as it turns by a tenth: the midpoint rule would lift it."""
    ready = nh.examples.bicycle()
    orbit = ready.simulate(steps=100, time_step=0.02)
    height = ready.conserved["height of the front contact"](orbit.configuration, orbit.body_velocity)
    assert np.abs(height).max() <= 1e-14
    assert np.ptp(orbit.configuration[:, 2]) > 0.1


@pytest.mark.profile("routes", instead="nonholo.analysis._linearize.critical_values")
def test_one_call_gives_the_weave_and_the_capsize_speed() -> None:
    """To the nine decimals that are published."""

    def riding(speed: float) -> nh.analysis.Linearization:
        ready = nh.examples.bicycle(speed=speed, lean_rate=0.0, steer_rate=0.0)
        return nh.linearize(ready.system, configuration=ready.configuration, body_velocity=ready.body_velocity)

    assert np.abs(nh.critical_values(riding, (3.0, 8.0), samples=5) - published.SPEEDS).max() < 1e-9
