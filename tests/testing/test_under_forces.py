"""The checks of systems with forces and of their discretizations: ours pass, errors in the forces are named."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import nonholo as nh
from nonholo.testing import Report, check_discretization, check_system

SLEIGH = nh.ChaplyginSleigh(1.0, 1.0, 0.5, 0.3)
VESELOVA = nh.VeselovaTop(np.diag([1.0, 2.0, 3.0]))
SLOPE = nh.Gravity(force=[0.4, -1.0], point=[0.5, 0.3])
RUB = nh.Friction([0.1, 0.2, 0.3])


def _spring(g: np.ndarray) -> float:
    return float(0.5 * np.sum((g[:2] - 0.3) ** 2))


def _drive(time: float, g: np.ndarray, w: np.ndarray) -> np.ndarray:
    return np.cos(3 * time + np.arange(3)) - 0.4 * w * np.roll(w, 1) + 0.3 * g[0, 1]


def _even(_time: float, _g: np.ndarray, w: np.ndarray) -> np.ndarray:
    return np.array([w[0] ** 2, 0.3, 0.1])


CASES = {
    "nothing": (nh.Forced(SLEIGH), "ok"),
    "weight with friction": (nh.Forced(SLEIGH, SLOPE, RUB), "reported"),
    "friction": (nh.Forced(SLEIGH, force=RUB), "reported"),
    "potential": (nh.Forced(SLEIGH, _spring), "ok"),
    "function": (nh.Forced(SLEIGH, _spring, _drive), "reported"),
    "even force": (nh.Forced(SLEIGH, force=_even), "ok"),
    "table": (nh.Forced(SLEIGH, force=np.cos(np.arange(90.0)).reshape(30, 3)), "reported"),
    "friction and table": (nh.Forced(SLEIGH, force=(RUB, np.cos(np.arange(90.0)).reshape(30, 3))), "reported"),
    "all three": (nh.Forced(SLEIGH, SLOPE, (_drive, RUB, np.cos(np.arange(90.0)).reshape(30, 3))), "reported"),
    "veselova": (nh.Forced(VESELOVA, force=_drive), "reported"),
}


@pytest.mark.profile("routes", keep=["0.1-weight*", "0.1-even*"])
@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("time_step", [0.1, 0.01])
def test_forced_systems_pass(name: str, time_step: float) -> None:
    """Systems and maps pass; reversal is judged where forces allow it, and seen to fail where they do not."""
    forced, reversal = CASES[name]
    assert check_system(forced).passed
    report = check_discretization(nh.discretize(forced, time_step))
    assert report.passed
    assert report["reversal"].status == reversal
    assert (report["reversal"].value < 1e-11) == (reversal == "ok")
    assert report["no forces"].status == report["order of the balance"].status == "ok"
    assert (report["friction"].status == "ok") == (name == "friction")


def _names(report: Report) -> set[str]:
    return {result.name for result in report.failed}


def _scaled(factor: float, original: Callable[..., Any]) -> Callable[..., Any]:
    return lambda *given: factor * original(*given)


@pytest.mark.parametrize(
    ("kind", "name", "factor", "expected"),
    [
        (nh.Forced, "potential_force", -1.0, {"potential force", "energy conserved"}),
        (nh.Friction, "covector", -1.0, {"friction"}),
    ],
)
def test_errors_in_systems(
    monkeypatch: pytest.MonkeyPatch, kind: Any, name: str, factor: float, expected: set[str]
) -> None:
    """A potential force of the wrong sign, and friction that drives, are named."""
    monkeypatch.setattr(kind, name, _scaled(factor, getattr(kind, name)))
    assert _names(check_system(nh.Forced(SLEIGH, SLOPE, RUB), throw=False)) == expected


@pytest.mark.profile("routes", keep=["work*"])
@pytest.mark.parametrize(
    ("name", "factor", "expected"),
    [
        ("impulses", 1.1, {"start", "momentum equation", "order of momenta", "order of poses", "order of the balance"}),
        ("work", -1.0, {"order of the balance"}),
        ("propagator", 0.9, {"start", "momentum equation"}),
    ],
)
def test_errors_in_maps(monkeypatch: pytest.MonkeyPatch, name: str, factor: float, expected: set[str]) -> None:
    """Impulses that are too large, work of the wrong sign, friction that forgets: each fails the checks of its own."""
    force = RUB if name == "propagator" else _even
    discrete = nh.discretize(nh.Forced(VESELOVA, force=force), 0.1)  # whose steps call the functions in Python
    monkeypatch.setattr(nh.Forced, name, _scaled(factor, getattr(nh.Forced, name)))
    assert _names(check_discretization(discrete, throw=False, definition=False)) >= expected
