"""Questions to bodies on groups, and to fits and controls, in any unit of mass, length and time: the same answers."""

import dataclasses
import functools
from collections.abc import Callable
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import pytest
from unit_changes import UNITS, Answer, J, in_space, is_refused, same_answers

import nonholo as nh
from nonholo.plot.parts import is_same_body

X, Y, Z = np.zeros((3, 3, 3))
X[0, 1] = Y[1, 2] = Z[0, 2] = 1.0
HEISENBERG = nh.MatrixGroup(np.array([X, Y, Z]))  # areas beside lengths


def _sleigh(mass: float, length: float, a: float = 0.5, b: float = 0.3) -> nh.ChaplyginSleigh:
    return nh.ChaplyginSleigh(mass, 1.2 * mass * length**2, a * length, b * length)


def _heisenberg(mass: float, length: float) -> nh.LLSystem:
    inertia = mass * np.diag([1.0, 1.3, 0.7 / length**2])
    return nh.LLSystem(HEISENBERG, inertia_operator=inertia, constraint_subspace=np.eye(3)[:2])


BODIES: dict[str, Callable[[float, float], Any]] = {
    "sleigh": _sleigh,
    "balanced sleigh": lambda mass, length: _sleigh(mass, length, a=0.0),
    "LL in space": lambda mass, length: nh.LLSystem(nh.SE(3), *in_space(mass, length)),
    "LR in space": lambda mass, length: nh.LRSystem(nh.SE(3), *in_space(mass, length)),
    "free in space": lambda mass, length: nh.RigidBody(in_space(mass, length)[0], nh.SE(3)),
    "Heisenberg": _heisenberg,
}


def _conserved(name: str, mass: float, length: float, _: float) -> Answer:
    found = nh.conserved_momenta(BODIES[name](mass, length))
    return {"body": found.body.shape, "spatial": found.spatial.shape}


def _motion(mass: float, length: float, time: float, **forces: Any) -> tuple[Any, Answer]:
    system = nh.Forced(_sleigh(mass, length), **forces) if forces else _sleigh(mass, length)
    return system, {"restricted_velocity": np.array([0.7, 0.4 * length]) / time}


def _weight(mass: float, length: float, time: float) -> Answer:
    """Return a weight beside the axis, and friction."""
    friction = nh.Friction(np.diag([0.1 * length**2, 0.2, 0.2]) * mass / time)
    weight = nh.Gravity([0.0, -0.9 * mass * length / time**2], [0.2 * length, 0.1 * length])
    return {"potential": weight, "force": friction}


def _flow(is_heavy: bool, mass: float, length: float, time: float) -> Answer:
    """Return a flow of one body, and that of one of two in an ensemble."""
    system, start = _motion(mass, length, time, **(_weight(mass, length, time) if is_heavy else {}))
    times, sizes = np.linspace(0, 3, 4) * time, np.array([1.0, length, length]) / time
    flow = nh.flow(system, **start, times=times)
    between = flow.at(np.array([0.3, 2.2]) * time).body_velocity / sizes
    both = nh.ensemble(system, restricted_velocity=np.outer([1.0, 0.5], start["restricted_velocity"]), times=times)
    member = np.array_equal(both.restricted_momentum[0], flow.restricted_momentum)
    return {"place": flow.position / length, "velocity": flow.body_velocity / sizes, "at": between, "member": member}


def _exponents(mass: float, length: float, time: float) -> Answer:
    system, start = _motion(mass, length, time)
    orbit = nh.simulate(nh.discretize(system, 0.1 * time), **start, steps=40)
    flow = nh.flow(system, **start, times=np.linspace(0, 4, 5) * time)
    return {"map": nh.lyapunov_exponents(orbit) * time, "flow": nh.lyapunov_exponents(flow) * time}


def _exponents_under_weight(mass: float, length: float, time: float) -> Answer:
    system, start = _motion(mass, length, time, **_weight(mass, length, time))
    return {"map": nh.lyapunov_exponents(nh.simulate(nh.discretize(system, 0.1 * time), **start, steps=10)) * time}


def _connection(mass: float, length: float, time: float) -> Answer:
    discrete = nh.discretize(_sleigh(mass, length), 0.3 * time)
    orbit = nh.heteroclinic(discrete, energy=0.3 * mass * (length / time) ** 2).orbit
    return {"states": len(orbit), "velocity": orbit.body_velocity * [time, time / length, time / length]}


def _alike(mass: float, length: float, _: float) -> Answer:
    body = _sleigh(mass, length)
    same, heavier = (dataclasses.replace(body, inertia=body.inertia * factor) for factor in (1 + 1e-15, 1.1))
    return {"same": is_same_body(same, body), "heavier": is_same_body(heavier, body)}


def _compared(mass: float, length: float, time: float) -> Answer:
    """Return of which bodies in space motions are compared."""
    tensor, rows = in_space(mass, length)

    def run(off: float) -> nh.Orbit:
        turned = rows * np.repeat([1.0, off], 3)
        start = {"restricted_velocity": np.array([0.1, 0.2, 0.1]) / time, "steps": 1}
        return nh.simulate(nh.discretize(nh.LLSystem(nh.SE(3), tensor, turned), 0.1 * time), **start)

    same, other, whole = (run(off) for off in (1 + 1e-15, 1.1, 1.0))
    return {"refused": [is_refused(functools.partial(nh.compare, orbit, whole)) for orbit in (same, other)]}


