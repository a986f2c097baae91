"""Calls that make systems, ready ones of the literature included, and methods of systems."""

import functools
from inspect import Parameter, signature
from typing import Any

import numpy as np
from fuzz.calls import Call, call, slow
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
    return [
        *_tops(),
        *_sleighs(),
        *_general(),
        *_forces(),
        *_methods(),
        *slow([*_in_coordinates(), *_locomotion(), *_examples()]),
    ]


def _tops() -> list[Call]:
    from_inertia, arrowhead = nh.SuslovTop.from_inertia, nh.SuslovTop.arrowhead
    inertia, diagonal = np.diag([3.0, 2.0, 2.5]), [1.0, 2.0, 3.0, 2.0]
    return [
        call("SuslovTop", nh.SuslovTop, mass_tensor=array(J, "any"), axis=array([0, 0, 1.0], none=True)),
        call("SuslovTop.from_inertia", from_inertia, inertia=array(inertia), axis=array([0.6, 0.0, 0.8])),
        call("SuslovTop.arrowhead", arrowhead, diagonal=array(diagonal, "any"), coupling=array([0.1] * 3, "any")),
        call("RigidBody", nh.RigidBody, mass_tensor=array(J, "any"), group=thing(nh.SO(3), none=True)),
        call("VeselovaTop", nh.VeselovaTop, mass_tensor=array(J, "any")),
    ]


def _sleighs() -> list[Call]:
    body = {"mass": positive(1.3), "center_of_mass": array([0.3, 0.2, -0.1], "any")}
    arrow = {"diagonal": array([0.5, 0.7, 0.4], "any"), "coupling": array([0.1, 0.1], "any")}
    plane = {"mass": positive(1.0), "inertia": positive(1.0), "a": number(0.5), "b": number(0.3)}
    return [
        call("ChaplyginSleigh", nh.ChaplyginSleigh, **plane),
        call("MultidimensionalSleigh", nh.MultidimensionalSleigh, **body, mass_tensor=array(np.eye(3), "any")),
        call("MultidimensionalSleigh.arrowhead", nh.MultidimensionalSleigh.arrowhead, **body, **arrow),
    ]


def _general() -> list[Call]:
    group, rows, annihilator = thing(nh.SO(3)), array(ROWS, "rows"), array([[0, 0, 1.0]], "rows")
    tensor, operator = array(J), array(np.diag([1.0, 2.0, 2.5]))
    return [
        call("LLSystem", nh.LLSystem, group=group, mass_tensor=tensor, constraint_subspace=rows),
        call("LLSystem [annihilator]", nh.LLSystem, group=group, mass_tensor=tensor, annihilator=annihilator),
        call("LLSystem [operator]", nh.LLSystem, group=group, inertia_operator=operator, constraint_subspace=rows),
        call("LRSystem", nh.LRSystem, group=group, mass_tensor=tensor, constraint_subspace=rows),
        call("LRSystem [annihilator]", nh.LRSystem, group=group, mass_tensor=tensor, annihilator=annihilator),
        call("is_symmetric_pair", nh.is_symmetric_pair, group=group, constraint_subspace=rows),
        call("reference_point_subspace", nh.reference_point_subspace, n=count(3), plane=array(np.eye(3)[:2], "rows")),
    ]


def _forces() -> list[Call]:
    heavy, top = nh.Gravity([0.0, 0.1, -1.0], [0.1, 0.0, 0.3]), nh.SuslovTop(J)
    forced, pose = nh.Forced(top, heavy, nh.Friction([0.1, 0.2, 0.3])), array(np.eye(3), "batch")
    acting = {"potential": anything(heavy), "force": anything(np.ones((4, 3)))}
    point = {"force": array([0.0, 0.1, -1.0]), "point": array([0.1, 0.0, 0.3])}
    return [
        call("Gravity", nh.Gravity, **point),
        call("Linear", nh.Linear, matrix=array(np.diag([0.1, 0.2, 0.3]), "any")),
        call(
            "Spring",
            nh.Spring,
            body_point=array([0.1, 0.0, 0.3]),
            space_point=array([1.0, 0.0, 0.0]),
            stiffness=number(2.0),
            length=number(0.1),
        ),
        call("Friction", nh.Friction, coefficients=array(np.diag([0.1, 0.2, 0.3]), "any")),
        call("Slip", nh.Slip, rows=array([[0.0, 0.0, 1.0]], "any"), grip=number(0.3), viscous=number(0.1)),
        call("Forced", nh.Forced, system=thing(top), **acting),
        call("forced.potential_energy", forced.potential_energy, configuration=pose),
        call("forced.potential_force", forced.potential_force, configuration=pose),
    ]


