"""The ready examples: what is known of their motion holds along the flow, and the map converges to the flow.

Energies -dL_d/dh of the discrete motions are bounded, settle, wander or drift, always by amounts of size h^2.
"""

import functools

import numpy as np
import pytest
from refusals import refusals

import nonholo as nh
from nonholo.examples import Example
from nonholo.lagrange_dalembert import CoordinateOrbit

BY_HAND = {
    *("driven_sleigh", "roller_racer", "twistcar", "chaplygin_ball", "heavy_suslov_top", "sleigh_in_a_well"),  # driven
    *("ball_in_bowl", "ball_on_turntable", "bicycle", "rattleback", "snake", "tilting_disk", "trailers"),  # rolling
}
EXAMPLES = sorted({*nh.examples.__all__} - {"Example"} - BY_HAND)
EXACT = ("particle", "rolling_disk", "knife_edge_on_incline", "kinematic_car")
TIMES = np.linspace(0.0, 4.0, 9)


@functools.cache
def ready(name: str, **parameters: float) -> Example:
    """Return an example."""
    return getattr(nh.examples, name)(**parameters)


@functools.cache
def flow(name: str) -> CoordinateOrbit:
    """Return an accurate flow of an example: relative errors per step 1e-13."""
    return ready(name).flow(times=TIMES, rtol=1e-13, atol=1e-14)


@functools.cache
def run(name: str, h: float, duration: float = 4.0, **parameters: float) -> CoordinateOrbit:
    """Return the discrete orbit of an example, by default over the time of its flow."""
    return ready(name, **parameters).simulate(time_step=h, steps=round(duration / h))


@pytest.mark.profile("routes", keep=["particle"])
@pytest.mark.parametrize("name", EXACT)
def test_the_flow_is_the_published_solution(name: str) -> None:
    """Configurations agree with the closed form; a few steps of relative error 1e-13 stay below 1e-11."""
    assert np.abs(flow(name).configuration - ready(name).exact(TIMES)).max() <= 1e-11


@pytest.mark.profile("routes", keep=["particle"])
@pytest.mark.parametrize("name", EXAMPLES)
def test_conserved_quantities_are_constant_along_the_flow(name: str) -> None:
    """Each of them, one at least, and the energy, to rounding and solver errors; velocities stay admissible."""
    orbit = flow(name)
    result = [f(orbit.configuration, orbit.body_velocity) for f in ready(name).conserved.values()]
    assert len(result) > 0
    assert max(np.ptp(values) / np.abs(values).max(initial=1.0) for values in result) <= 1e-11
    assert np.ptp(orbit.energy) <= 1e-11
    assert orbit.constraint_residual.max() <= 1e-14


@pytest.mark.profile("routes", keep=["particle"])
@pytest.mark.parametrize("name", EXAMPLES)
def test_the_map_satisfies_its_constraint_and_has_order_two(name: str) -> None:
    """Discrete constraints hold to rounding; configurations converge to the flow with slope 2.0 +- 0.1."""
    counts, errors = (40, 80, 160), []
    for n in counts:
        orbit = run(name, 4.0 / n)
        assert orbit.constraint_residual.max() <= 1e-14
        errors.append(np.abs(orbit.configuration[-1] - flow(name).configuration[-1]).max())
    assert abs(-np.polyfit(np.log(counts), np.log(errors), 1)[0] - 2.0) <= 0.1


@pytest.mark.profile("routes", instead="test_the_disk_keeps_its_energy")
def test_the_disk_rolls_on_the_circle_of_the_midpoint_rule() -> None:
    """Contact points are at the radius R theta'_h h / (2 sin(h phi'/2)) from one center; 40 steps of rounding."""
    orbit, h, turning = run("rolling_disk", 0.1), 0.1, 0.5
    rolling = 1.5 / (np.cos(h * turning / 2) + 0.5)  # m R^2 = 1, I = 1/2, theta' = 1
    radius = rolling * h / (2 * np.sin(h * turning / 2))
    points = orbit.configuration[:, :2]
    assert np.abs(orbit.body_velocity[:, 2:] - [rolling, turning]).max() <= 1e-13
    # the first step points along phi = h phi'/2: the disk's heading at (0, 0) is the circle's tangent, the center above
    assert np.abs(np.hypot(points[:, 0], points[:, 1] - radius) - radius).max() <= 1e-13


