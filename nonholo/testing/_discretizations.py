"""Whether a discretization follows its equations and keeps what it should."""

from typing import Any

import numpy as np

from nonholo.analysis import invariants
from nonholo.base.checks import count, error, flags
from nonholo.discrete import Discretization, discrete_legendre, refuse_composition
from nonholo.simulation import simulate
from nonholo.systems import refuse_forces
from nonholo.testing._measures import derivative, gap, largest, relative, seeded
from nonholo.testing._orbit_samples import COUNTS, PATH, STEP, OrbitSamples
from nonholo.testing._report import Check, Report, need, run_checks


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


_EXACT = 1e-11  # errors below it are rounding, and have no order
_SECOND = "errors against the flow fall with the square of the step: |slope - 2|"
_AGREE = ("momentum", "displacement", "configuration")


def inertia(s: OrbitSamples) -> float:
    """Return how far the second derivative of the discrete Lagrangian along the constraint is from the inertia."""
    eye, D, h = s.group.identity, s.directions, s.discrete.time_step
    expected = D @ s.system.inertia_operator @ D.T
    need(len(D), "the constraint forbids all motion")
    slope = derivative(lambda t: s.momentum(s.group.exp(t * D))) @ D.T * h
    return max(relative(slope, expected), largest(s.momentum(eye) @ D.T) * h / largest(expected))


def left_momentum(s: OrbitSamples) -> float:
    """Compare with the derivative of l_d(exp(t x) W)."""
    W, x = s.W[:3, None], np.eye(s.group.dim)
    return relative(s.momentum(s.W[:3]), derivative(lambda t: s.lagrangian(s.group.exp(t * x) @ W)))


def right_momentum(s: OrbitSamples) -> float:
    """Compare with the derivative of l_d(W exp(t x))."""
    W, x = s.W[:3, None], np.eye(s.group.dim)
    found = discrete_legendre(s.discrete, s.W[:3], "right")
    return relative(found, derivative(lambda t: s.lagrangian(W @ s.group.exp(t * x))))


def self_adjointness(s: OrbitSamples) -> float:
    """Compare l_d(W) with l_d(W^-1)."""
    return relative(s.lagrangian(np.linalg.inv(s.W)), s.lagrangian(s.W))


def identity(s: OrbitSamples) -> float:
    """Return the forbidden part of the identity and the distance of the chart's origin from it."""
    eye, variety = s.group.identity, s.discrete.variety
    origin = gap(variety.displaced(np.zeros(len(variety.chart))), eye)
    return max(origin, largest(s.forbidden(eye[None], s.pose[None])))


def tangent_space(s: OrbitSamples) -> float:
    """Return the rate at which admissible motions through the identity leave the variety."""
    need(len(s.S) * len(s.A), "nothing is forbidden, or everything")
    g = np.broadcast_to(s.pose, (len(s.S), *s.pose.shape))
    return largest(derivative(lambda t: s.forbidden(s.group.exp(t * s.directions), g)))


def transversality(s: OrbitSamples) -> float:
    """Return how many forbidden directions the equations of the variety do not see."""
    need(len(s.A), "nothing is forbidden")
    back = s.group.adjoint(np.linalg.inv(s.pose)) if s.spatial else np.eye(s.group.dim)
    g = np.broadcast_to(s.pose, (len(s.A), *s.pose.shape))
    slope = derivative(lambda t: s.forbidden(s.group.exp(t * s.A @ back.T), g))
    return float(len(s.A) - np.linalg.matrix_rank(slope, tol=1e-6 * largest(slope)))


def runs(s: OrbitSamples) -> float:
    """Return the share of the intended path that a short run covers, inverted; raise what it raised."""
    return s.steps * STEP / _raised(s.run)[1]


def runs_finer(s: OrbitSamples) -> float:
    """Return the same of runs in finer and finer steps."""
    return PATH / _raised(s.finer)[1]


def start(s: OrbitSamples) -> float:
    """Compare the first momentum along the constraint with that of the velocity at the start."""
    velocity = s.first["restricted_velocity"] @ s.directions
    return relative(s.momentum(s.W[0]) @ s.directions.T, s.system.inertia_operator @ velocity @ s.directions.T)


def on_variety(s: OrbitSamples) -> float:
    """Return the largest forbidden part of a displacement."""
    return largest(s.forbidden(s.W, s.orbit.configuration))


def on_group(s: OrbitSamples) -> float:
    """Return the largest distance of a pose from the group."""
    return largest(s.group.residual(s.orbit.configuration))


def reconstruction(s: OrbitSamples) -> float:
    """Compare poses with products of displacements."""
    g = s.orbit.configuration
    return gap(g[1:], g[:-1] @ s.W[:-1])


def momentum_equation(s: OrbitSamples) -> float:
    """Return the part of the impulses along the constraint, relative to the momenta."""
    impulses = s.impulse(s.W[:-1], s.W[1:], s.orbit.configuration[1:])
    return largest(impulses @ s.S.T) / largest(s.momentum(s.W))


def multipliers(s: OrbitSamples) -> float:
    """Compare impulses with the sum over the multipliers, relative to the momenta."""
    impulses = s.impulse(s.W[:-1], s.W[1:], s.orbit.configuration[1:])
    return largest(impulses - s.orbit.multipliers @ s.A) / largest(s.momentum(s.W))