def _methods() -> list[Call]:
    found = []
    flat = nh.LLSystem(nh.SE(3), HOMOGENEOUS, FLAT_ROWS)
    for name, system in (("top", nh.SuslovTop(J)), ("sleigh", nh.ChaplyginSleigh(1.0, 1.0, 0.5)), ("flat", flat)):
        r = array([0.2, -0.3, 0.1][: system.rank], "batch", complex=True)
        p = array(0.1 + np.arange(system.group.dim), "batch", complex=True)
        either = array(r.value, "any", complex=True)  # r and p are distinguished by their length
        found += [
            call(f"{name}.{method}", getattr(system, method), **{argument: value})
            for method, argument, value in (
                ("constrained_energy", "momentum", either),
                ("restrict", "momentum", p),
                ("restricted_momentum", "restricted_velocity", r),
                ("restricted_velocity", "restricted_momentum", r),
                ("to_canonical", "restricted_momentum", r),
                ("from_canonical", "reduced_momentum", r),
                ("restrict_at", "momentum", p),
            )
        ]
    velocity, subspace = array(FLAT_ROWS[2]), array(FLAT_ROWS[2:], "rows")
    found.append(call("flat.transverse_rates", flat.transverse_rates, velocity=velocity, subspace=subspace))
    return found + _methods_in_space()


def _methods_in_space() -> list[Call]:
    system, pose = nh.VeselovaTop(np.diag([1.0, 2.0, 3.0])), array(np.eye(3), "batch")
    return [
        call(f"veselova.{method}", getattr(system, method), configuration=pose, **{argument: array(value, "any")})
        for method, argument, value in (
            ("constrained_energy", "momentum", [0.2, -0.3]),
            ("restrict_at", "momentum", [0.2, -0.3, 0.1]),
            ("restricted_momentum", "restricted_velocity", [0.2, -0.3]),
            ("restricted_velocity", "restricted_momentum", [0.2, -0.3]),
        )
    ] + [call("veselova.carried", system.carried, configuration=pose)]


def _in_coordinates() -> list[Call]:
    make, action = nh.GroupLagrangeDAlembert, nh.mass_tensor_lagrangian(nh.SE(2), np.eye(3))
    named = {"coordinates": anything(("x", "y")), "name": text("particle")}
    free, spring = nh.LagrangeDAlembert(_kinetic, None, dimension=2), {"configuration": array([0.1, 0.2])}
    moving: dict[str, Argument] = {"body_velocity": array([0.5, 1.0])}
    given: dict[str, Argument] = {"lagrangian": function(_kinetic), "constraint_forms": function(None, none=True)}
    times = array([0.0, 0.1, 0.2], "any")
    tolerances = {"rtol": positive(1e-8), "atol": positive(1e-10)}
    pair = {"q": array([0.0, 0.0]), "q_next": array([1.0, 2.0]), "time_step": positive(0.5)}
    discrete, blocks = nh.discretize(free, 0.1), {"steps": count(3), "block_steps": count(2, none=True)}
    members = {"discrete": thing(discrete), "body_velocity": array([[0.5, 1.0], [1.0, 0.0]], "rows")}
    found = {"discrete": thing(discrete), "events": anything(None)}
    return [
        call("LagrangeDAlembert", nh.LagrangeDAlembert, **given, dimension=count(2), rule=text("midpoint"), **named),
        call("LagrangeDAlembert.regularity", free.regularity, **pair),
        call("discretize [coordinates]", nh.discretize, system=thing(free), time_step=positive(0.1)),
        call("flow [coordinates]", nh.flow, system=thing(free), **spring, **moving, times=times, **tolerances),
        call("iterate [coordinates]", nh.iterate, discrete=thing(discrete), **spring, **moving, **blocks),
        call("ensemble [coordinates]", nh.ensemble, **members, **spring, steps=count(3)),
        call("simulate [coordinates]", nh.simulate, **found, **spring, **moving, steps=count(3)),
        call(
            "GroupLagrangeDAlembert",
            make,
            group=thing(nh.SE(2)),
            discrete_lagrangian=function(action),
            constraint_forms=function(None, none=True),
        ),
        call("mass_tensor_lagrangian", nh.mass_tensor_lagrangian, group=thing(nh.SE(2)), mass_tensor=array(np.eye(3))),
    ]