@pytest.mark.profile("routes", instead="test_the_disk_keeps_its_energy")
def test_the_knife_edge_draws_the_cycloid_of_the_midpoint_rule() -> None:
    """The speed of each step is w + G h / sin(h phi') sin(phi) at the heading of its middle."""
    orbit, h = run("knife_edge_on_incline", 0.1), 0.1
    heading = orbit.configuration[:, 2] + h / 2  # phi' = 1
    along = orbit.body_velocity[:, 0] * np.cos(heading) + orbit.body_velocity[:, 1] * np.sin(heading)
    assert np.ptp(along - h / np.sin(h) * np.sin(heading)) <= 1e-13


@pytest.mark.profile("routes", instead="test_motions_that_become_straight_settle")
def test_the_robot_speeds_up_like_a_sleigh() -> None:
    """Speed is u_inf tanh kappa(t - t0), turning rate omega_0 sech kappa(t - t0), constants as derived."""
    orbit = flow("two_wheeled_robot")
    M, K = 1.0 + 2 * 0.01 / 0.25**2, 0.5 + 0.3**2 + 2 * 0.01 * 0.5**2 / 0.25**2
    energy = (M * 0.5**2 + K) / 2
    limit, largest = np.sqrt(2 * energy / M), np.sqrt(2 * energy / K)
    phase = 0.3 * limit / K * TIMES + np.arctanh(-0.5 / limit)
    theta, v = orbit.configuration[:, 2], orbit.body_velocity
    assert np.abs(v[:, 0] * np.cos(theta) + v[:, 1] * np.sin(theta) - limit * np.tanh(phase)).max() <= 1e-11
    assert np.abs(v[:, 2] - largest / np.cosh(phase)).max() <= 1e-11


@pytest.mark.profile("routes", keep=["particle"])
@pytest.mark.parametrize(
    ("name", "rows"),
    [("particle", ["y'"]), ("snakeboard", ["phi'", "theta' + psi'"]), ("two_wheeled_robot", ["axle"])],
    ids=["particle", "snakeboard", "robot"],
)
def test_what_the_midpoint_rule_conserves(name: str, rows: list[str]) -> None:
    """Momenta along constant admissible directions and integrable linear constraints are kept; the others are not."""
    orbit = run(name, 0.1)
    middle = orbit.configuration + orbit.displacement / 2
    spread = {key: np.ptp(f(middle, orbit.body_velocity)) for key, f in ready(name).conserved.items()}
    assert {key for key, width in spread.items() if width <= 1e-13} == set(rows)
    assert max(spread.values()) > 1e-5


@pytest.mark.profile("routes", instead="test_conserved_quantities_are_constant_along_the_flow")
def test_one_pair_of_oscillators_has_its_own_potential() -> None:
    """With one pair the coupling z_1 z_2 is absent, and the conserved function is the energy of the Lagrangian."""
    single = nh.examples.chaotic_quartic_oscillator(pairs=1)
    orbit = single.flow(times=TIMES)
    assert single.coordinates == ("x", "y1", "z1")
    assert np.abs(single.conserved["energy"](orbit.configuration, orbit.body_velocity) - orbit.energy).max() <= 1e-14


