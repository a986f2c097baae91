"""Questions to systems in coordinates in any unit of mass, length and time: the same answers; angles have no unit."""

import functools
from collections.abc import Callable
from typing import Any

import jax.numpy as jnp
import numpy as np
import pytest
from unit_changes import UNITS, Answer, is_refused, same_answers

import nonholo as nh


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


def _driven(*units: float) -> nh.LagrangeDAlembert:
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
    "driven cart": (_driven, [WAY, 0.4], [SPEED, 0.2], [1, 0]),
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


def _flow(name: str, *units: float) -> Answer:
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
    found = nh.equilibria(_cart(*units), configuration=np.array([0.8 + guess, guess]) * sizes)
    return {"place": found.configuration / sizes, "rates": found.rates * units[2]}


def _linear(step: float | None, *units: float) -> Answer:
    system: Any = _cart(*units) if step is None else nh.discretize(_cart(*units), step * units[2])
    found = nh.linearize(system, configuration=np.array([0.8 * units[1], 0.0]))
    rates = found.eigenvalues if step else found.eigenvalues * units[2]
    return {"names": found.names, "ignorable": found.ignorable, "rates": rates}


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
    found = nh.geometric_phase(connection, gait, momentum=np.array(momentum) * mass * length)
    poses = np.stack([found.holonomy, found.area_rule, found.configuration[-1]])
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
    **{f"steps of a {name}": (_steps, (name,), 0.0) for name in STARTS},
    **{f"flow of a {name}": (_flow, (name,), 1e-14) for name in STARTS},
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


KEPT = ["rest-length", "start of a crank-length", "flow of a driven cart-*", "linear flow-*", "critical value-time"]


@pytest.mark.profile("problems", keep=[*KEPT, "feedback-time", "car-*"])
@pytest.mark.parametrize("unit", UNITS)
@pytest.mark.parametrize("question", QUESTIONS)
def test_units_do_not_matter_in_coordinates(question: str, unit: str) -> None:
    """Words, counts and outcomes are the same, numbers up to rounding, of steps to the last bit."""
    same_answers(*QUESTIONS[question], unit)
