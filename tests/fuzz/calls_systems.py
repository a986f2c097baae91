"""Calls that make systems, ready ones of the literature included, and methods of systems."""

import functools
from inspect import Parameter, signature
from typing import Any

import numpy as np
from fuzz.calls import Call, call, closed, slow
from fuzz.kinds import Argument, anything, array, count, function, number, positive, text, thing

import nonholo as nh

J = np.array([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]])
ROWS = np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
HOMOGENEOUS = np.diag([0.5, 0.7, 0.4, 1.3])
FLAT_ROWS = np.array([[0.0, 0, -1, 0, 0, 0], [0, 1.0, 0, 0, 0, 0], [0, 0, 0, 1.0, 0, 0]])


def _kinetic(_: Any, v: Any) -> Any:
    return v @ v / 2


def _still(time: Any) -> Any:
    import jax.numpy as jnp

    return jnp.array([0.1, 0.2]) + 0 * time


def calls() -> list[Call]:
    """Return the calls of this file."""
    quick = [*_tops(), *_sleighs(), *_general(), *_forces(), *_methods(), *_methods_in_space()]
    return quick + slow([*_in_coordinates(), *_locomotion(), *_examples()])


def _tops() -> list[Call]:
    inertia, diagonal = np.diag([3.0, 2.0, 2.5]), [1.0, 2.0, 3.0, 2.0]
    return [
        call("SuslovTop", mass_tensor=array(J, "any"), axis=array([0, 0, 1.0], none=True)),
        call("SuslovTop.from_inertia", inertia=array(inertia), axis=array([0.6, 0.0, 0.8])),
        call("SuslovTop.arrowhead", diagonal=array(diagonal, "any"), coupling=array([0.1] * 3, "any")),
        call("RigidBody", mass_tensor=array(J, "any"), group=thing(nh.SO(3), none=True)),
        call("VeselovaTop", mass_tensor=array(J, "any")),
    ]


def _sleighs() -> list[Call]:
    body = {"mass": positive(1.3), "center_of_mass": array([0.3, 0.2, -0.1], "any")}
    arrow = {"diagonal": array([0.5, 0.7, 0.4], "any"), "coupling": array([0.1, 0.1], "any")}
    plane = {"mass": positive(1.0), "inertia": positive(1.0), "a": number(0.5), "b": number(0.3)}
    return [
        call("ChaplyginSleigh", **plane),
        call("MultidimensionalSleigh", **body, mass_tensor=array(np.eye(3), "any")),
        call("MultidimensionalSleigh.arrowhead", **body, **arrow),
    ]


def _general() -> list[Call]:
    group, rows, annihilator = thing(nh.SO(3)), array(ROWS, "rows"), array([[0, 0, 1.0]], "rows")
    tensor, operator = array(J), array(np.diag([1.0, 2.0, 2.5]))
    return [
        call("LLSystem", group=group, mass_tensor=tensor, constraint_subspace=rows),
        call("LLSystem [annihilator]", group=group, mass_tensor=tensor, annihilator=annihilator),
        call("LLSystem [operator]", group=group, inertia_operator=operator, constraint_subspace=rows),
        call("LRSystem", group=group, mass_tensor=tensor, constraint_subspace=rows),
        call("LRSystem [annihilator]", group=group, mass_tensor=tensor, annihilator=annihilator),
        call("is_symmetric_pair", group=group, constraint_subspace=rows),
        call("reference_point_subspace", n=count(3), plane=array(np.eye(3)[:2], "rows")),
    ]


def _forces() -> list[Call]:
    heavy, top = nh.Gravity([0.0, 0.1, -1.0], [0.1, 0.0, 0.3]), nh.SuslovTop(J)
    forced, pose = nh.Forced(top, heavy, nh.Friction([0.1, 0.2, 0.3])), array(np.eye(3), "batch")
    points = {"body_point": array([0.1, 0.0, 0.3]), "space_point": array([1.0, 0.0, 0.0])}
    return [
        call("Gravity", force=array([0.0, 0.1, -1.0]), point=array([0.1, 0.0, 0.3])),
        call("Linear", matrix=array(np.diag([0.1, 0.2, 0.3]), "any")),
        call("Spring", **points, stiffness=number(2.0), length=number(0.1)),
        call("Friction", coefficients=array(np.diag([0.1, 0.2, 0.3]), "any")),
        call("Slip", rows=array([[0.0, 0.0, 1.0]], "any"), grip=number(0.3), viscous=number(0.1)),
        call("Forced", system=thing(top), potential=anything(heavy), force=anything(np.ones((4, 3)))),
        call("forced.potential_energy", forced.potential_energy, configuration=pose),
        call("forced.potential_force", forced.potential_force, configuration=pose),
    ]


def _methods() -> list[Call]:
    flat, result = nh.LLSystem(nh.SE(3), HOMOGENEOUS, FLAT_ROWS), []
    for name, system in (("top", nh.SuslovTop(J)), ("sleigh", nh.ChaplyginSleigh(1.0, 1.0, 0.5)), ("flat", flat)):
        r = array([0.2, -0.3, 0.1][: system.rank], "batch", complex=True)
        p = array(0.1 + np.arange(system.group.dim), "batch", complex=True)
        either = array(r.value, "any", complex=True)  # r and p are distinguished by their length
        result += [
            call(f"{name}.constrained_energy", system.constrained_energy, momentum=either),
            call(f"{name}.restrict", system.restrict, momentum=p),
            call(f"{name}.restricted_momentum", system.restricted_momentum, restricted_velocity=r),
            call(f"{name}.restricted_velocity", system.restricted_velocity, restricted_momentum=r),
            call(f"{name}.to_canonical", system.to_canonical, restricted_momentum=r),
            call(f"{name}.from_canonical", system.from_canonical, reduced_momentum=r),
            call(f"{name}.restrict_at", system.restrict_at, momentum=p),
        ]
    velocity, subspace = array(FLAT_ROWS[2]), array(FLAT_ROWS[2:], "rows")
    result.append(call("flat.transverse_rates", flat.transverse_rates, velocity=velocity, subspace=subspace))
    return result


