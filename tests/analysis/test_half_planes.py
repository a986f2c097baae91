"""Sides of the line of equilibria, the theorem on discrete orbits of the top, and why the map is that of no flow."""

from typing import Any

import mpmath
import numpy as np
import pytest
from analysis.equations import sleigh_step
from bodies import ATTRACTING
from refusals import refusals
from scipy.spatial.transform import Rotation

import nonholo as nh
from nonholo.analysis._asymptotics import _phases

SYSTEMS = {name: ATTRACTING[name] for name in ("top 3", "top 3, tilted", "sleigh 2", "sleigh 2, backward")}
STEP = 0.25
TOP = nh.discretize(SYSTEMS["top 3"], STEP)


def _paper(top: nh.SuslovTop, displacement: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return s and Q in the paper's letters, q from the quaternion of the displacement."""
    J, (x, y, _, _) = top.mass_tensor, Rotation.from_matrix(displacement).as_quat(canonical=True).T
    s = J[0, 2] * x + J[1, 2] * y
    Q = (J[0, 1] * J[0, 2] + J[1, 1] * J[1, 2] + J[1, 2] * J[2, 2]) * x
    return s, Q - (J[0, 0] * J[0, 2] + J[0, 1] * J[1, 2] + J[0, 2] * J[2, 2]) * y


def _combinations(top: nh.SuslovTop, momentum: np.ndarray) -> np.ndarray:
    """Return the paper's two combinations of half the scaled momentum."""
    J, (M1, M2, _) = top.mass_tensor, np.moveaxis(STEP * momentum / 2, -1, 0)
    first = (J[0, 2] * (J[0, 0] + J[2, 2]) + J[0, 1] * J[1, 2]) * M1
    first = first + (J[1, 2] * (J[1, 1] + J[2, 2]) + J[0, 1] * J[0, 2]) * M2
    return np.array([first, J[1, 2] * M1 - J[0, 2] * M2])


def _orbits(discrete: nh.Discretization, shares: np.ndarray) -> list[nh.Orbit]:
    """Run orbits whose energies are shares of the saddle's, or of the bound of the single-valued region."""
    system, rng, result = discrete.system, np.random.default_rng(0), []
    is_top = isinstance(system, nh.SuslovTop)
    bound = nh.critical_energies(discrete).saddle if is_top else nh.single_valued_region(discrete).energy
    for share in shares:
        r = rng.normal(size=2)
        r *= np.sqrt(share * bound / system.constrained_energy(r))
        result.append(nh.simulate(discrete, momentum=r, steps=60, reconstruct=False))
    return result


def test_they_are_the_letters_of_the_paper() -> None:
    """For the axis e3 `side` and `forward` of displacements are s and Q, of momenta twice its two combinations."""
    top, discrete = TOP.system, TOP
    for orbit in _orbits(discrete, np.array([0.1, 0.9])):
        s, Q = _paper(top, orbit.displacement)
        result = nh.half_planes(discrete, displacement=orbit.displacement)
        assert np.abs(result.side - s).max() <= 1e-14
        assert np.abs(result.forward - Q).max() <= 1e-14
        combined = np.array(nh.half_planes(discrete, momentum=orbit.momentum)) / 2
        assert np.abs(combined - _combinations(top, orbit.momentum)).max() <= 1e-14


@pytest.mark.parametrize("name", SYSTEMS)
def test_attracting_equilibria_are_forward(name: str) -> None:
    """False in the paper: the stable half-line is in Theta_-. It is in Theta_+, on no side, for momenta too."""
    discrete = nh.discretize(SYSTEMS[name], STEP)
    spectrum = nh.equilibria(discrete, 0.3)
    assert abs(spectrum.multipliers[0]) < 1
    start = nh.simulate(discrete, body_velocity=spectrum.velocity, steps=1)
    for result in (
        nh.half_planes(discrete, displacement=start.displacement),
        nh.half_planes(discrete, momentum=start.momentum),
        nh.half_planes(discrete, momentum=start.restricted_momentum),
    ):
        assert np.all(result.forward > 0)
        assert np.abs(result.side).max() <= 1e-15
    reverse = nh.half_planes(discrete, displacement=np.linalg.inv(start.displacement))
    assert np.all(reverse.forward < 0)


@pytest.mark.parametrize("name", SYSTEMS)
def test_orbits_stay_on_their_side(name: str) -> None:
    """Up to 98 % of the bound every orbit keeps the signs of both sides, and moves forward at every step."""
    discrete = nh.discretize(SYSTEMS[name], STEP)
    for orbit in _orbits(discrete, np.linspace(0.02, 0.98, 25)):
        moving = np.abs(nh.half_planes(discrete, momentum=orbit.momentum).side) > 1e-6  # growth is of order 1e-12
        momentum = nh.half_planes(discrete, momentum=orbit.momentum[moving])
        displacement = nh.half_planes(discrete, displacement=orbit.displacement[moving])
        assert np.all(np.sign(momentum.side) == np.sign(momentum.side[0]))
        assert np.all(np.sign(displacement.side) == np.sign(momentum.side[0]))
        assert np.all(np.diff(momentum.forward) > 0)


def test_a_balanced_body_has_no_sides() -> None:
    """All numbers are zero for a balanced top."""
    discrete = nh.discretize(nh.SuslovTop(np.diag([1.0, 2.0, 3.0])), STEP)
    result = nh.half_planes(discrete, momentum=np.ones((4, 3)))
    assert not np.any(result)
    assert result.side.shape == (4,)


# Other systems and maps, none or two arguments, and wrong shapes are named.
test_wrong_arguments_are_refused = refusals(
    (nh.discretize(nh.SuslovTop(np.eye(4)), 0.1), {"momentum": np.ones(6)}, "top with n = 3 or of a sleigh"),
    (nh.discretize(SYSTEMS["top 3"], 0.1, difference="logarithmic"), {"momentum": np.ones(3)}, "keep energy"),
    (TOP, {}, "be given displacement or momentum. Got none"),
    (TOP, {"momentum": np.ones(3), "displacement": np.eye(3)}, "be given displacement or momentum. Got both"),
    (TOP, {"momentum": np.ones(4)}, "end in shape"),
    (TOP, {"displacement": np.eye(2)}, "end in shape"),
    ask=lambda discrete, options: nh.half_planes(discrete, **options),
)


CASES = {"heavy": (0.2, 1.0, 2.25), "light": (1.0, 0.3, (1.9 * 0.3) ** 2)}  # J, m a^2, level g at m = h = 1


def _sleigh(J: float, M: float, g: float) -> tuple[nh.Discretization, float]:
    return nh.discretize(nh.ChaplyginSleigh(1.0, J, np.sqrt(M)), 1.0), g / (2 * M)


def _following(J: Any, a: Any, r: Any) -> tuple:
    """Return the momenta (pi, p_1) after a step, m = h = 1."""
    return sleigh_step(1, J, a, r)[1]


def _difference(inertia: float, moment: float, r: Any) -> Any:
    """Return s_+ - s_- from the logarithms of far momenta, backwards through T^-1(r) = -T(-r)."""
    J, a = mpmath.mpf(inertia), mpmath.sqrt(mpmath.mpf(moment))
    now = tuple(map(mpmath.mpf, r))
    whole = J + a * a
    speed = mpmath.sqrt(now[0] ** 2 / whole + now[1] ** 2)
    rate = mpmath.log((2 * whole - a * speed) / (2 * whole + a * speed))
    ends = []
    for sign in (1, -1):
        ahead, steps = (sign * now[0], sign * now[1]), 0
        while abs(ahead[0]) > mpmath.mpf(10) ** -25:  # what is left out is of the order of the square
            ahead, steps = _following(J, a, ahead), steps + 1
        ends.append(mpmath.log(abs(ahead[0])) / rate - steps)
    return ends[0] + ends[1]


@pytest.mark.parametrize("name", CASES)
def test_difference_against_fifty_digits(name: str) -> None:
    """s_+ - s_- of two orbits of the sleigh, to 1e-12; they differ by more than a tenth of the amplitude."""
    J, M, g = CASES[name]
    discrete, energy = _sleigh(J, M, g)
    mu = nh.flow_obstruction(discrete, energy, samples=2).multiplier
    result, exact = [], []
    with mpmath.workdps(50):
        for angle in (0.1, 0.4):
            r = np.sqrt(2 * energy) * np.array([np.sqrt(J + M) * np.cos(angle), np.sin(angle)])
            before, after = _phases(discrete, mu, r)
            result.append(after - before)
            exact.append(float(_difference(J, M, r)))
    assert np.abs(np.subtract(result, exact)).max() <= 1e-12
    assert abs(result[0] - result[1]) > 0.1 * nh.flow_obstruction(discrete, energy).amplitude


@pytest.mark.parametrize(("name", "amplitude"), [("heavy", 4.46e-3), ("light", 2.70e-4)])
def test_the_map_of_the_sleigh_is_not_that_of_a_flow(name: str, amplitude: float) -> None:
    """False in the paper's conclusions: explicit solutions. The difference would be constant for a smooth flow."""
    discrete, energy = _sleigh(*CASES[name])
    assert energy < nh.single_valued_region(discrete).energy
    assert nh.flow_obstruction(discrete, energy, samples=64).amplitude == pytest.approx(amplitude, rel=5e-3)


def test_the_map_of_the_top_is_not_that_of_a_flow() -> None:
    """Nor is that of a regular top, below its saddle."""
    discrete = nh.discretize(nh.SuslovTop([[1.0, 0.0, 0.6], [0.0, 0.5, 0.0], [0.6, 0.0, 0.6]]), 1.0)
    result = nh.critical_energies(discrete)
    assert result.regular
    assert nh.flow_obstruction(discrete, 0.95 * result.saddle).amplitude > 2e-3


def test_it_is_beyond_all_orders() -> None:
    """With the time step the amplitude falls as its 28th and then its 34th power; at h = 0.4 rounding is left."""
    steps, amplitudes = [1.0, 0.8, 0.6, 0.4], []
    for h in steps:
        discrete = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, np.sqrt(0.3)), h)
        amplitudes.append(nh.flow_obstruction(discrete, CASES["light"][2] / 0.6).amplitude)
    slopes = np.diff(np.log(amplitudes)) / np.diff(np.log(steps))
    assert slopes[0] > 25
    assert slopes[1] > slopes[0] + 5
    assert amplitudes[-1] <= 1e-12


