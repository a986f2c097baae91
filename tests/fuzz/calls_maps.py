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
    W = nh.SO(3).exp(BENT)
    return [
        call("discretize", nh.discretize, system=thing(TOP.system), time_step=positive(0.2), **options),
        *(_inverse(name, DISCRETE[name]) for name in ("top", "sleigh", "top 4")),
        *_branches(),
        call("discrete_legendre", nh.discrete_legendre, discrete=thing(TOP), displacement=array(W), side=text("left")),
        call("step", nh.step, discrete=thing(TOP), momentum=array([0.1, 0.2]), branch=rule("principal"), slow=True),
        call(
            "rollout",
            nh.rollout,
            discrete=thing(TOP),
            restricted_velocity=array([0.3, -0.2]),
            configuration=array(W),
            controls=array(np.zeros((2, 3))),
            steps=count(2),
            save_every=count(1),
            slow=True,
        ),
        call("step [flat]", nh.step, discrete=thing(FLAT), momentum=array([0.1, 0.2, 0.1]), slow=True),
        call(
            "moser_veselov_displacement",
            nh.moser_veselov_displacement,
            mass_tensor=array(J, "any"),
            momentum=array([0.3, 0.4, 0.2]),
            time_step=positive(0.1),
        ),
        *_matrices(W),
    ]


def _inverse(name: str, discrete: nh.Discretization) -> Call:
    W = nh.simulate(discrete, restricted_velocity=[0.3, -0.2, 0.1][: discrete.system.rank], steps=1).displacement[0]
    momentum = array(nh.discrete_legendre(discrete, W))
    function = nh.inverse_discrete_legendre
    return call(f"inverse_discrete_legendre [{name}]", function, discrete=thing(discrete), momentum=momentum)


def _branches() -> list[Call]:
    found = []
    for name, discrete, r in (("top", TOP, [0.1, 0.2]), ("sleigh", SLEIGH, [0.3, 0.4]), ("top 4", TOP_4, [0.1] * 3)):
        given, W = (
            {"discrete": thing(discrete)},
            discrete.system.group.exp(0.3 * discrete.system.constraint_subspace[0]),
        )
        found += [
            call(f"branches [{name}]", nh.branches, **given, displacement=array(W)),
            call(f"displacements_over [{name}]", nh.displacements_over, **given, restricted_momentum=array(r)),
            call(f"fold_distance [{name}]", nh.fold_distance, **given, displacement=array(W)),
            call(f"branch_tree [{name}]", nh.branch_tree, **given, displacement=array(W), depth=integer(2)),
        ]
    certified = {"discrete": thing(SLEIGH), "momentum": array([0.3, 0.4]), "certify": flag(True)}
    grown = {"discrete": thing(SLEIGH), "energy": positive(500.0)}
    return [
        *found,
        call("branches [certified]", nh.branches, **certified),
        call("branch_growth", nh.branch_growth, **grown),
        call("branch_growth [certified]", nh.branch_growth, **grown, certify=flag(True)),
    ]


def _matrices(W: np.ndarray) -> list[Call]:
    defect, rotation = nh.consistency_defect, array(W, "batch")
    moments, angles = array([5.0, 4.0, 3.0], "batch"), array([0.0, 0.4, 0.0], "batch")
    lagrangian = nh.euler_angle_discrete_lagrangian
    return [
        call("in_exp_d", nh.in_exp_d, displacement=rotation, tolerance=positive(1e-9)),
        call("trace_constraints", nh.trace_constraints, configuration=rotation, configuration_next=rotation),
        call(
            "euler_angle_discrete_lagrangian", lagrangian, principal_moments=moments, angles=angles, angles_next=angles
        ),
        call("consistency_defect", defect, discrete=thing(SLEIGH), discretization_map=anything(None), slow=True),
    ]
