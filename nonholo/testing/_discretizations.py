"""Whether a discretization follows its equations and keeps what it should."""

from typing import Any

from nonholo.base.checks import count, error, flags
from nonholo.discrete import Discretization, refuse_composition
from nonholo.systems import refuse_forces
from nonholo.testing._discrete_motion import DEFINITION, MOTION, claimed
from nonholo.testing._measures import seeded
from nonholo.testing._orbit_samples import OrbitSamples
from nonholo.testing._report import Report, run_checks


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
    refuse_forces("check_discretization(discrete=...)", getattr(discrete, "system", None))
    if not isinstance(discrete, Discretization):
        remedy = "Pass `discretize(system, time_step)` of an LLSystem or another system on a group; not in coordinates."
        requirement = "be a discretization of a system on a group"
        raise error("check_discretization(discrete=...)", requirement, type(discrete).__name__, remedy)
    refuse_composition("check_discretization(discrete=...)", discrete, "Check the discretization of order 2.")
    flags("check_discretization", definition=definition, throw=throw)
    number = count("check_discretization(steps=...)", steps, "Pass the length of the orbit.")
    samples = OrbitSamples(discrete, seeded(rng), max(number, 4))
    checks = (*MOTION, *claimed(discrete), *((DEFINITION,) if definition else ()))
    return run_checks(_owner(discrete), checks, samples, tolerance_factor, throw)


def _owner(discrete: Discretization) -> str:
    choices = (discrete.difference, discrete.constraint)
    difference, constraint = (choice if isinstance(choice, str) else "callable" for choice in choices)
    system = type(discrete.system).__name__
    step = f"time_step={float(discrete.time_step):g}"
    return f"check_discretization({system} on {discrete.system.group!r}, {step}, {difference}, {constraint})"