# Each refusal names the argument and what it must be.
test_bad_parameters_are_refused = refusals(
    (lambda: nh.examples.particle(mass=0.0), r"particle\(mass=...\)` must be positive"),
    (lambda: nh.examples.particle(planar_velocity=(1.0,)), r"planar_velocity=...\)` must have shape"),
    (lambda: nh.examples.rolling_disk(radius=np.nan), r"radius=...\)` must be finite"),
    (lambda: nh.examples.knife_edge_on_incline(turning=0.0), r"turning=...\)` must not be zero"),
    (lambda: nh.examples.snakeboard(rotor_inertia=1.0), r"be less than m r\^2 = 1"),
    (lambda: nh.examples.snakeboard(configuration=(0, 0, 0, 0, 1.6)), r"have \|phi\| < pi/2"),
    (lambda: nh.examples.kinematic_car(configuration=(0, 0, 0, 0, 1.6)), r"have \|phi\| < pi/2"),
    (lambda: nh.examples.two_wheeled_robot(half_width=-1.0), r"half_width=...\)` must be positive"),
    (lambda: nh.examples.chaotic_quartic_oscillator(pairs=0), r"pairs=...\)` must be a positive integer"),
    (lambda: nh.examples.driven_sleigh(speed=None), r"speed=...\)` must be an array of real numbers"),
    (lambda: nh.examples.non_reversible(turning="fast"), r"turning=...\)` must be an array of real numbers"),
)


def test_the_rotor_turns_with_the_board() -> None:
    """The kinetic energy of the snakeboard is that of its parts, each with its velocity in space."""
    m, r, J0, J1 = 1.3, 0.7, 0.2, 0.05
    board = nh.examples.snakeboard(mass=m, half_length=r, rotor_inertia=J0, wheel_inertia=J1).system.plain
    v = np.array([0.3, -0.2, 0.5, 1.1, -0.4])
    parts = m * (v[0] ** 2 + v[1] ** 2) + (m * r * r - J0) * v[2] ** 2 + J0 * (v[2] + v[3]) ** 2 + 2 * J1 * v[4] ** 2
    assert float(board.lagrangian(np.zeros(5), v)) == pytest.approx(parts / 2, rel=1e-6)


def test_gravity_pulls_the_blade_down_the_slope() -> None:
    """The Lagrangian of the knife edge grows along the first axis, which points downhill."""
    blade, v = ready("knife_edge_on_incline").system.plain, np.zeros(3)
    assert float(blade.lagrangian(np.array([1.0, 0.0, 0.0]), v)) > float(blade.lagrangian(np.zeros(3), v))


def change(name: str, h: float, duration: float, **parameters: float) -> np.ndarray:
    """Return the energy less that of the first step."""
    energy = run(name, h, duration, **parameters).energy
    return energy - energy[0]


@pytest.mark.profile("routes", keep=["particle-*"])
@pytest.mark.parametrize(
    ("name", "duration"),
    [
        ("particle", 100.0),
        ("knife_edge_on_incline", 100.0),
        ("snakeboard", 40.0),
        ("two_wheeled_robot", 100.0),
        ("chaotic_quartic_oscillator", 5.0),
        ("non_reversible", 100.0),
    ],
)
def test_the_energy_error_is_of_second_order(name: str, duration: float) -> None:
    """Halving the step divides the largest error by 4, within 4 percent (terms in h^4)."""
    coarse, fine = (np.abs(change(name, h, duration)).max() for h in (0.1, 0.05))
    assert coarse > 1e-4
    assert abs(coarse / fine - 4.0) <= 0.16


def test_the_disk_keeps_its_energy() -> None:
    """Constant rates mean constant energy; 20000 steps of rounding."""
    assert np.ptp(run("rolling_disk", 0.1, 2000.0).energy) <= 1e-10


@pytest.mark.profile("routes", instead="test_the_midpoint_rule_is_reversible")
@pytest.mark.parametrize("name", ["knife_edge_on_incline", "non_reversible"])
def test_reversible_motions_have_bounded_errors(name: str) -> None:
    """The last tenth of 20000 steps oscillates as much as the first, and about the same mean (5 percent)."""
    parameters = {"asymmetry": 0.0} if name == "non_reversible" else {}
    errors = change(name, 0.1, 2000.0, **parameters)
    first, last = errors[:2000], errors[-2000:]
    assert abs(np.ptp(last) / np.ptp(first) - 1) <= 0.05
    assert abs(last.mean() - first.mean()) <= 0.05 * np.ptp(first)


