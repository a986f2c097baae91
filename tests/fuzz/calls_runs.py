"""Calls that run motions, one or many, and of what comes out of them."""

from typing import Any

import numpy as np
from fuzz.calls import Call, by_position, call
from fuzz.calls_maps import DISCRETE, SLEIGH, TOP
from fuzz.calls_systems import J
from fuzz.kinds import anything, array, count, flag, function, integer, number, path, positive, rule, text, thing

import nonholo as nh

_HOW = {"branch": rule("principal"), "backend": text("auto"), "save_every": count(1)}
_HOW |= {"reconstruct": flag(True), "throw": flag(True), "progress": flag(False)}
_TIMES = array([0.0, 0.1, 0.3], "any")


def moving(states: nh.Orbit) -> np.ndarray:
    """Zero where the body does not move along its first direction."""
    return states.restricted_momentum[:, 0]


def calls() -> list[Call]:
    """Return the calls of this file."""
    return [*_runs(), *_starts(), *_flows(), *_ensembles(), *_results(), *_events()]


def _velocity(discrete: nh.Discretization) -> np.ndarray:
    return np.array([0.3, -0.2, 0.1, 0.1][: discrete.system.rank])


def _runs() -> list[Call]:
    forced = nh.Forced(TOP.system, nh.Gravity([0.0, 0.1, -1.0], [0.1, 0.0, 0.3]), nh.Friction([0.1, 0.2, 0.3]))
    result = []
    for name, discrete in {**DISCRETE, "forced": nh.discretize(forced, 0.1)}.items():
        velocity = array(_velocity(discrete))
        arguments = {"discrete": thing(discrete), "steps": count(5), "restricted_velocity": velocity}
        flow = {"system": thing(discrete.system), "restricted_velocity": velocity, "times": _TIMES}
        result += [
            call(f"simulate [{name}]", **arguments, **_HOW),
            call(f"iterate [{name}]", **arguments, block_steps=count(2, none=True)),
            call(f"flow [{name}]", **flow),
        ]
    stored = {"store": path("new.zarr", none=True), "checkpoint_every": count(2, none=True)}
    arguments = {"discrete": thing(SLEIGH), "steps": count(5), "body_velocity": array([1.0, 0.3, 0.0])}
    return [*result, call("simulate [stored]", **arguments, **stored, scenario=text(None, True))]


def _starts() -> list[Call]:
    arguments, g = {"discrete": thing(TOP), "steps": count(5)}, nh.SO(3).exp(np.array([0.3, 0.2, 0.1]))
    W = nh.simulate(TOP, restricted_velocity=(0.3, 0.2), steps=1).displacement[0]
    P = nh.discrete_legendre(TOP, W)
    return [
        call("simulate [body velocity]", **arguments, body_velocity=array([0.3, -0.2, 0.0])),
        call("simulate [displacement]", **arguments, displacement=array(W), configuration=array(g)),
        call("simulate [momentum]", **arguments, momentum=array(P)),
        call("simulate [restricted]", **arguments, momentum=array([0.1, 0.2]), events=anything(None)),
    ]


def _flows() -> list[Call]:
    arguments, g = {"system": thing(SLEIGH.system), "times": _TIMES}, np.eye(3)
    how = {"rtol": positive(1e-8), "atol": positive(1e-10), "method": text(None, True), "configuration": array(g)}
    state = array([0.3, 0.4, *g.ravel()], "batch")
    return [
        call("flow [options]", **arguments, **how, body_velocity=array([0.3, 0.4, 0.0]), reconstruct=flag(True)),
        call("flow [momenta]", **arguments, momentum=array([0.3, 0.4]), reconstruct=flag(False)),
        call("flow [momentum]", **arguments, momentum=array([0.3, 0.4])),
        call("vector_field", lambda system: nh.vector_field(system), system=thing(SLEIGH.system)),
        call("vector_field [value]", by_position(nh.vector_field(SLEIGH.system)), time=number(0.0), state=state),
    ]


