"""Questions to bodies and to systems in coordinates in any unit of mass, length and time: the same answers.

Angles have no unit.
"""

import dataclasses
import functools
from collections.abc import Callable
from typing import Any

import jax.numpy as jnp
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
    result = nh.conserved_momenta(BODIES[name](mass, length))
    return {"body": result.body.shape, "spatial": result.spatial.shape}


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
    result = nh.steer(nh.discretize(nh.SuslovTop(J * mass * length**2), 0.1 * time), {}, goal, steps=20)
    return {"outcome": str(result.outcome), "torques": result.controls * time**2 / (mass * length**2)}


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
    result = nh.steer(nh.discretize(body, 0.1 * time), start, goal, steps=30, **way, state_bounds=bounds)
    return {"outcome": str(result.outcome), "forces": result.controls @ wheels.T * time**2 / (mass * length)}


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

    result = nh.fit(sleigh, record, {"inertia": 5 * size, "a": -0.5 * length})
    with pytest.raises(ValueError, match="none of inertia, mass alone"):
        nh.fit(sleigh, record, {"inertia": size, "a": 0.3 * length, "mass": mass})
    return {"outcome": result.outcome, "numbers": np.array([*result.parameters.values()]) / [size, length]}


def _board(mass: float, length: float, time: float) -> Any:
    inertias = {"rotor_inertia": 0.5 * mass * length**2, "wheel_inertia": 0.1 * mass * length**2}
    rates = {"speed": length / time, "rotor_rate": 0.4 / time, "wheel_rate": -0.05 / time}
    return nh.examples.snakeboard(mass=mass, half_length=1.25 * length, **inertias, **rates)


def _car(mass: float, length: float, time: float) -> Any:
    lengths = {"wheelbase": length, "wheel_radius": 0.25 * length, "speed": length / time}
    inertias = {"inertia": 0.3, "wheel_inertia": 0.01, "steering_inertia": 0.01}
    return nh.examples.kinematic_car(mass=mass, **lengths, **{k: x * mass * length**2 for k, x in inertias.items()})


def _cart(mass: float, length: float, time: float, **driven: Any) -> nh.LagrangeDAlembert:
    """Return a pendulum below a cart, on a spring that holds it at the length of the pendulum."""
    parameters = {"masses": np.array([2.0, 1.3]) * mass, "arm": 0.8 * length, "weight": 0.9 * length / time**2}
    parameters |= {"spring": 2.1 * mass / time**2, "amplitude": 0.3 * length, "rate": 1.7 / time}

    def lagrangian(q: Any, v: Any, p: Any) -> Any:
        (cart, bob), arm = p["masses"], p["arm"]
        square = v[0] ** 2 + 2 * arm * v[0] * v[1] * jnp.cos(q[1]) + (arm * v[1]) ** 2
        potential = p["spring"] * (q[0] - arm) ** 2 / 2 - bob * p["weight"] * arm * jnp.cos(q[1])
        return cart * v[0] ** 2 / 2 + bob * square / 2 - potential

    return nh.LagrangeDAlembert(lagrangian, None, dimension=2, parameters=parameters, **driven)


def _driven_cart(*units: float) -> nh.LagrangeDAlembert:
    return _cart(*units, prescribed={0: lambda t, p: p["amplitude"] * jnp.sin(p["rate"] * t + 0.2)})


def _crank(mass: float, length: float, _: float) -> nh.LagrangeDAlembert:
    """Return a crank with a slider, whose rod binds an angle and a length."""
    parameters = {"inertia": 0.4 * mass * length**2, "mass": 1.3 * mass, "length": length}

    def rod(q: Any, p: Any) -> Any:
        across, along = 0.5 * p["length"] * jnp.sin(q[0]), q[1] - 0.5 * p["length"] * jnp.cos(q[0])
        return jnp.array([across**2 + along**2 - (1.3 * p["length"]) ** 2])

    def kinetic(_: Any, v: Any, p: Any) -> Any:
        return p["inertia"] * v[0] ** 2 / 2 + p["mass"] * v[1] ** 2 / 2

    return nh.LagrangeDAlembert(kinetic, None, holonomic=rod, dimension=2, parameters=parameters)