@pytest.mark.profile("routes", keep=["particle"])
@pytest.mark.parametrize("name", ["particle", "two_wheeled_robot"])
def test_motions_that_become_straight_settle(name: str) -> None:
    """The error tends to a constant: in the last half of the run it varies 1e8 times less than in the first."""
    errors = change(name, 0.1, 2000.0)
    assert np.ptp(errors[10000:]) <= 1e-8 * np.ptp(errors[:10000])


@pytest.mark.profile("routes", instead="test_motions_that_become_straight_settle")
def test_the_knife_edge_stays_on_the_slope() -> None:
    """From rest, x of the discrete motion stays in the strip of the cycloid but for 2 h^2, and y drifts as it does."""
    orbit = run("knife_edge_on_incline", 0.1, 2000.0)
    assert orbit.configuration[:, 0].min() >= -1e-12
    assert orbit.configuration[:, 0].max() <= 0.5 + 0.02
    assert abs(orbit.configuration[-1, 1] / orbit.time[-1] - 0.5) <= 0.01


def slope(h: float, **parameters: float) -> float:
    """Return the mean rate of change of the discrete energy."""
    orbit = run("non_reversible", h, 400.0, **parameters)
    return float(np.polyfit(orbit.time, orbit.energy, 1)[0])


@pytest.mark.profile("routes", instead="test_the_energy_error_is_of_second_order")
def test_without_reversal_the_energy_drifts() -> None:
    """The rate is about -0.015 h^2, and proportional to h^2 within 10 percent; with a reversal it is 100 times less."""
    rates = [slope(h) / h**2 for h in (0.1, 0.05)]
    assert rates[1] < -0.01
    assert abs(rates[0] / rates[1] - 1) <= 0.1
    assert abs(slope(0.1, asymmetry=0.0)) <= 0.01 * abs(slope(0.1))


@pytest.mark.profile("routes", instead="test_the_midpoint_rule_is_reversible")
def test_a_swinging_driver_is_reversible() -> None:
    """The same asymmetry does not spoil the energy while the pendulum only swings."""
    assert abs(slope(0.1, turning=1.0)) <= 0.01 * abs(slope(0.1))


@pytest.mark.profile("problems", instead="test_the_disk_keeps_its_energy")
def test_the_quartic_oscillator_is_chaotic() -> None:
    """A change of 1e-8 grows to the size of the motion within t = 400."""
    example = ready("chaotic_quartic_oscillator")
    moved = example.configuration + 1e-8 * np.eye(7)[0]  # x does not enter the constraint
    orbits = [example.simulate(time_step=0.2, steps=2000, configuration=q) for q in (example.configuration, moved)]
    apart = np.abs(orbits[1].configuration - orbits[0].configuration).max(axis=1)
    assert apart[:100].max() <= 1e-6
    assert apart[1500:].max() >= 0.5


@pytest.mark.profile("problems", instead="test_the_disk_keeps_its_energy")
def test_the_energy_of_the_chaotic_motion_wanders() -> None:
    """Over 16 times the time the mean square of 24 errors grows 3 to 60 times: like t (16), not t^2 (256) nor not."""
    example, h = ready("chaotic_quartic_oscillator"), 0.2
    discrete, normal = nh.discretize(example.system, h), np.array([1.0, 0, 0, 0, *example.configuration[1:4]])
    speed, draws = np.linalg.norm(example.body_velocity), np.random.default_rng(1).normal(size=(24, 7))
    means = []
    for w in draws - np.outer(draws @ normal, normal) / (normal @ normal):
        v = w / np.linalg.norm(w) * speed
        orbit = nh.simulate(discrete, configuration=example.configuration, body_velocity=v, steps=17_000)
        means.append(orbit.energy[:17_000].reshape(17, 1000).mean(axis=1))
    spread = np.mean((np.array(means) - np.array(means)[:, :1]) ** 2, axis=0)
    assert 3 <= spread[16] / spread[1] <= 60