def _spread(h: float) -> Any:
    """Return how far s_+ - s_- varies over eight starts within a step of the light sleigh, time step h; 60 digits."""
    J, M, g = CASES["light"]
    speed, inertia = mpmath.sqrt(g / mpmath.mpf(M)) * h, mpmath.mpf(J) + mpmath.mpf(M)
    a = mpmath.sqrt(mpmath.mpf(M))

    def along(t: mpmath.mpf) -> tuple:
        return mpmath.sqrt(inertia) * speed * mpmath.sech(t), speed * mpmath.tanh(t)

    first = mpmath.mpf("0.1")
    pi, p = _following(mpmath.mpf(J), a, along(first))
    period = mpmath.asinh(p * mpmath.sqrt(inertia) / pi) - first
    result = [_difference(J, M, along(first + period * k / 8)) for k in range(8)]
    return max(result) - min(result)


@pytest.mark.profile("problems", instead="test_difference_against_fifty_digits")
@pytest.mark.parametrize(("h", "shorter"), [(0.6, 0.5), (0.5, 0.4), (0.4, 0.3)])
def test_it_falls_as_an_exponential_of_the_inverse_step(h: float, shorter: float) -> None:
    """Its logarithm falls as -pi^2/(nu h), up to five parts in a hundred that become less with h."""
    rate = np.sqrt(CASES["light"][2]) / 1.3  # nu = M u/(a I) with a u = sqrt(g), m = 1
    with mpmath.workdps(60):
        fall = float(mpmath.log(_spread(h) / _spread(shorter)))
    ratio = fall / (np.pi**2 / rate * (1 / shorter - 1 / h))
    assert 1 < ratio < 1 + 0.13 * h * h