ANGLE, SLIDE = 0.7, 0.5 * np.cos(0.7) + np.sqrt(1.3**2 - (0.5 * np.sin(0.7)) ** 2)
WAY, SPEED = 0.3 * np.sin(0.2), 0.51 * np.cos(0.2)
STARTS: dict[str, Any] = {  # a system, a place, a velocity, and which coordinates are lengths
    "crank": (_crank, [ANGLE, SLIDE], [0.0, 0.0], [0, 1]),
    "driven cart": (_driven_cart, [WAY, 0.4], [SPEED, 0.2], [1, 0]),
    "cart": (_cart, [0.5, 0.4], [0.3, 0.2], [1, 0]),
}


def _start(name: str, *units: float, off: float = 0.0) -> tuple[Any, Answer, np.ndarray]:
    """Return a system, its start with the first length off, and the units of coordinates."""
    make, q, v, lengths = STARTS[name]
    sizes = units[1] ** np.array(lengths)
    place = np.array(q) * (1 + off * np.array(lengths))
    return make(*units), {"configuration": place * sizes, "body_velocity": np.array(v) * sizes / units[2]}, sizes


def _steps(name: str, *units: float) -> Answer:
    system, start, sizes = _start(name, *units)
    orbit = nh.simulate(nh.discretize(system, 0.1 * units[2]), **start, steps=30, throw=False)
    return {"outcome": int(orbit.outcome), "places": orbit.configuration / sizes}


def _flow_between(name: str, *units: float) -> Answer:
    system, start, sizes = _start(name, *units)
    orbit = nh.flow(system, **start, times=np.linspace(0, 3, 7) * units[2])
    between = orbit.at(np.array([0.7, 1.9]) * units[2])
    return {"places": orbit.configuration / sizes, "between": between.configuration / sizes}


def _tangent(name: str, *units: float) -> Answer:
    system, start, _ = _start(name, *units)
    return {"volume": np.linalg.det(nh.flow(system, **start, times=np.array([0.0, 1.0]) * units[2]).tangent)}


def _refused(name: str, *units: float) -> Answer:
    """Return by how much a length may be off at the start."""

    def run(off: float) -> nh.Orbit:
        system, start, _ = _start(name, *units, off=off)
        return nh.simulate(nh.discretize(system, 0.1 * units[2]), **start, steps=1)

    return {"refused": [is_refused(functools.partial(run, off)) for off in (1e-12, 1e-6, 1e-3)]}


def _rest(guess: float, *units: float) -> Answer:
    sizes = np.array([units[1], 1.0])
    result = nh.equilibria(_cart(*units), configuration=np.array([0.8 + guess, guess]) * sizes)
    return {"place": result.configuration / sizes, "rates": result.rates * units[2]}


def _linear(step: float | None, *units: float) -> Answer:
    system: Any = _cart(*units) if step is None else nh.discretize(_cart(*units), step * units[2])
    result = nh.linearize(system, configuration=np.array([0.8 * units[1], 0.0]))
    rates = result.eigenvalues if step else result.eigenvalues * units[2]
    return {"names": result.names, "ignorable": result.ignorable, "rates": rates}


def _critical(mass: float, length: float, time: float) -> Answer:
    """Return the value of a spring at which an upright pendulum stands."""

    def lagrangian(q: Any, v: Any, p: Any) -> Any:
        return p["inertia"] * v[0] ** 2 / 2 - p["torque"] * jnp.cos(q[0]) - p["spring"] * q[0] ** 2 / 2

    unit = mass * length**2 / time**2

    def at(spring: float) -> Any:
        parameters = {"inertia": mass * length**2, "torque": 1.5 * unit, "spring": spring}
        system = nh.LagrangeDAlembert(lagrangian, None, dimension=1, parameters=parameters)
        return nh.linearize(system, configuration=[0.0])

    return {"spring": nh.critical_values(at, (unit, 2.25 * unit), samples=4) / unit}


def _phase(make: Callable[..., Any], momentum: list[float], *units: float) -> Answer:
    mass, length, _ = units

    def gait(time: Any) -> Any:
        return jnp.array([0.4 * jnp.sin(time), 0.5 * jnp.sin(2 * time)])

    connection = nh.local_connection(make(*units).system)
    result = nh.geometric_phase(connection, gait, momentum=np.array(momentum) * mass * length)
    poses = np.stack([result.holonomy, result.area_rule, result.configuration[-1]])
    poses[:, :2, 2] /= length
    return {"momenta": connection.momentum_components, "poses": poses}