def _ensembles() -> list[Call]:
    starts = np.array([[0.3, -0.2], [0.1, 0.4], [0.2, 0.2]])
    arguments = {"discrete": thing(TOP), "steps": count(5), "save_every": count(1, none=True)}
    how = {"reconstruct": flag(True), "backend": text("auto"), "progress": flag(False), "events": anything(None)}
    bodies, velocity = np.stack([J, J + 0.1 * np.eye(3), J]), array(starts, "rows")
    flows = {"discrete": thing(TOP.system), "times": _TIMES, "restricted_velocity": velocity}
    parameters = lambda mass_tensor, **rest: nh.ensemble(parameters={"mass_tensor": mass_tensor}, **rest)  # noqa: E731
    return [
        call("ensemble", **arguments, restricted_velocity=velocity, parameters=anything(None), **how),
        call("ensemble [momentum]", **arguments, momentum=velocity, reduce=function(None, none=True)),
        call("ensemble [flows]", **flows, rtol=positive(1e-8), reduce=function(None, none=True)),
        call(
            "ensemble [bodies]", parameters, **arguments, restricted_velocity=array(starts), mass_tensor=array(bodies)
        ),
        *(call(f"ensemble [{name}]", **_members(discrete)) for name, discrete in DISCRETE.items()),
    ]


def _members(discrete: nh.Discretization) -> dict[str, Any]:
    velocity = array(np.outer([1.0, 0.5], _velocity(discrete)), "rows")
    often = {"steps": count(4), "save_every": count(2, none=True)}
    return {"discrete": thing(discrete), "restricted_velocity": velocity, **often}


def _results() -> list[Call]:
    orbit = nh.simulate(TOP, restricted_velocity=(0.3, 0.2), steps=4)
    flow = nh.flow(TOP.system, restricted_velocity=(0.3, 0.2), times=(0.0, 1.0))
    batch = nh.ensemble(TOP, restricted_velocity=np.array([[0.3, 0.2], [0.1, 0.1]]), steps=4, save_every=1)
    elements = array(orbit.configuration, "batch")
    poses = {"system": thing(orbit.system), "time": array(orbit.time, "any"), "configuration": elements}
    return [
        call("Ensemble.orbit", batch.orbit, member=integer(1)),
        call("Orbit.at", flow.at, times=array([0.0, 0.7], "any")),
        call("Orbit.chosen", orbit.chosen, states=anything(slice(2))),
        call("Orbit.from_poses", **poses),
        call("Orbit.to_csv", orbit.to_csv, path=path("new.csv"), overwrite=flag(False)),
        call("Orbit.to_html", orbit.to_html, path=path("new.html"), overwrite=flag(False)),
        call("explore", by_position(nh.explore), value=thing(orbit)),
        call("explore [system]", by_position(nh.explore), value=thing(SLEIGH.system)),
        call("Orbit.to_dataset", lambda: orbit.to_dataset()),
        call("Discretization.displaced", TOP.displaced, cayley=array(orbit.cayley[0], "batch")),
    ]


def _events() -> list[Call]:
    orbit, event = nh.simulate(TOP, restricted_velocity=(0.3, 0.2), steps=20), nh.Event(moving)
    crossing, sliding = nh.crossings(orbit, event), nh.simulate(SLEIGH, body_velocity=(1.0, 0.3, 0.0), steps=3)
    with_events = {"discrete": thing(TOP), "steps": count(5), "restricted_velocity": array([0.3, -0.2])}
    named = {"direction": integer(1), "stop": anything(2), "name": text("here", none=True)}
    wall = {"restitution": number(0.5), "point": array([0.0, 0.0], none=True)}
    return [
        call("Event", function=function(moving), **named),
        call("Impact", normal=array([0.0, 1.0]), **wall),
        call("crossings", orbit=thing(orbit), event=thing(event)),
        call("crossings [cusp]", orbit=thing(sliding), event=thing(nh.cusp)),
        call("Crossings.chosen", crossing.chosen, which=anything(np.arange(0))),
        call("simulate [events]", **with_events, events=anything([event])),
    ]