@pytest.mark.parametrize("angle", [-0.9, 0.2, 1.1])
def test_time_that_a_step_takes(angle: float) -> None:
    """A step takes h (1 + (h^2/12)(nu^2 + 3 (J/I) omega^2)) of the flow's time, to six digits of the second term."""
    with mpmath.workdps(40):
        J, a, h = mpmath.mpf(1), mpmath.sqrt(mpmath.mpf("0.3")), mpmath.mpf("1e-3")
        inertia, speed = J + a * a, mpmath.mpf("1.1")
        rate = a * speed / inertia
        before = mpmath.sqrt(inertia) * speed * mpmath.cos(angle), speed * mpmath.sin(angle)
        after = tuple(x / h for x in _following(J, a, (h * before[0], h * before[1])))
        first, last = (mpmath.asinh(mpmath.sqrt(inertia) * p / pi) / rate for pi, p in (before, after))
        turning = (before[0] + after[0]) / 2 / inertia
        expected = (rate**2 + 3 * J / inertia * turning**2) / 12
        assert abs((last - first - h) / h**3 / expected - 1) <= 1e-6


@pytest.mark.parametrize("name", CASES)
def test_it_is_a_function_of_the_phase(name: str) -> None:
    """One step on, both coordinates have grown by 1; the difference is the same."""
    discrete, energy = _sleigh(*CASES[name])
    orbit = nh.heteroclinic(discrete, energy=energy, side=-1).orbit
    now = int(np.flatnonzero(orbit.time == 0)[0])
    mu = nh.flow_obstruction(discrete, energy, samples=2).multiplier
    here, later = (np.array(_phases(discrete, mu, orbit.restricted_momentum[now + k])) for k in (0, 3))
    assert np.abs(later - here - 3).max() <= 1e-11


def test_both_sides_of_the_sleigh_are_mirror_images() -> None:
    """The offset b and the sign of omega do not matter: only m, J, a, h and the energy do."""
    plain = nh.flow_obstruction(nh.discretize(nh.ChaplyginSleigh(1.0, 0.2, 1.0), 1.0), 1.125)
    for sleigh in (nh.ChaplyginSleigh(1.0, 0.2, 1.0, 0.7), nh.ChaplyginSleigh(1.0, 0.2, -1.0)):
        other = nh.flow_obstruction(nh.discretize(sleigh, 1.0), 1.125)
        assert np.abs(other.difference - plain.difference).max() <= 1e-12
        assert np.abs(other.phase - plain.phase).max() <= 1e-12


# Balanced bodies, orbits that change sides and other systems.
test_levels_without_it_are_refused = refusals(
    (nh.ChaplyginSleigh(1.0, 1.0, 0.0), 0.1, 1.0, "have attracting equilibria"),
    (nh.ChaplyginSleigh(1.0, 0.1, 0.4), 1.0, 2.0, "keep orbits on their side"),
    (nh.SuslovTop(np.eye(4)), 0.1, 1.0, "top with n = 3 or of a sleigh"),
    ask=lambda system, h, energy: nh.flow_obstruction(nh.discretize(system, h), energy),
)
