"""Events of the continuous motion, against its closed forms."""

import numpy as np
import pytest

import nonholo as nh

SLEIGH = nh.ChaplyginSleigh(1.0, 0.75, 0.5)  # rho^2 = a^2 + J/m = 1
VELOCITY = (0.3, -1.0, 0.0)
# v_1 = E tanh(s_0 + a E t / rho), with E = hypot(rho omega, v_1) and sinh s_0 = v_1/(rho omega).
CUSP = -np.arcsinh(VELOCITY[1] / VELOCITY[0]) / (0.5 * np.hypot(*VELOCITY[:2]))
TIMES = np.linspace(0.0, 10.0, 21)


@pytest.mark.parametrize("method", ["closed_form", None])
def test_cusp_of_the_sleigh_is_where_the_closed_form_says(method: str | None) -> None:
    """A backward sleigh turns round once, at the time where tanh is zero; numerically as exact as the tolerances."""
    flow = {"body_velocity": VELOCITY, "times": TIMES, "method": method, "rtol": 1e-13, "atol": 1e-14}
    found = nh.flow(SLEIGH, **flow, events=[nh.cusp]).events["cusp"]
    assert len(found) == 1
    assert found.step.tolist() == [int(np.searchsorted(TIMES, CUSP)) - 1]
    assert abs(found.time[0] - CUSP) < 4e-15 if method else abs(found.time[0] - CUSP) < 1e-12
    assert abs(found.states.body_velocity[0, 1]) < 1e-15


def test_events_leave_the_flow_alone() -> None:
    """With and without events the states are the same to the last bit; a stopping event cuts them."""
    plain = nh.flow(SLEIGH, body_velocity=VELOCITY, times=TIMES)
    stopped = nh.flow(
        SLEIGH, body_velocity=VELOCITY, times=TIMES, events=[nh.Event(lambda o: o.time - 3.2, stop=True, name="t")]
    )
    assert stopped.events.stopped_by == "t"
    assert len(stopped) == 7
    assert np.array_equal(stopped.pose, plain.pose[:7])
    assert np.array_equal(stopped.heading, plain.heading[:7])


@pytest.mark.parametrize("method", ["closed_form", None])
def test_full_turns_between_two_times_are_known(method: str | None) -> None:
    """A heading of three turns is crossed within one interval of four turns, where the closed form has it."""
    spin = nh.ChaplyginSleigh(1.0, 0.75, 0.0)
    flow = {"body_velocity": (1.0, 0.5, 0.0), "times": (0.0, 4.0, 4.0 + 8 * np.pi), "method": method, "rtol": 1e-13}
    found = nh.flow(spin, **flow, events=[lambda orbit: orbit.heading - 6 * np.pi]).events[0]
    assert found.step.tolist() == [1]
    assert abs(found.time[0] - 6 * np.pi) < 1e-11  # some 100 solver steps of relative error 1e-13


def test_backward_flow() -> None:
    """Run backwards from after the cusp the flow finds it again, in the other direction."""
    after = nh.flow(SLEIGH, body_velocity=VELOCITY, times=(0.0, 10.0), method="closed_form")
    found = nh.flow(
        SLEIGH, body_velocity=after.body_velocity[1], times=TIMES[::-1], method="closed_form", events=[nh.cusp]
    ).events["cusp"]
    assert found.direction.tolist() == [-1]
    assert abs(found.time[0] - CUSP) < 1e-14 * 10 * np.exp(5)  # errors of the state grow backwards as e^(aEt)


def test_section_of_a_top() -> None:
    """The crossings of a numerical flow of a top lie in the section."""
    top = nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]])
    section = nh.Event(lambda orbit: orbit.configuration[:, 0, 0])
    orbit = nh.flow(top, body_velocity=(0.4, 0.9, 0.0), times=np.linspace(0, 12, 25), events=[section])
    assert len(orbit.events[0]) >= 2
    assert np.abs(orbit.events[0].states.configuration[:, 0, 0]).max() < 1e-14


def test_functions_without_a_value_are_refused() -> None:
    """A function that does not give a number at the first state is refused before the flow is solved."""
    with pytest.raises(ValueError, match=r"displacement.*needs a discrete orbit"):
        nh.flow(SLEIGH, body_velocity=VELOCITY, times=TIMES, events=[lambda orbit: orbit.displacement[:, 0, 0]])


def test_a_flow_that_stops_in_time_does_not_fail() -> None:
    """An event before the time at which the solver gives up ends the orbit successfully."""
    top = nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]])
    flow = {"restricted_velocity": (1e140, 2e140), "rtol": 1e-14, "atol": 1e-300}
    times = (0.0, 1e-141, 2e-141, 1.0)
    with pytest.raises(nh.OutcomeError, match="not_converged") as caught:
        nh.flow(top, **flow, times=times, events=[lambda orbit: orbit.time - 5e-142])
    assert len(caught.value.orbit.events[0]) == 1
    orbit = nh.flow(top, **flow, times=times, events=[nh.Event(lambda orbit: orbit.time - 1.5e-141, stop=True)])
    assert (orbit.outcome, len(orbit)) == (nh.Outcome.successful, 2)


def test_events_between_requested_times_are_seen() -> None:
    """Every step of the series is looked at: a sine of time, between two times and between many."""
    top = nh.SuslovTop.from_inertia(np.diag([3.0, 2.0, 2.5]), axis=(0, 0, 1))
    for times in ((0.0, 100.0), np.linspace(0.0, 100.0, 300)):
        orbit = nh.flow(top, restricted_velocity=(0.4, 0.9), times=times, events=[lambda orbit: np.sin(orbit.time)])
        found = orbit.events[0]
        assert np.abs(found.time - np.pi * np.arange(1, 32)).max() <= 1e-13
        begin, gap = orbit.time[found.step], orbit.time[found.step + 1] - orbit.time[found.step]
        assert np.abs(begin + found.fraction * gap - found.time).max() <= 1e-13
    fifth = nh.Event(lambda orbit: np.sin(orbit.time), stop=5)
    orbit = nh.flow(top, restricted_velocity=(0.4, 0.9), times=(0.0, 1.0, 15.0, 16.0, 17.0), events=[fifth])
    assert orbit.time.tolist() == [0.0, 1.0, 15.0]
    assert orbit.events[0].step.tolist() == [1, 1, 1, 1, 2]