def _methods_in_space() -> list[Call]:
    top, pose = nh.VeselovaTop(np.diag([1.0, 2.0, 3.0])), {"configuration": array(np.eye(3), "batch")}
    along, momentum = array([0.2, -0.3], "any"), array([0.2, -0.3, 0.1], "any")
    return [
        call("veselova.constrained_energy", top.constrained_energy, **pose, momentum=along),
        call("veselova.restrict_at", top.restrict_at, **pose, momentum=momentum),
        call("veselova.restricted_momentum", top.restricted_momentum, **pose, restricted_velocity=along),
        call("veselova.restricted_velocity", top.restricted_velocity, **pose, restricted_momentum=along),
        call("veselova.carried", top.carried, **pose),
    ]


def _in_coordinates() -> list[Call]:
    free, group, forms = nh.LagrangeDAlembert(_kinetic, None, dimension=2), thing(nh.SE(2)), function(None, none=True)
    named = {"coordinates": anything(("x", "y")), "name": text("particle"), "rule": text("midpoint")}
    place, moving = {"configuration": array([0.1, 0.2])}, {"body_velocity": array([0.5, 1.0])}
    members = {"body_velocity": array([[0.5, 1.0], [1.0, 0.0]], "rows")}
    tolerances = {"rtol": positive(1e-8), "atol": positive(1e-10)}
    pair = {"q": array([0.0, 0.0]), "q_next": array([1.0, 2.0]), "time_step": positive(0.5)}
    run, times = {"discrete": thing(nh.discretize(free, 0.1)), "steps": count(3)}, array([0.0, 0.1, 0.2], "any")
    action = function(nh.mass_tensor_lagrangian(nh.SE(2), np.eye(3)))
    return [
        call("LagrangeDAlembert", lagrangian=function(_kinetic), constraint_forms=forms, dimension=count(2), **named),
        call("LagrangeDAlembert.regularity", free.regularity, **pair),
        call("discretize [coordinates]", system=thing(free), time_step=positive(0.1)),
        call("flow [coordinates]", system=thing(free), **place, **moving, times=times, **tolerances),
        call("iterate [coordinates]", **run, **place, **moving, block_steps=count(2, none=True)),
        call("ensemble [coordinates]", **run, **place, **members),
        call("simulate [coordinates]", **run, **place, **moving, events=anything(None)),
        call("GroupLagrangeDAlembert", group=group, discrete_lagrangian=action, constraint_forms=forms),
        call("mass_tensor_lagrangian", group=group, mass_tensor=array(np.eye(3))),
    ]


def _locomotion() -> list[Call]:
    car, pose, shape = nh.examples.kinematic_car(), anything(("x", "y", "theta")), array([0.1, 0.2], "batch")
    moving = {"shape": shape, "shape_velocity": array([0.3, 0.4], "batch")}
    gait = {"period": positive(1.0), "corners": array([0.5], "any"), "momentum": array([], none=True)}

    @functools.cache
    def connection() -> Any:  # made when it is asked for: JAX compiles it
        return nh.local_connection(car.system)

    drawn = closed(lambda **arguments: nh.plot.curvature(connection(), **arguments))
    ranges, names = array([[-1.0, 1], [-1, 1]], none=True), anything(("psi", "phi"))
    drawing = {"component": text("omega"), "along": names, "bounds": ranges, "shape": array([0.0, 0.1], none=True)}
    arguments = {"system": thing(car.system), "configuration": array(car.configuration), "depth": count(2, none=True)}
    rows = lambda s: np.eye(3, 5) + 0 * s.sum()  # noqa: E731
    body = {"group": thing(nh.SO(3)), "shape_coordinates": anything(("a", "b")), "name": text("Satellite")}
    return [
        call("ShapedBody", **body, constraint_forms=function(rows), lagrangian=thing(None)),
        call("accessibility", **arguments),
        call("geometric_phase", system=thing(car.system), gait=function(_still), **gait),
        call("local_connection", system=thing(car.system), pose=pose),
        call("connection.matrix", lambda shape: connection().matrix(shape), shape=shape),
        call("connection.curvature", lambda shape: connection().curvature(shape), shape=shape),
        call("connection.body_velocity", lambda **arguments: connection().body_velocity(**arguments), **moving),
        call("connection.momentum_rate", lambda **arguments: connection().momentum_rate(**arguments), **moving),
        call("plot.curvature", drawn, **drawing),
    ]


_POSITIVE = {
    *("mass", "inertia", "radius", "rolling_inertia", "half_length", "rotor_inertia", "wheelbase", "wheel_radius"),
    *("joint", "moving_mass", "handle_mass", "frequency", "reach"),
}
_ROWS = {"hitches"}


def _examples() -> list[Call]:
    """Return the calls of ready systems, by their signatures."""
    things = {f"examples.{name}": getattr(nh.examples, name) for name in nh.examples.__all__ if name != "Example"}
    arguments = {name: signature(make).parameters.items() for name, make in things.items()}
    return [call(name, **{each: _kind(kind) for each, kind in options}) for name, options in arguments.items()]


def _kind(parameter: Parameter) -> Argument:
    """Return the kind of an argument by its default and its name."""
    name, value = parameter.name, parameter.default
    if value is None:
        return anything(value)
    if isinstance(value, tuple):
        return array(value, "any" if name in _ROWS else "same")
    return count(value) if isinstance(value, int) else (positive if name in _POSITIVE else number)(value)
