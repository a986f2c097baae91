"""Whether a discretization follows its equations and keeps what it should."""

from typing import Any

from nonholo.base.checks import count, error, flags
from nonholo.discrete import Discretization, refuse_composition
from nonholo.testing import _discrete_motion as measure
from nonholo.testing._measures import seeded
from nonholo.testing._orbit_samples import COUNTS, STEP, OrbitSamples
from nonholo.testing._report import Check, Report, run_checks

_CHECKS = (
    Check(
        "inertia",
        "h times the second derivative of l_d at I, along d, is I; P(I) = 0",
        1e-8,
        measure.inertia_at_identity,
    ),
    Check(
        "orbit",
        f"a run with steps of norm {STEP} goes through, or with a part of that: the divisor",
        32.0,
        measure.runs,
    ),
    Check("left momentum", "<P(W), x> = d/dt l_d(exp(t x) W)", 1e-8, measure.left_momentum),
    Check("right momentum", "<Ad*_W P(W), x> = d/dt l_d(W exp(t x))", 1e-8, measure.right_momentum),
    Check("self-adjoint", "l_d(W^-1) = l_d(W): not required", None, measure.self_adjointness),
    Check("identity", "the identity lies on the variety", 1e-13, measure.identity_on_variety),
    Check("tangent space", "motions along d leave the variety to second order", 1e-8, measure.tangent_space),
    Check("transversality", "motions along the annihilator leave the variety", 0.0, measure.transversality),
    Check("start", "P(W_0) along d is the momentum of the velocity", 1e-11, measure.start),
    Check("variety", "displacements lie on the variety", 1e-11, measure.on_variety),
    Check("group", "residual(g_k) = 0", 1e-11, measure.on_group),
    Check("reconstruction", "g_(k+1) = g_k W_k", 1e-12, measure.reconstruction),
    Check("momentum equation", "P_(k+1) - Ad*_(W_k) P_k vanishes on d", 1e-11, measure.momentum_equation),
    Check("multipliers", "P_(k+1) - Ad*_(W_k) P_k = sum lambda_j a^j", 1e-11, measure.multipliers),
    Check(
        "finer orbits",
        f"one path in {COUNTS} steps goes through, or a part of it: the divisor",
        32.0,
        measure.runs_finer,
    ),
    Check("order of the start", "the first step is exact to second order: 3 - slope", 0.3, measure.order_of_start),
    Check(
        "order of momenta",
        "errors against the flow fall with the square of the step: |slope - 2|",
        0.15,
        measure.order_of_momenta,
    ),
    Check(
        "order of poses",
        "errors against the flow fall with the square of the step: |slope - 2|",
        0.15,
        measure.order_of_poses,
    ),
)
_DEFINITION = Check("definition", "compiled steps solve the equations that JAX solves", 1e-11, measure.definition)


def check_discretization(
    discrete: Discretization,
    *,
    rng: Any = None,
    steps: int = 20,
    definition: bool = True,
    tolerance_factor: float = 1.0,
    throw: bool = True,
) -> Report:
    r"""Check that a discretization follows its equations, is of second order and keeps what is claimed of it.

    $$ \langle P(W), x\rangle = \tfrac{d}{dt}l_d(e^{tx}W)\big|_0, \qquad
       P_{k+1} - \mathrm{Ad}^*_{W_k}P_k = \sum_j\lambda_j a^j, \qquad g_{k+1} = g_kW_k. $$

    Measured on short orbits from a random admissible start: momenta against differences of the discrete Lagrangian;
    variety and tangent space; momentum equation and multipliers; order against the continuous flow; the step back.
    Reversal is required of the named differences with "skew" or "exponential", constant energy where
    `discrete.conserves_energy`; elsewhere both are reported, as is whether $l_d(W^{-1}) = l_d(W)$.

    Args:
        discrete: Made by `discretize` for a system on a group.
        rng: Seed or generator of the start; by default a fixed seed.
        steps: Length of the orbit.
        definition: Also compare compiled steps with the definition; JAX compiles it, which takes seconds.
        tolerance_factor: On every tolerance, for badly scaled units.
        throw: Raise if a check fails; otherwise only the report says so.

    Returns:
        What was measured.

    Raises:
        ValueError: `discrete` is not a discretization of order 2 of a system on a group.
        AssertionError: With `throw`: names every check that failed, what is required and what was measured.

    Example:
        >>> sleigh = nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.5)
        >>> exact = nh.testing.check_discretization(nh.discretize(sleigh, 0.1), definition=False)
        >>> exact["energy"].status, exact["order of poses"].value < 0.1
        ('ok', True)
    """
    if not isinstance(discrete, Discretization):
        remedy = "Pass `discretize(system, time_step)` of an LLSystem or another system on a group; not in coordinates."
        requirement = "be a discretization of a system on a group"
        raise error("check_discretization(discrete=...)", requirement, type(discrete).__name__, remedy)
    refuse_composition("check_discretization(discrete=...)", discrete, "Check the discretization of order 2.")
    flags("check_discretization", definition=definition, throw=throw)
    number = count("check_discretization(steps=...)", steps, "Pass the length of the orbit.")
    samples = OrbitSamples(discrete, seeded(rng), max(number, 4))
    checks = (*_CHECKS, *_conserved(discrete), *((_DEFINITION,) if definition else ()))
    return run_checks(_owner(discrete), checks, samples, tolerance_factor, throw)


def _conserved(discrete: Discretization) -> tuple[Check, ...]:
    """Return the checks that depend on what the discretization claims."""
    named = isinstance(discrete.difference, str) and discrete.constraint in ("skew", "exponential")
    back, energy = (None, ": not required"), (None, ": not required")
    if named:
        back = (1e-11, "")
    if discrete.conserves_energy:
        energy = (1e-12, "")
    return (
        Check("reversal", f"inverse displacements solve the equations backwards{back[1]}", back[0], measure.reversal),
        Check(
            "compiled reversal",
            f"one compiled step and one back lead home{back[1]}",
            back[0],
            measure.compiled_reversal,
        ),
        Check("energy", f"the constrained energy is constant{energy[1]}", energy[0], measure.energy_drift),
    )


def _owner(discrete: Discretization) -> str:
    difference, constraint = (
        x if isinstance(x, str) else "callable" for x in (discrete.difference, discrete.constraint)
    )
    system = type(discrete.system).__name__
    step = f"time_step={float(discrete.time_step):g}"
    return f"check_discretization({system} on {discrete.system.group!r}, {step}, {difference}, {constraint})"
