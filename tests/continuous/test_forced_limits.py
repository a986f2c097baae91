"""Flows under forces end: stiff and jumping forces, overflows, and Ctrl-C."""

import signal
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import nonholo as nh

SLEIGH = nh.ChaplyginSleigh(1.0, 1.0, 0.5, 0.3)
TIMES = np.linspace(0.0, 3.0, 7)


def _switch(*state: Any) -> np.ndarray:
    return np.array([np.sign(np.sin(1e3 * state[0])), 0.0, 0.0])


def _drag(*state: Any) -> np.ndarray:
    return -1e8 * state[2]


def _flow(potential: Any, force: Any, times: Any = TIMES) -> nh.Orbit:
    return nh.flow(nh.Forced(SLEIGH, potential, force), times=times, restricted_velocity=(0.3, -0.7))


ENDLESS: dict[str, tuple[Any, Any, str, str]] = {
    "drag": (None, _drag, "too_stiff", "_drag"),
    "switch": (None, _switch, "too_stiff", "_switch"),
    "weight": (nh.Gravity([1e149, 0.0], [0.1, 0.2]), None, "too_stiff", "Gravity"),
    "at once": (None, lambda *_: np.array([1e200, 0.0, 0.0]), "nonfinite", "<lambda>"),
}


@pytest.mark.profile("problems", keep=["weight", "at once"])
@pytest.mark.parametrize("name", ENDLESS)
def test_flows_without_end_are_given_up(name: str) -> None:
    """After some thousand steps at most, with the orbit so far, the force by name and what to try."""
    potential, force, outcome, acting = ENDLESS[name]
    with pytest.raises(nh.OutcomeError, match=rf"under `{acting}` .*: {outcome}\. .*Try ") as ended:
        _flow(potential, force)
    assert (str(ended.value.outcome), len(ended.value.orbit)) == (outcome, 1)


def test_stiff_flows_that_come_to_an_end_are_solved() -> None:
    """A moderate friction takes steps that stability alone keeps short: v' = -c v / m along the blade, exactly."""
    orbit = nh.flow(
        nh.Forced(nh.ChaplyginSleigh(1.0, 1.0, 0.0), None, nh.Friction([0.0, 200.0, 0.0])),
        times=(0.0, 0.1, 0.5),
        body_velocity=(0.0, 1.0, 0.0),
    )
    assert orbit.outcome == nh.Outcome.successful
    assert np.abs(orbit.body_velocity[:, 1] - np.exp(-200 * orbit.time)).max() < 1e-12


def test_ctrl_c_ends_a_flow_under_forces() -> None:
    """Python is asked at every step, so that it comes within a second."""

    def slow(*state: Any) -> np.ndarray:
        return np.array([np.sin(50 * state[0]), 0.0, 0.0])

    def stop(*_: Any) -> None:
        raise KeyboardInterrupt

    before: Callable[..., Any] | int | None = signal.signal(signal.SIGALRM, stop)
    signal.setitimer(signal.ITIMER_REAL, 0.1)
    begun = time.process_time()
    try:
        with pytest.raises(KeyboardInterrupt):
            _flow(None, slow, (0.0, 1e4))
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
    assert time.process_time() - begun < 1.1