def reversal(s: OrbitSamples) -> float:
    """Return by how much the inverse displacements, in inverse order, miss the equations."""
    g, back = s.orbit.configuration, np.linalg.inv(s.W)
    missed = s.impulse(back[1:], back[:-1], g[1:]) @ s.S.T
    return max(largest(missed) / largest(s.momentum(s.W)), largest(s.forbidden(back, g @ s.W)))


def compiled_reversal(s: OrbitSamples) -> float:
    """Return how far one compiled step forward and back misses its start."""
    need(s.discrete.route.compiled is not None, "the step is not compiled")
    found = invariants(s.orbit).reversal_defect
    return float("nan") if found is None else found


def energy_drift(s: OrbitSamples) -> float:
    """Return the largest change of the constrained energy, relative to it."""
    return invariants(s.orbit).energy_drift


def order_of_start(s: OrbitSamples) -> float:
    """Return how far the order of the first displacement falls short of three in one step."""
    errors = [largest(orbit.displacement[0] - W) for orbit, W in zip(s.paths, s.exact[0], strict=True)]
    return max(0.0, 3 - _slope(errors)) if errors[-1] > _EXACT else 0.0


def order_of_momenta(s: OrbitSamples) -> float:
    """Return how far the order of the momenta is from two."""
    ends = [n * orbit.restricted_momentum[-1] for n, orbit in zip(COUNTS, s.paths, strict=True)]
    return _off_two([relative(r, s.exact[1]) for r in ends])


def order_of_poses(s: OrbitSamples) -> float:
    """Return how far the order of the poses is from two."""
    return _off_two([gap(orbit.configuration[-1], s.exact[2]) for orbit in s.paths])


def definition(s: OrbitSamples) -> float:
    """Compare three compiled steps with the definition, solved by JAX."""
    need(s.discrete.route.compiled is not None, "the step that runs is the definition")
    slow = simulate(s.discrete, steps=3, backend="jax", **s.first)
    return max(relative(getattr(s.orbit[:4], name), getattr(slow, name)) for name in _AGREE)


def _raised(found: Any) -> Any:
    if isinstance(found, Exception):
        raise found
    return found


def _slope(errors: list[float]) -> float:
    return float(np.log(errors[-2] / errors[-1]) / np.log(COUNTS[-1] / COUNTS[-2]))


def _off_two(errors: list[float]) -> float:
    return abs(_slope(errors) - 2) if errors[-1] > _EXACT else 0.0


def claimed(discrete: Discretization) -> tuple[Check, ...]:
    """Return the checks that depend on what the discretization claims."""
    named = isinstance(discrete.difference, str) and discrete.constraint in ("skew", "exponential")
    claims = (
        ("reversal", "inverse displacements solve the equations backwards", named, 1e-11, reversal),
        ("compiled reversal", "one compiled step and one back lead home", named, 1e-11, compiled_reversal),
        ("energy", "the constrained energy is constant", discrete.conserves_energy, 1e-12, energy_drift),
    )
    return tuple(
        Check(name, words if is_claimed else f"{words}: not required", tolerance if is_claimed else None, measured)
        for name, words, is_claimed, tolerance, measured in claims
    )


MOTION = (
    Check("inertia", "h times the second derivative of l_d at I, along d, is I; P(I) = 0", 1e-8, inertia),
    Check("orbit", f"a run with steps of norm {STEP} goes through, or with a part of that: the divisor", 32.0, runs),
    Check("left momentum", "<P(W), x> = d/dt l_d(exp(t x) W)", 1e-8, left_momentum),
    Check("right momentum", "<Ad*_W P(W), x> = d/dt l_d(W exp(t x))", 1e-8, right_momentum),
    Check("self-adjoint", "l_d(W^-1) = l_d(W): not required", None, self_adjointness),
    Check("identity", "the identity lies on the variety", 1e-13, identity),
    Check("tangent space", "motions along d leave the variety to second order", 1e-8, tangent_space),
    Check("transversality", "motions along the annihilator leave the variety", 0.0, transversality),
    Check("start", "P(W_0) along d is the momentum of the velocity", 1e-11, start),
    Check("variety", "displacements lie on the variety", 1e-11, on_variety),
    Check("group", "residual(g_k) = 0", 1e-11, on_group),
    Check("reconstruction", "g_(k+1) = g_k W_k", 1e-12, reconstruction),
    Check("momentum equation", "P_(k+1) - Ad*_(W_k) P_k vanishes on d", 1e-11, momentum_equation),
    Check("multipliers", "P_(k+1) - Ad*_(W_k) P_k = sum lambda_j a^j", 1e-11, multipliers),
    Check("finer orbits", f"one path in {COUNTS} steps goes through, or a part of it: the divisor", 32.0, runs_finer),
    Check("order of the start", "the first step is exact to second order: 3 - slope", 0.3, order_of_start),
    Check("order of momenta", _SECOND, 0.15, order_of_momenta),
    Check("order of poses", _SECOND, 0.15, order_of_poses),
)
DEFINITION = Check("definition", "compiled steps solve the equations that JAX solves", 1e-11, definition)