def _growth(make: Callable[..., Any], *units: float) -> Answer:
    ready = make(*units)
    return {"growth": nh.accessibility(ready.system, ready.configuration).growth}


def _ready(make: Callable[..., Any], *units: float) -> Answer:
    ready = make(*units)
    start = {"configuration": ready.configuration, "body_velocity": ready.body_velocity}
    orbit = nh.simulate(nh.discretize(ready.system, 0.1 * units[2]), **start, steps=20, throw=False)
    return {"outcome": int(orbit.outcome), "shape": orbit.configuration[:, 2:]}


def _led_back(mass: float, length: float, time: float) -> Answer:
    """Return a motion under feedback, with errors and forces weighed by their units."""

    def lagrangian(q: Any, v: Any, p: Any) -> Any:
        return p["mass"] * (v[0] ** 2 + v[1] ** 2 / 2) / 2 - p["spring"] * (q[0] - q[1]) ** 2 / 2

    def constraint(q: Any, p: Any) -> Any:
        return jnp.array([[1.0, -0.3 * jnp.sin(q[0] / p["size"])]])

    parameters = {"mass": mass, "spring": 0.5 * mass / time**2, "size": length}
    system: Any = nh.LagrangeDAlembert(lagrangian, constraint, dimension=2, parameters=parameters)

    def start(place: float) -> dict[str, Any]:
        velocity = np.array([0.3 * np.sin(place), 1.0]) * 0.7 * length / time
        return {"configuration": np.array([place, 0.2]) * length, "body_velocity": velocity}

    sizes, force = np.repeat([length, length / time], 2), mass * length / time**2
    weights = {"state_weight": sizes**-2.0 / time, "control_weight": force**-2.0 / time, "final_weight": sizes**-2.0}
    feedback = nh.tracking_feedback(nh.discretize(system, 0.1 * time), start(0.3), np.zeros((20, 2)), **weights)
    motion = feedback.simulate(**start(0.35))
    return {"error": motion.error / sizes, "forces": motion.controls / force}


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
    **{f"steps of a {name}": (_steps, (name,), 0.0) for name in STARTS},
    **{f"flow of a {name}": (_flow_between, (name,), 1e-14) for name in STARTS},
    "tangent of a flow": (_tangent, ("cart",), 1e-11),
    "start of a crank": (_refused, ("crank",), 0.0),
    "start of a driven cart": (_refused, ("driven cart",), 0.0),
    "rest": (_rest, (0.35,), 1e-9),
    "linear flow": (_linear, (None,), 1e-12),
    "linear map": (_linear, (0.1,), 1e-12),
    "critical value": (_critical, (), 1e-12),
    "phase of a car": (_phase, (_car, []), 1e-11),
    "phase of a snakeboard": (_phase, (_board, [0.3]), 1e-11),
    "feedback": (_led_back, (), 1e-12),
    "growth of a car": (_growth, (_car,), 0.0),
    "growth of a snakeboard": (_growth, (_board,), 0.0),
    "car": (_ready, (_car,), 0.0),
    "snakeboard": (_ready, (_board,), 0.0),
}
KEPT = ("flow", "flow of a heavy body", "exponents", "connection", "bodies alike", "bodies compared", "track")
KEPT += tuple(f"momenta of {name}" for name in ("sleigh", "LR in space", "Heisenberg"))
IN_COORDINATES = ("rest-length", "start of a crank-length", "flow of a driven cart-*", "linear flow-*")


@pytest.mark.profile(
    "problems",
    keep=[*(f"{name}-length" for name in KEPT), *IN_COORDINATES, "critical value-time", "feedback-time", "car-*"],
)
@pytest.mark.parametrize("unit", UNITS)
@pytest.mark.parametrize("question", QUESTIONS)
def test_units_do_not_matter_to_questions(question: str, unit: str) -> None:
    """Words, counts and outcomes are the same, numbers up to rounding, of steps in coordinates to the last bit."""
    same_answers(*QUESTIONS[question], unit)
