"""The bicycle against published numbers: the linear equations of its benchmark, and the nonlinear ones of others."""

import numpy as np
import pytest
from published import C1, EIGENVALUES, K0, K2, SPEEDS, M, growth, linear_equations, spectrum, turning_state

import nonholo as nh


def test_the_linear_equations_are_those_of_the_benchmark() -> None:
    """M from torques, C1, K0 and K2 from derivatives at two speeds: 14 digits of the largest entry of each."""
    for matrix, published in zip(linear_equations(), (M, C1, K0, K2), strict=True):
        assert np.abs(matrix - published).max() <= 1e-14 * np.abs(published).max()


@pytest.mark.parametrize("speed", EIGENVALUES)
def test_eigenvalues_are_those_of_the_table(speed: int) -> None:
    """To the last of its 14 decimals but one."""
    listed = {complex(x) for x in EIGENVALUES[speed]} | {complex(x).conjugate() for x in EIGENVALUES[speed]}
    assert max(min(abs(x - y) for y in spectrum(float(speed))) for x in listed) <= 2e-12


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
def test_the_map_keeps_the_contact_and_rides_as_the_flow() -> None:
    """The front wheel stays on the ground to rounding, where the midpoint rule alone would lift it; order two."""
    ready = nh.examples.bicycle()
    exact = ready.flow(times=(0.0, 1.0), rtol=1e-13, atol=1e-14)
    height = ready.conserved["height of the front contact"]
    errors = []
    for steps in (100, 200):
        orbit = ready.simulate(steps=steps, time_step=1.0 / steps)
        assert np.abs(height(orbit.configuration, orbit.body_velocity)).max() <= 1e-14
        errors.append(np.abs(orbit.configuration[-1] - exact.configuration[-1]).max())
    assert abs(np.log2(errors[0] / errors[1]) - 2.0) <= 0.1
    energy = ready.conserved["energy"](exact.configuration, exact.body_velocity)
    assert np.ptp(energy) <= 1e-11 * energy[0]
