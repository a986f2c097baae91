"""The bicycle against published numbers: the linear equations of its benchmark, and the nonlinear ones of others."""

import numpy as np
import pytest
from published import C1, EIGENVALUES, K0, K2, SPEEDS, M, growth, linear_equations, spectrum, turning_state

import nonholo as nh


@pytest.mark.profile("routes", instead="test_accelerations_far_from_upright_are_published")
def test_the_linear_equations_are_those_of_the_benchmark() -> None:
    """M from torques, C1, K0 and K2 from derivatives at two speeds: 14 digits of the largest entry of each."""
    for matrix, published in zip(linear_equations(), (M, C1, K0, K2), strict=True):
        assert np.abs(matrix - published).max() <= 1e-14 * np.abs(published).max()


@pytest.mark.profile("routes", instead="test_accelerations_far_from_upright_are_published")
@pytest.mark.parametrize("speed", EIGENVALUES)
def test_eigenvalues_are_those_of_the_table(speed: int) -> None:
    """To the last of its 14 decimals but one."""
    listed = {complex(x) for x in EIGENVALUES[speed]} | {complex(x).conjugate() for x in EIGENVALUES[speed]}
    assert max(min(abs(x - y) for y in spectrum(float(speed))) for x in listed) <= 2e-12


@pytest.mark.profile("routes", instead="test_accelerations_far_from_upright_are_published")
def test_it_rides_upright_between_weave_and_capsize() -> None:
    """The largest real part of an eigenvalue changes sign at the two published speeds."""
    weave, capsize = SPEEDS
    assert growth(weave + 1e-9) < 0.0 < growth(weave - 1e-9)
    assert growth(capsize - 1e-9) < 0.0 < growth(capsize + 1e-9)


def test_accelerations_far_from_upright_are_published() -> None:
    """Of a turning, leaning, steered state: table 1 of Basu-Mandal et al., in its 13 digits, turned into our axes."""
    height, slip, found, published = turning_state()
    assert abs(height) <= 1e-13
    assert slip <= 1e-12
    assert np.abs(found - published).max() <= 2e-12


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

    assert np.abs(nh.critical_values(riding, (3.0, 8.0), samples=5) - SPEEDS).max() < 1e-9
