"""The door to functions of users: nothing of theirs changes a motion or becomes a number that it is not."""

from collections.abc import Callable
from typing import Any

import numba
import numpy as np
import pytest
from refusals import refusals

import nonholo as nh

SLEIGH = nh.ChaplyginSleigh(1.0, 1.0, 0.5, 0.3)
DISCRETE = nh.discretize(SLEIGH, 0.1)
TIMES = np.linspace(0.0, 3.0, 7)
START: dict[str, Any] = {"restricted_velocity": (0.3, -0.7)}


def velocity_set(time: float, g: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Write to the velocity."""
    v[:] = 5 + 0 * time * g[0, 0]
    return np.zeros(3)


def pose_set(time: float, g: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Write to the pose."""
    g[:] = 0 * time * v[0]
    return np.zeros(3)


def damped(time: float, g: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Write to the velocity by accident."""
    v *= 0.5
    return 0 * time * g[0]


def pose_cut(g: np.ndarray) -> float:
    """Write to the pose, in a potential."""
    g[0, 2] = 0.0
    return 0.0


def _flow(potential: Any, force: Any) -> Any:
    return nh.flow(nh.Forced(SLEIGH, potential, force), times=TIMES, **START)


def _run(potential: Any, force: Any) -> Any:
    return nh.simulate(nh.discretize(nh.Forced(SLEIGH, potential, force), 0.1), **START, steps=5)


def _rate(potential: Any, force: Any) -> Any:
    field = nh.vector_field(nh.Forced(SLEIGH, potential, force))
    return field(0.0, np.concatenate([START["restricted_velocity"], np.eye(3).ravel()]))


def _work(potential: Any, force: Any) -> Any:
    system = nh.Forced(SLEIGH, potential, force)
    return system.applied_force(0.0, np.eye(3), np.ones(3)), system.potential_energy(np.eye(3)[None])


USES = {"flow": _flow, "simulate": _run, "vector_field": _rate, "by itself": _work}


@pytest.mark.parametrize("use", USES)
@pytest.mark.parametrize("function", [velocity_set, pose_set, damped, pose_cut])
def test_functions_that_write_to_what_they_get_are_named(function: Callable[..., Any], use: str) -> None:
    """They get copies that cannot be written: a motion is never changed by them, and the error says which one it is."""
    arguments = (function, None) if function is pose_cut else (None, function)
    where = "potential" if function is pose_cut else "force"
    named = rf"`Forced\({where}=...\)` must not write to its arguments. Got `{function.__name__}`"
    with pytest.raises(ValueError, match=named):
        USES[use](*arguments)


def test_compiled_functions_that_write_are_found_before_a_run() -> None:
    """Numba does not see arrays that are read-only as such: what they were is compared with what they are."""
    halved = numba.njit(damped)
    with pytest.raises(ValueError, match=r"must not write to its arguments. Got `damped`"):
        _run(None, halved)


def _late(*state: Any) -> np.ndarray:
    return np.array([np.nan if state[0] > 0.25 else 0.0, 0.0, 0.0])


def _well(g: np.ndarray) -> float:
    return np.nan * g[0, 0]


@pytest.mark.parametrize(
    ("use", "potential", "force", "message", "states"),
    [
        (_run, None, _late, r"\[nan, 0.0, 0.0\] from `_late` at time 0.3", 3),
        (_flow, None, _late, r"\[nan, 0.0, 0.0\] from `_late` at time 0.2", 1),
        (_run, _well, None, r"`Forced\(potential=...\)` must be finite. Got nan from `_well`", 0),
    ],
    ids=["force in a run", "force in a flow", "potential in a run"],
)
def test_what_is_not_finite_is_named_with_its_time(
    use: Any, potential: Any, force: Any, message: str, states: int
) -> None:
    """A run ends at the first node after, a flow as near as its steps are short; the states before are kept."""
    with pytest.raises(nh.OutcomeError, match=message) as ended:
        use(potential, force)
    assert ended.value.outcome == nh.Outcome.nonfinite
    assert len(ended.value.orbit) == states


NOT_NUMBERS: dict[str, Any] = {
    "complex": np.zeros(3) * 1j,
    "text": "abc",
    "texts": ("1", "2", "3"),
    "generator": (x for x in range(3)),
    "truths": (True, False, True),
    "masked": np.ma.masked_array(np.zeros(3), [1, 0, 0]),
    "nothing": None,
}


@pytest.mark.parametrize("kind", NOT_NUMBERS)
def test_forces_that_are_no_real_numbers_are_refused(kind: str) -> None:
    """Whatever NumPy would turn into numbers, or half of them, is a TypeError that names the function."""

    def push(*_: Any) -> Any:
        return NOT_NUMBERS[kind]

    report = r"(?s)`Forced\(force=...\)` must return 3 real numbers. Got .* from `push`"
    for use in (_run, _flow):
        with pytest.raises(TypeError, match=report):
            use(None, push)


@pytest.mark.parametrize("value", [1j, "1.0", True])
def test_potentials_that_are_no_real_number_are_refused(value: Any) -> None:
    """The same of a potential."""
    with pytest.raises(TypeError, match=r"must return one real number. Got .* from `<lambda>`"):
        _run(lambda _: value, None)


def _reset(states: Any) -> np.ndarray:
    states.reduced_momentum[:] = 0
    return states.time + 1


# Events see the states of a run through views that are read-only; what a reduction writes the next one would see.
test_events_and_reductions_cannot_change_states = refusals(
    (lambda: nh.simulate(DISCRETE, **START, steps=5, events=[_reset]), "must not write to its arguments. Got `_reset`"),
    (
        lambda: nh.ensemble(DISCRETE, restricted_velocity=np.ones((2, 2)), steps=2, reduce=_reset),
        r"`ensemble\(reduce=...\)` must not write to its arguments",
    ),
)


def test_an_orbit_that_is_not_finite_is_not_successful() -> None:
    """Whatever made it: momenta whose square overflows."""
    g = nh.SE(2).exp(np.linspace(0, 1, 5)[:, None] * [1.0, 1.0, 0.0])
    assert nh.Orbit.from_poses(SLEIGH, np.arange(5) * 1e-300, g).outcome == nh.Outcome.nonfinite


@pytest.mark.parametrize("number", [np.nan, -np.inf, 1e151])
@pytest.mark.parametrize(("steps", "place"), [(5, 3), (9000, 0), (9000, 4096), (9000, 9000)])
def test_one_number_that_is_not_finite_is_seen(number: float, steps: int, place: int) -> None:
    """In few numbers, and in each piece of many."""
    orbit = nh.simulate(DISCRETE, **START, steps=steps)
    momenta = orbit.reduced_momentum.copy()
    rows = {"time": orbit.time, "cayley": orbit.cayley, "canonical_pose": orbit.canonical_pose}
    assert orbit.motion.orbit(**rows, reduced_momentum=momenta).outcome == nh.Outcome.successful
    momenta[place, 1] = number
    assert orbit.motion.orbit(**rows, reduced_momentum=momenta).outcome == nh.Outcome.nonfinite


# Functions with other arguments are refused where they are passed, with their own.
test_functions_take_what_they_are_called_with = refusals(
    (lambda: nh.Forced(SLEIGH, force=pose_cut), r"take \(time, configuration, body_velocity\). Got `pose_cut\(g: "),
    (lambda: nh.Forced(SLEIGH, velocity_set), r"take \(configuration\)"),
    (lambda: nh.Event(velocity_set), r"take \(orbit\)"),
    (lambda: nh.fit(velocity_set, {}, {"a": 1.0}), r"take \(parameters\)"),
    (lambda: nh.critical_values(velocity_set, (0.0, 1.0)), r"take \(value\)"),
)
