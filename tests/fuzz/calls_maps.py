"""Calls of the discrete map, of its branches and of its definition."""

import numpy as np
from fuzz.calls import Call, call
from fuzz.calls_systems import FLAT_ROWS, HOMOGENEOUS, J
from fuzz.kinds import Argument, anything, array, count, flag, integer, positive, rule, text, thing

import nonholo as nh

TOP = nh.discretize(nh.SuslovTop(J), 0.2)
SLEIGH = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1)
TOP_4 = nh.discretize(nh.SuslovTop(np.diag([1.0, 2.0, 3.0, 4.0]) + 0.1), 0.2)
FLAT = nh.discretize(nh.LLSystem(nh.SE(3), HOMOGENEOUS, FLAT_ROWS), 0.1)
FREE = nh.discretize(nh.RigidBody(np.diag([1.0, 2.0, 3.0])), 0.1)
VESELOVA = nh.discretize(nh.VeselovaTop(J), 0.1)
DISCRETE = {"top": TOP, "sleigh": SLEIGH, "top 4": TOP_4, "flat": FLAT, "free": FREE, "Veselova": VESELOVA}
BENT = np.array([0.2, -0.3, 0.0])


def calls() -> list[Call]:
    """Return the calls of this file."""
    options: dict[str, Argument] = {"difference": rule("matrix"), "constraint": rule("skew"), "order": count(2)}
    W, top = nh.SO(3).exp(BENT), {"discrete": thing(TOP)}
    start = {"restricted_velocity": array([0.3, -0.2]), "configuration": array(W)}
    free = {"mass_tensor": array(J, "any"), "momentum": array([0.3, 0.4, 0.2]), "time_step": positive(0.1)}
    driven = {"controls": array(np.zeros((2, 3))), "steps": count(2), "save_every": count(1)}
    return [
        call("discretize", system=thing(TOP.system), time_step=positive(0.2), **options),
        *(_inverse(name, DISCRETE[name]) for name in ("top", "sleigh", "top 4")),
        *_branches(),
        call("discrete_legendre", **top, displacement=array(W), side=text("left")),
        call("step", **top, momentum=array([0.1, 0.2]), branch=rule("principal"), slow=True),
        call("rollout", **top, **start, **driven, slow=True),
        call("step [flat]", discrete=thing(FLAT), momentum=array([0.1, 0.2, 0.1]), slow=True),
        call("moser_veselov_displacement", **free),
        *_matrices(W),
    ]


def _inverse(name: str, discrete: nh.Discretization) -> Call:
    W = nh.simulate(discrete, restricted_velocity=[0.3, -0.2, 0.1][: discrete.system.rank], steps=1).displacement[0]
    momentum = array(nh.discrete_legendre(discrete, W))
    return call(f"inverse_discrete_legendre [{name}]", discrete=thing(discrete), momentum=momentum)


def _branches() -> list[Call]:
    result = []
    for name, discrete, r in (("top", TOP, [0.1, 0.2]), ("sleigh", SLEIGH, [0.3, 0.4]), ("top 4", TOP_4, [0.1] * 3)):
        system, arguments = discrete.system, {"discrete": thing(discrete)}
        W = {"displacement": array(system.group.exp(0.3 * system.constraint_subspace[0]))}
        result += [
            call(f"branches [{name}]", **arguments, **W),
            call(f"displacements_over [{name}]", **arguments, restricted_momentum=array(r)),
            call(f"fold_distance [{name}]", **arguments, **W),
            call(f"branch_tree [{name}]", **arguments, **W, depth=integer(2)),
        ]
    sleigh, grown = {"discrete": thing(SLEIGH)}, {"energy": positive(500.0)}
    return [
        *result,
        call("branches [certified]", **sleigh, momentum=array([0.3, 0.4]), certify=flag(True)),
        call("branch_growth", **sleigh, **grown),
        call("branch_growth [certified]", **sleigh, **grown, certify=flag(True)),
    ]


def _matrices(W: np.ndarray) -> list[Call]:
    rotation, angles = array(W, "batch"), array([0.0, 0.4, 0.0], "batch")
    turned = {"principal_moments": array([5.0, 4.0, 3.0], "batch"), "angles": angles, "angles_next": angles}
    return [
        call("in_exp_d", displacement=rotation, tolerance=positive(1e-9)),
        call("trace_constraints", configuration=rotation, configuration_next=rotation),
        call("euler_angle_discrete_lagrangian", **turned),
        call("consistency_defect", discrete=thing(SLEIGH), discretization_map=anything(None), slow=True),
    ]
