"""Ready systems as kinds of motion: steady motions where they have any, and what a record of each can tell."""

import dataclasses
from collections.abc import Callable
from typing import Any

import numpy as np
from matrix.kinds import KINDS, Kind, ready

import nonholo as nh


def _made(name: str, **arguments: Any) -> Any:
    return getattr(nh.examples, name)(**arguments)


def _at(ready: Any, *place: float) -> Any:
    """Return a ready system at rest at a place."""
    q = np.array(place)
    return dataclasses.replace(ready, configuration=q, body_velocity=0 * q)


STEADY: dict[str, Callable[[], Any]] = {
    "particle": lambda: _made("particle", planar_velocity=(0.6, 0.0)),
    "rolling disk": lambda: _made("rolling_disk", rates=(0.6, 0.5)),
    "tilting disk": lambda: _made("tilting_disk", configuration=np.zeros(5), turning=0.0, rolling=0.3),
    "knife edge on incline": lambda: _at(_made("knife_edge_on_incline", slope_acceleration=0.6), 0.0, 0.0, np.pi / 2),
    "sleigh in a well": lambda: _made("sleigh_in_a_well", stiffness=0.6, speed=0.0, turning=0.0),
    "snakeboard": lambda: _made(
        "snakeboard", configuration=(0, 0, 0.7, 0, 0.4), speed=0.6, rotor_rate=0.3, wheel_rate=0.0
    ),
    "ball in bowl": lambda: _made("ball_in_bowl", place=(0.0, 0.0), velocity=(0.0, 0.0), spin=0.6),
    "ball on turntable": lambda: _made("ball_on_turntable", table_rate=0.6, place=(0.0, 0.0), velocity=(0.0, 0.0)),
    "heavy suslov top": lambda: _made("heavy_suslov_top", stiffness=(0.5, 1.0, 0.2), velocity=(0.0, 0.0)),
    "chaotic quartic oscillator": lambda: _at(_made("chaotic_quartic_oscillator"), *np.zeros(7)),
    "non reversible": lambda: _at(_made("non_reversible"), 0.0, 0.0, np.arcsin((1 - np.sqrt(3)) / 2)),
    "Chaplygin ball": lambda: _made("chaplygin_ball", angular_velocity=(0.0, 0.0, 0.6)),
    "rattleback": lambda: _made("rattleback", tilt=(0.0, 0.0), spin=0.6),
    "snake": lambda: _made("snake", joint_rates=(0.0, 0.0)),
    "two wheeled robot": lambda: _made("two_wheeled_robot", speed=0.6, turning=0.0),
    "trailers": lambda: _made("trailers", speed=0.6, turning=0.0),
    "bicycle": lambda: _made("bicycle", lean_rate=0.0),
}
"""A steady motion of each ready system that has one, as its start."""
TELLING: dict[str, dict[str, Any]] = {
    "rolling disk": {"radius": 1.2},
    "knife edge on incline": {"slope_acceleration": 1.2},
    "driven sleigh": {"a": 0.35},
    "driven on a group": {"mass": 1.1, "torque": 0.4},
    "roller racer": {"handle": 0.35},
    "snakeboard": {"half_length": 1.1},
    "sleigh in a well": {"inertia": 0.6, "stiffness": 0.4},
    "heavy suslov top": {"first": 0.55, "second": 0.35},
    "snake": {"half_length": 0.55},
    "kinematic car": {"wheelbase": 1.1},
    "two wheeled robot": {"offset": 0.35},
    "trailers": {"hitches": np.array([1.1, 0.9, 1.2])},
}
"""A guess of a number that a record tells; by default it is the parameter of the kind."""


def _sleigh_in_a_well(p: Any) -> Any:
    """Return it with numbers of the body and of the well."""
    well = nh.ChaplyginSleigh(1.0, p["inertia"], 0.0)
    return nh.Forced(well, lambda g: p["stiffness"] * (g[0, 2] ** 2 + g[1, 2] ** 2) / 2)


def _heavy_top(p: Any) -> Any:
    """Return it with numbers of its mass tensor."""
    unit, potential = np.eye(3), nh.examples.heavy_suslov_top().system.potential
    first, second = (p[name] * np.diag(row) for name, row in zip(("first", "second"), unit, strict=False))
    return nh.Forced(nh.SuslovTop(first + second + 0.7 * np.diag(unit[2])), potential)


BODIES: dict[str, tuple[Callable[[Any], Any], dict[str, float]]] = {
    "sleigh in a well": (_sleigh_in_a_well, {"inertia": 0.5, "stiffness": 0.3}),
    "heavy suslov top": (_heavy_top, {"first": 0.5, "second": 0.3}),
}
"""Bodies on groups as functions of numbers that a record tells, and these."""

READY: dict[str, Kind] = {
    "particle": KINDS["particle"],
    "rolling disk": KINDS["rolling disk"],
    "tilting disk": ready("tilting_disk", "coordinates"),
    "ball in bowl": ready("ball_in_bowl", "coordinates"),
    "ball on turntable": ready("ball_on_turntable", "coordinates"),
    "knife edge on incline": ready("knife_edge_on_incline", "coordinates"),
    "sleigh in a well": KINDS["sleigh in a well"],
    "heavy suslov top": dataclasses.replace(
        ready("heavy_suslov_top", "opaque", "function", parameter="inertia", values=(1.0, 1.2, 0.8)),
        system=lambda tensor: dataclasses.replace(nh.examples.heavy_suslov_top().system, system=nh.SuslovTop(tensor)),
        parameter="mass_tensor",
        values=(np.diag([0.5, 0.3, 0.7]), np.diag([0.6, 0.3, 0.7])),
    ),
    "driven sleigh": KINDS["driven sleigh"],
    "driven on a group": KINDS["driven on a group"],
    "roller racer": ready("roller_racer", "coordinates", "driven"),
    "snakeboard": KINDS["snakeboard"],
    "chaotic quartic oscillator": ready("chaotic_quartic_oscillator", "coordinates", parameter="coupling"),
    "non reversible": ready("non_reversible", "coordinates", parameter="asymmetry", values=(0.5, 0.6)),
    "Chaplygin ball": KINDS["Chaplygin ball"],
    "rattleback": ready("rattleback", "coordinates", parameter="gravity", values=(980.665, 900.0), time_step=0.01),
    "twistcar": ready("twistcar", "coordinates", "driven"),
    "snake": ready("snake", "coordinates"),
    "kinematic car": ready("kinematic_car", "coordinates"),
    "two wheeled robot": ready("two_wheeled_robot", "coordinates"),
    "trailers": ready("trailers", "coordinates"),
    "bicycle": ready("bicycle", "coordinates", parameter="gravity", values=(9.81, 9.0), time_step=0.05),
}

ALL = KINDS | READY