def _track(mass: float, length: float, time: float) -> Answer:
    """Return which ends of a track have names: those of a closed one have one."""
    start: Any = {"body_velocity": np.array([1.0, length, 0.0]) / time}
    names = []
    for turns in (0.5, 1.0):
        orbit = nh.flow(_sleigh(mass, length, a=0.0, b=0.0), **start, times=(0.0, 2 * np.pi * turns * time))
        axes = nh.plot.blade_track(orbit).axes
        names.append(sorted(text.get_text().strip() for text in axes.texts))
        plt.close(axes.figure)
    return {"names": names}


def _turned(mass: float, length: float, time: float) -> Answer:
    """Return the torques that turn a top to a place at rest."""
    goal = {"configuration": nh.SO(3).exp([0.4, 0.2, 0.1]), "restricted_velocity": (0.0, 0.0)}
    found = nh.steer(nh.discretize(nh.SuslovTop(J * mass * length**2), 0.1 * time), {}, goal, steps=20)
    return {"outcome": str(found.outcome), "torques": found.controls * time**2 / (mass * length**2)}


def _driven(mass: float, length: float, time: float) -> Answer:
    """Return the forces of two wheels that lead past a disc and through a place, within bounds of states."""
    pytest.importorskip("casadi")
    wheels = np.array([[2.5 / length, 0.5, 0.0], [-2.5 / length, 0.5, 0.0]])
    inertia, center = 0.05 * mass * length**2, (0.05 * length, 0.0)
    body = nh.LLSystem.from_inertia(mass, inertia, center, nh.SE(2), constraint_subspace=wheels)
    start = {"body_velocity": np.array([0.1, 0.3 * length, 0.0]) / time}
    goal = {"configuration": [[1, 0, 1.2 * length], [0, 1, 0.8 * length], [0, 0, 1]], "restricted_velocity": (0.0, 0.0)}
    speed = 2.0 * length / time
    bounds = {"y": (-0.1 * length, 0.85 * length), "theta": (-0.7, 1.4), "restricted_velocity": (-speed, speed)}
    way = {"via": {12: (0.5 * length, 0.15 * length)}, "obstacles": ([(0.6 * length, 0.45 * length)], 0.2 * length)}
    found = nh.steer(nh.discretize(body, 0.1 * time), start, goal, steps=30, **way, state_bounds=bounds)
    return {"outcome": str(found.outcome), "forces": found.controls @ wheels.T * time**2 / (mass * length)}


def _fitted(mass: float, length: float, time: float) -> Answer:
    """Return the numbers of a sleigh from a guess that is far off, and what is said where they have no unit of mass."""
    size, start = mass * length**2, np.array([1.0, 0.5 * length]) / time
    truth = nh.ChaplyginSleigh(mass, 0.7 * size, 0.4 * length)
    orbit = nh.simulate(nh.discretize(truth, 0.05 * time), restricted_velocity=start, steps=60)
    noise = np.random.default_rng(0).normal(scale=1e-3, size=(3, 61)) * [[length], [length], [1.0]]
    rows = np.array([*orbit.position.T, orbit.heading]) + noise
    record = {"t": orbit.time, **dict(zip(("x", "y", "theta"), rows, strict=True))}

    def sleigh(p: Answer) -> nh.ChaplyginSleigh:
        return nh.ChaplyginSleigh(p.get("mass", mass), p["inertia"], p["a"])

    found = nh.fit(sleigh, record, {"inertia": 5 * size, "a": -0.5 * length})
    with pytest.raises(ValueError, match="none of inertia, mass alone"):
        nh.fit(sleigh, record, {"inertia": size, "a": 0.3 * length, "mass": mass})
    return {"outcome": found.outcome, "numbers": np.array([*found.parameters.values()]) / [size, length]}


QUESTIONS: dict[str, tuple[Callable[..., Answer], tuple[Any, ...], float]] = {  # with the rounding errors of answers
    **{f"momenta of {name}": (_conserved, (name,), 0.0) for name in BODIES},
    "flow": (_flow, (False,), 1e-13),
    "flow of a heavy body": (_flow, (True,), 1e-13),
    "exponents": (_exponents, (), 1e-10),
    "exponents under a weight": (_exponents_under_weight, (), 1e-10),
    "connection": (_connection, (), 1e-11),
    "bodies alike": (_alike, (), 0.0),
    "bodies compared": (_compared, (), 0.0),
    "track": (_track, (), 0.0),
    "fit": (_fitted, (), 1e-9),
    "controls": (_turned, (), 1e-6),
    "wheels": (_driven, (), 1e-9),
}
KEPT = ("flow", "flow of a heavy body", "exponents", "connection", "bodies alike", "bodies compared", "track")
MOMENTA = [f"momenta of {name}" for name in ("sleigh", "LR in space", "Heisenberg")]


@pytest.mark.profile("problems", keep=[f"{name}-length" for name in (*MOMENTA, *KEPT)])
@pytest.mark.parametrize("unit", UNITS)
@pytest.mark.parametrize("question", QUESTIONS)
def test_units_do_not_matter_to_questions(question: str, unit: str) -> None:
    """Words, counts and outcomes are the same, numbers up to rounding."""
    same_answers(*QUESTIONS[question], unit)
