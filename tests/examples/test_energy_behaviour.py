"""Energy -dL_d/dh of the discrete motions: bounded, settling, wandering or drifting, always of size h^2."""

import functools

import numpy as np
import pytest

import nonholo as nh
from nonholo.examples import Example
from nonholo.lagrange_dalembert import CoordinateOrbit

X = nh.examples


@functools.cache
def ready(name: str, **parameters: float) -> Example:
    """Return an example."""
    return getattr(X, name)(**parameters)


@functools.cache
def run(name: str, h: float, duration: float, **parameters: float) -> CoordinateOrbit:
    """Return the discrete orbit of an example."""
    return ready(name, **parameters).simulate(time_step=h, steps=round(duration / h))


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