def _locomotion() -> list[Call]:
    car, pose, shape = nh.examples.kinematic_car(), anything(("x", "y", "theta")), array([0.1, 0.2], "batch")
    moving = {"shape": shape, "shape_velocity": array([0.3, 0.4], "batch")}
    gait = {"period": positive(1.0), "corners": array([0.5], "any"), "momentum": array([], none=True)}

    @functools.cache
    def connection() -> Any:  # made when it is asked for: JAX compiles it
        return nh.local_connection(car.system)

    def drawn(**given: Any) -> None:
        import matplotlib.pyplot as plt

        try:
            nh.plot.curvature(connection(), **given)
        finally:
            plt.close("all")

    ranges, names = array([[-1.0, 1], [-1, 1]], none=True), anything(("psi", "phi"))
    drawing = {"component": text("omega"), "along": names, "bounds": ranges, "shape": array([0.0, 0.1], none=True)}
    asked = {"system": thing(car.system), "configuration": array(car.configuration), "depth": count(2, none=True)}
    rows = lambda s: np.eye(3, 5) + 0 * s.sum()  # noqa: E731
    body = {"group": thing(nh.SO(3)), "shape_coordinates": anything(("a", "b")), "name": text("Satellite")}
    return [
        call("ShapedBody", nh.ShapedBody, **body, constraint_forms=function(rows), lagrangian=thing(None)),
        call("accessibility", nh.accessibility, **asked),
        call("geometric_phase", nh.geometric_phase, system=thing(car.system), gait=function(_still), **gait),
        call("local_connection", nh.local_connection, system=thing(car.system), pose=pose),
        call("connection.matrix", lambda shape: connection().matrix(shape), shape=shape),
        call("connection.curvature", lambda shape: connection().curvature(shape), shape=shape),
        call("connection.body_velocity", lambda **given: connection().body_velocity(**given), **moving),
        call("connection.momentum_rate", lambda **given: connection().momentum_rate(**given), **moving),
        call("plot.curvature", drawn, **drawing),
    ]


_POSITIVE = {
    *("mass", "inertia", "radius", "rolling_inertia", "half_length", "rotor_inertia", "wheelbase", "wheel_radius"),
    *("joint", "moving_mass", "handle_mass", "frequency", "reach"),
}
_ROWS = {"hitches"}


def _examples() -> list[Call]:
    """Return the calls of ready systems, by their signatures."""
    made = {name: getattr(nh.examples, name) for name in nh.examples.__all__ if name != "Example"}
    return [
        call(f"examples.{name}", make, **{each.name: _kind(each) for each in signature(make).parameters.values()})
        for name, make in made.items()
    ]


def _kind(parameter: Parameter) -> Argument:
    """Return the kind of an argument by its default and its name."""
    name, value = parameter.name, parameter.default
    if value is None:
        return anything(value)
    if isinstance(value, tuple):
        return array(value, "any" if name in _ROWS else "same")
    return count(value) if isinstance(value, int) else (positive if name in _POSITIVE else number)(value)
