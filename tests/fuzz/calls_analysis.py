"""Calls of questions that are asked of systems, discretizations and orbits, and of the property checks."""

import numpy as np
from fuzz.calls import Call, by_position, call, slow
from fuzz.calls_maps import BENT, SLEIGH, TOP
from fuzz.kinds import anything, array, count, flag, function, integer, number, positive, text, thing

import nonholo as nh
from nonholo.analysis import deltoid

_RUN = nh.simulate(SLEIGH, body_velocity=(1.0, 0.3, 0.0), steps=8)
_RECORD = {"t": _RUN.time, "x": _RUN.position[:, 0], "y": _RUN.position[:, 1], "theta": _RUN.heading}
_HEAVY = nh.Forced(SLEIGH.system, nh.Gravity([0.0, -1.0], [0.0, 0.1]))


def _slide(numbers: dict) -> nh.ChaplyginSleigh:
    return nh.ChaplyginSleigh(1.0, 1.0, numbers["a"])


def calls() -> list[Call]:
    """Return the calls of this file."""
    return [*_of_systems(), *_of_maps(), *_of_results(), *_checks()]


def _of_systems() -> list[Call]:
    system, orbit = SLEIGH.system, nh.simulate(SLEIGH, body_velocity=(1.0, 0.3, 0.0), steps=20)
    ahead = {"configuration": array(np.eye(3)), "body_velocity": array([0.0, 0.4, 0.0])}
    halved = nh.simulate(nh.discretize(system, float(SLEIGH.time_step) / 2), body_velocity=(1.0, 0.3, 0.0), steps=40)
    return [
        call("asymptotics", subject=thing(system)),
        call("asymptotics [orbit]", subject=thing(orbit)),
        call("compare", orbit=thing(orbit), flow=thing(orbit)),
        call("compare [several]", orbit=thing([orbit, halved]), flow=thing(orbit)),
        call("conserved_momenta", system=thing(system)),
        call("equilibria", system=thing(system), energy=positive(1.0)),
        call("equilibria [free]", system=thing(nh.RigidBody(np.diag([1.0, 2, 3]))), energy=positive(1.0)),
        call("equilibria [discrete]", system=thing(TOP), energy=positive(1.0)),
        call("equilibria [near]", system=thing(_HEAVY), configuration=array(np.eye(3)), slow=True),
        call("invariant_measure", motion=thing(TOP), energy=positive(1.0)),
        call("invariants", orbit=thing(orbit)),
        call("linearize", system=thing(SLEIGH), **ahead, slow=True),
        call("lyapunov_exponents", orbit=thing(orbit)),
        call("lyapunov_function", system=thing(system)),
    ]


def _ahead(speed: float) -> nh.analysis.Linearization:
    return nh.linearize(SLEIGH, body_velocity=(0.0, speed, 0.0))


def _of_maps() -> list[Call]:
    top, sleigh, W = {"discrete": thing(TOP)}, {"discrete": thing(SLEIGH)}, nh.SO(3).exp(BENT)
    start = {"energy": positive(0.5), "side": integer(1)}
    record = {"system_of": function(_slide), "measurements": anything(_RECORD), "guess": anything({"a": 0.4})}
    record |= {"time_step": positive(0.1), "noise": anything(0.01), "bounds": anything({"a": (0.1, 1.0)})}
    begin = anything({"restricted_velocity": (0.1, 0.2)})
    steered = {**sleigh, "start": anything({}), "goal": begin, "steps": count(3)}
    around = {"method": text("ipopt"), "obstacles": anything(([(2.0, 0.0)], 0.5)), "outline": anything([(0.0, 0.1)])}
    around |= {"via": anything({2: (0.1, 0.0)}), "state_bounds": anything({"x": (-1.0, 1.0)})}
    around |= {"guess": anything([(0.0, 0.0), (0.1, 0.0)]), "progress": flag(False)}
    weights = {f"{part}_weight": positive(1.0) for part in ("state", "control", "final")}
    followed = {**sleigh, "start": begin, "controls": array(np.zeros((3, 3))), **weights, "bounds": anything(None)}
    values = {"linearization": thing(_ahead), "interval": array([1.0, 2.0]), "samples": count(1)}
    return [
        call("critical_energies", **top),
        call("critical_values", **values, slow=True),
        call("flow_obstruction", **sleigh, energy=positive(0.5), samples=count(4)),
        call("half_planes", **top, displacement=array(W, "batch")),
        call("half_planes [momentum]", **top, momentum=array([0.1, 0.2, 0.05], "batch")),
        call("heteroclinic", **sleigh, **start, configuration=array(np.eye(3))),
        call("heteroclinic [displacement]", **top, displacement=array(W)),
        call("invariant_curve", **top, energy=positive(0.5), resolution=count(40)),
        call("invariant_curve [sleigh]", **sleigh, energy=positive(0.5), resolution=count(40)),
        call("fit", **record, loss=text("linear"), slow=True),
        call("steer", **steered, bounds=anything(None), cost=text("effort"), slow=True),
        call("steer [ipopt]", **steered, **around, slow=True),
        call("tracking_feedback", **followed, slow=True),
        call("momentum_locus", **top, resolution=count(12)),
        call("single_valued_region", sleigh=thing(SLEIGH)),
    ]


def _of_results() -> list[Call]:
    system = SLEIGH.system
    locus, curve = nh.momentum_locus(TOP, 12), nh.invariant_curve(TOP, 0.5, 40)
    region, measure = deltoid(SLEIGH), nh.invariant_measure(system)
    momentum, restricted = array([0.1, 0.2, 0.05], "batch"), array([0.1, 0.2], "batch")
    jacobian, W = nh.invariant_measure(SLEIGH).jacobian, array(nh.SE(2).exp(np.array([0.0, 0.4, 0.0])), "batch")
    return [
        call("MomentumLocus.implicit", locus.implicit, momentum=momentum),
        call("MomentumLocus.whiskers", locus.whiskers, length=number(1.0)),
        call("InvariantCurve.over", curve.over, direction=number(0.3)),
        call("Deltoid.boundary", region.boundary, points=count(20)),
        call("Deltoid.touching", region.touching, angle=array(0.3, "any")),
        call("Deltoid.discriminant", region.discriminant, restricted_momentum=restricted),
        call("Deltoid.real_branches", region.real_branches, restricted_momentum=restricted),
        call("Deltoid.resting", region.resting, points=count(20)),
        call("InvariantMeasure.density", measure.density, momentum=array(restricted.value, "stack"), infinite=True),
        call("InvariantMeasure.jacobian", jacobian, displacement=W, infinite=True),
        call("LyapunovFunction", by_position(nh.lyapunov_function(system)), momentum=array(restricted.value, "stack")),
    ]


def _checks() -> list[Call]:
    rng, top, velocity = integer(0), thing(TOP), array([0.4, 0.9, 0.0], "start")
    short = {"steps": count(2), "definition": flag(False), "tolerance_factor": positive(10.0), "throw": flag(True)}
    few = {"steps": count(4), "halvings": count(1), "tolerance": positive(0.5), "throw": flag(True)}
    return slow(
        [
            call("testing.check_order", discrete=top, body_velocity=velocity, **few),
            call("testing.check_group", group=thing(nh.SO(3)), rng=rng, compiled=flag(False)),
            call("testing.check_system", system=thing(TOP.system), rng=rng),
            call("testing.check_discretization", discrete=top, **short),
        ]
    )
