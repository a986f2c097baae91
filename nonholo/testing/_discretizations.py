"""Whether a discretization follows its equations and keeps what it should, and has the order that it claims."""

import dataclasses
from typing import Any

import numpy as np

from nonholo.analysis import Convergence, compare, invariants
from nonholo.base.checks import count, error, flags, generator, instance, positive, refuse_given
from nonholo.base.types import Float
from nonholo.discrete import Discretization, discrete_legendre, refuse_composition
from nonholo.simulation import flow, refuse_many_matrices, simulate
from nonholo.systems import AbstractCoordinateDiscretization, Forced, refuse_slip
from nonholo.testing._coordinates import MAP, CoordinateSamples
from nonholo.testing._orbit_samples import COUNTS, EXACT, STEP, OrbitSamples, off_two, result_or_raise, slope
from nonholo.testing._report import (
    Check,
    Report,
    derivative,
    gap,
    largest,
    measures,
    need,
    relative,
    run_checks,
)

_MANY = 1000  # halvings; more than any memory holds


def check_order(
    discrete: Discretization,
    body_velocity: Float[np.ndarray, "dim"],
    *,
    steps: int = 20,
    halvings: int = 2,
    tolerance: float = 0.2,
    throw: bool = True,
) -> Convergence:
    r"""Check that momenta and poses converge to the continuous motion with the order of a discretization.

    $$ \max_k|r_k - r(t_k)| = O(h^p), \qquad \max_k\|g_k^{-1}g(t_k) - I\| = O(h^p), \qquad p = 2, 4, 6, 8. $$

    The same motion is run with the time step, a half of it, a fourth and so on, and compared with `nh.flow`. Errors
    that are only rounding have no order and pass; take larger steps to see one. `plot()` of what is returned draws the
    errors over the time step.

    Args:
        discrete: Made by `discretize` for a system on a group, with the largest time step.
        body_velocity: The start; it satisfies the constraint.
        steps: Length of the run with the largest time step.
        halvings: How often the time step is halved.
        tolerance: The largest distance of the slopes of $\log$ error over $\log h$ from the order.
        throw: Raise if they are farther; otherwise only the result reports it.

    Returns:
        The errors of all runs, with `order` and `plot`.

    Raises:
        ValueError: `discrete` is no discretization of a system on a group, or the start is refused.
        OutcomeError: A run cannot continue: take a smaller time step.
        AssertionError: With `throw`: an order that is not the one claimed.

    Example:
        >>> sleigh = nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.5)
        >>> nh.testing.check_order(nh.discretize(sleigh, 0.2), (1.0, 0.5, 0.0))
        <Convergence over 3 time steps, order: momentum 2.01, pose 2.00, energy at rounding>
    """
    where, remedy = "check_order(discrete=...)", "Pass `discretize(system, time_step)` of a system on a group."
    instance(where, discrete, Discretization, "be a discretization of a system on a group", remedy)
    number = count("check_order(steps=...)", steps, "Pass the length of the first run.")
    finer = count("check_order(halvings=...)", halvings, "Pass 1 or more.")
    most = float(positive("check_order(tolerance=...)", tolerance, "Pass a positive number."))
    flags("check_order", throw=throw)
    where, all_steps = "check_order(steps=..., halvings=...)", number * 2 ** (min(finer, _MANY) + 1)
    refuse_many_matrices(where, discrete, all_steps, "Pass fewer of them.")
    h = float(discrete.time_step)
    exact = flow(discrete.system, body_velocity=body_velocity, times=(0.0, number * h))
    maps = [dataclasses.replace(discrete, time_step=h / 2**k) for k in range(finer + 1)]
    runs = [simulate(each, body_velocity=body_velocity, steps=number * 2**k) for k, each in enumerate(maps)]
    study = compare(runs, exact)
    wrong = [slope for slope in (study.order.momentum, study.order.pose) if abs(slope - discrete.order) > most]
    if throw and wrong:
        raise AssertionError(f"`check_order(...)` must find order {discrete.order} +- {most:g}. Got {study}.")
    return study


def check_discretization(
    discrete: Discretization,
    *,
    rng: int | np.random.Generator = 0,
    steps: int = 20,
    definition: bool = True,
    configuration: Any = None,
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

    Under forces the impulses $f^-_k$, $f^+_k$ at the ends of steps are added by their definition; the balance
    of energy and work is of order 2, friction adds no energy, and without forces the bits are those of the system
    inside. Reversal is required under potentials and under forces that do not depend on time and are even in the
    velocity. The order is measured at velocities of norm one, from the given time step on.

    Args:
        discrete: Made by `discretize` for a system on a group, or a `LagrangeDAlembert`.
        rng: A generator of the start, or an integer that makes one.
        steps: Length of the orbit.
        definition: Also compare compiled steps with the definition; JAX compiles it, which takes seconds.
        configuration: Where motions begin, of a system in coordinates; random by default.
        tolerance_factor: On every tolerance, for badly scaled units.
        throw: Raise if a check fails; otherwise only the report has it.

    Returns:
        What was measured.

    Raises:
        ValueError: `discrete` is not a discretization of order 2 of such a system.
        AssertionError: With `throw`: names every check that failed, what is required and what was measured.

    Example:
        >>> sleigh = nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.5)
        >>> exact = nh.testing.check_discretization(nh.discretize(sleigh, 0.1), definition=False)
        >>> exact["energy"].status, exact["order of poses"].value < 0.1
        ('ok', True)
    """
    owner, where = "check_discretization", "check_discretization(discrete=...)"
    flags(owner, definition=definition, throw=throw)
    number = max(count(f"{owner}(steps=...)", steps, "Pass the length of the orbit."), 4)
    if isinstance(discrete, AbstractCoordinateDiscretization):
        system, h = discrete.system, discrete.time_step
        there = CoordinateSamples(owner, system, generator(f"{owner}(rng=...)", rng), configuration, h, number)
        title = f"{owner}({there.system.name}, time_step={h:g}, {there.system.rule})"
        return run_checks(title, MAP, there, tolerance_factor, throw)
    refuse_given(owner, "be left out on a group", "Leave it out.", configuration=(configuration, None))
    if not isinstance(discrete, Discretization):
        remedy = "Pass `discretize(system, time_step)`."
        raise error(where, "be a discretization", type(discrete).__name__, remedy)
    refuse_composition(where, discrete, "Check the discretization of order 2.")
    refuse_slip(where, discrete.system)
    refuse_many_matrices(f"{owner}(steps=...)", discrete, number, "Pass fewer steps.")
    samples = OrbitSamples(discrete, generator(f"{owner}(rng=...)", rng), number)
    forced = FORCED if discrete.system.is_forced else []
    checks = (*CHECKS, *forced, *checks_of_claims(samples), *((DEFINITION,) if definition else ()))
    return run_checks(_owner(discrete), checks, samples, tolerance_factor, throw)


def _owner(discrete: Discretization) -> str:
    choices = (discrete.difference, discrete.constraint)
    difference, constraint = (choice if isinstance(choice, str) else "callable" for choice in choices)
    system = type(discrete.system).__name__
    step = f"time_step={float(discrete.time_step):g}"
    return f"check_discretization({system} on {discrete.system.group!r}, {step}, {difference}, {constraint})"


CHECKS: list[Check] = []
FORCED: list[Check] = []
_SECOND = "errors against the flow fall with the square of the step: |slope - 2|"
_AGREE = ("momentum", "displacement", "configuration")


@measures(CHECKS, "inertia", "h times the second derivative of l_d at I, along d, is I; P(I) = 0", 1e-8)
def inertia(s: OrbitSamples) -> float:
    """Return the distance of the second derivative of the discrete Lagrangian along the constraint from the inertia."""
    eye, D, h = s.group.identity, s.directions, s.discrete.time_step
    exact = D @ s.system.inertia_operator @ D.T
    need(len(D), "the constraint forbids all motion")
    slope = derivative(lambda t: s.momentum(s.group.exp(t * D))) @ D.T * h
    return max(relative(slope, exact), largest(s.momentum(eye) @ D.T) * h / largest(exact))


@measures(CHECKS, "left momentum", "<P(W), x> = d/dt l_d(exp(t x) W)", 1e-8)
def left_momentum(s: OrbitSamples) -> float:
    """Compare with the derivative of l_d(exp(t x) W)."""
    W, x = s.W[:3, None], np.eye(s.group.dim)
    return relative(s.momentum(s.W[:3]), derivative(lambda t: s.lagrangian(s.group.exp(t * x) @ W)))


@measures(CHECKS, "right momentum", "<Ad*_W P(W), x> = d/dt l_d(W exp(t x))", 1e-8)
def right_momentum(s: OrbitSamples) -> float:
    """Compare with the derivative of l_d(W exp(t x))."""
    W, x = s.W[:3, None], np.eye(s.group.dim)
    momentum = discrete_legendre(s.free, s.W[:3], "right")
    return relative(momentum, derivative(lambda t: s.lagrangian(W @ s.group.exp(t * x))))


@measures(CHECKS, "self-adjoint", "l_d(W^-1) = l_d(W): not required", None)
def self_adjointness(s: OrbitSamples) -> float:
    """Compare l_d(W) with l_d(W^-1)."""
    return relative(s.lagrangian(np.linalg.inv(s.W)), s.lagrangian(s.W))


@measures(CHECKS, "identity", "the identity lies on the variety", 1e-13)
def identity(s: OrbitSamples) -> float:
    """Return the forbidden part of the identity and the distance of the chart's origin from it."""
    eye, variety = s.group.identity, s.discrete.variety
    origin = gap(variety.displaced(np.zeros(len(variety.chart))), eye)
    return max(origin, largest(s.forbidden(eye[None], s.pose[None])))


@measures(CHECKS, "tangent space", "motions along d leave the variety to second order", 1e-8)
def tangent_space(s: OrbitSamples) -> float:
    """Return the rate at which admissible motions through the identity leave the variety."""
    need(len(s.S) * len(s.A), "nothing is forbidden, or everything")
    g = np.broadcast_to(s.pose, (len(s.S), *s.pose.shape))
    return largest(derivative(lambda t: s.forbidden(s.group.exp(t * s.directions), g)))


@measures(CHECKS, "transversality", "motions along the annihilator leave the variety", 0.0)
def transversality(s: OrbitSamples) -> float:
    """Return how many forbidden directions the equations of the variety do not see."""
    need(len(s.A), "nothing is forbidden")
    back = s.group.adjoint(np.linalg.inv(s.pose)) if s.spatial else np.eye(s.group.dim)
    g = np.broadcast_to(s.pose, (len(s.A), *s.pose.shape))
    slope = derivative(lambda t: s.forbidden(s.group.exp(t * s.A @ back.T), g))
    return float(len(s.A) - np.linalg.matrix_rank(slope, tol=1e-6 * largest(slope)))


@measures(CHECKS, "orbit", f"a run with steps of norm {STEP} goes through, or with a part of that: the divisor", 32.0)
def runs(s: OrbitSamples) -> float:
    """Return the share of the intended path that a short run covers, inverted; raise what it raised."""
    return s.steps * s.step / result_or_raise(s.run)[1]


@measures(CHECKS, "finer orbits", f"one path in {COUNTS} steps goes through, or a part of it: the divisor", 32.0)
def runs_finer(s: OrbitSamples) -> float:
    """Return the same of runs in finer and finer steps."""
    return s.path / result_or_raise(s.finer)[1]


@measures(CHECKS, "start", "P(W_0) along d is the momentum of the velocity", 1e-11)
def start(s: OrbitSamples) -> float:
    """Compare the first momentum along the constraint with that of the velocity at the start."""
    velocity = s.first["restricted_velocity"] @ s.directions
    leaving = s.momentum(s.W[:1]) - s.kicks[0][:1]
    return relative(leaving[0] @ s.directions.T, s.system.inertia_operator @ velocity @ s.directions.T)


@measures(CHECKS, "variety", "displacements lie on the variety", 1e-11)
def on_variety(s: OrbitSamples) -> float:
    """Return the largest forbidden part of a displacement."""
    return largest(s.forbidden(s.W, s.orbit.configuration))


@measures(CHECKS, "group", "residual(g_k) = 0", 1e-11)
def on_group(s: OrbitSamples) -> float:
    """Return the largest distance of a pose from the group."""
    return largest(s.group.residual(s.orbit.configuration))


@measures(CHECKS, "reconstruction", "g_(k+1) = g_k W_k", 1e-12)
def reconstruction(s: OrbitSamples) -> float:
    """Compare poses with products of displacements."""
    g = s.orbit.configuration
    return gap(g[1:], g[:-1] @ s.W[:-1])


@measures(CHECKS, "momentum equation", "P_(k+1) - Ad*_(W_k) P_k vanishes on d", 1e-11)
def momentum_equation(s: OrbitSamples) -> float:
    """Return the part of the impulses along the constraint, relative to the momenta."""
    impulses = s.impulse(s.W[:-1], s.W[1:], s.orbit.configuration[1:], s.node_kicks)
    return largest(impulses @ s.S.T) / largest(s.momentum(s.W))


@measures(CHECKS, "multipliers", "P_(k+1) - Ad*_(W_k) P_k = sum lambda_j a^j", 1e-11)
def multipliers(s: OrbitSamples) -> float:
    """Compare impulses with the sum over the multipliers, relative to the momenta."""
    impulses = s.impulse(s.W[:-1], s.W[1:], s.orbit.configuration[1:], s.node_kicks)
    return largest(impulses - s.orbit.multipliers @ s.A) / largest(s.momentum(s.W))


def reversal(s: OrbitSamples) -> float:
    """Return by how much the inverse displacements, in inverse order, miss the equations; of forces a run back."""
    if s.forced is not None:
        r, g = s.orbit.restricted_momentum, s.orbit.configuration
        back = simulate(s.discrete, steps=len(g) - 1, momentum=-r[-1], configuration=g[-1])
        return max(gap(back.configuration[::-1], g), relative(-back.restricted_momentum[::-1], r))
    g, back = s.orbit.configuration, np.linalg.inv(s.W)
    defect = s.impulse(back[1:], back[:-1], g[1:], 0.0) @ s.S.T
    return max(largest(defect) / largest(s.momentum(s.W)), largest(s.forbidden(back, g @ s.W)))


def compiled_reversal(s: OrbitSamples) -> float:
    """Return the miss of one compiled step forward and back."""
    need(s.discrete.route.compiled_route is not None, "the step is not compiled")
    need(s.discrete.forces is None, "forces act")
    defect = invariants(s.orbit).reversal_defect
    return float("nan") if defect is None else defect


def energy_drift(s: OrbitSamples) -> float:
    """Return the largest change of the constrained energy, relative to it."""
    return invariants(s.orbit).energy_drift


@measures(CHECKS, "order of the start", "the first step is exact to second order: 3 - slope", 0.3)
def order_of_start(s: OrbitSamples) -> float:
    """Return by how much the order of the first displacement falls short of three in one step."""
    errors = [largest(orbit.displacement[0] - W) for orbit, W in zip(s.paths, s.exact[0], strict=True)]
    return max(0.0, 3 - slope(errors)) if errors[-1] > EXACT else 0.0


@measures(CHECKS, "order of momenta", _SECOND, 0.15)
def order_of_momenta(s: OrbitSamples) -> float:
    """Return the distance of the order of the momenta from two."""
    ends = [s.slower(n) * orbit.restricted_momentum[-1] for n, orbit in zip(COUNTS, s.paths, strict=True)]
    return off_two([relative(r, s.exact[1]) for r in ends])


@measures(CHECKS, "order of poses", _SECOND, 0.15)
def order_of_poses(s: OrbitSamples) -> float:
    """Return the distance of the order of the poses from two."""
    return off_two([gap(orbit.configuration[-1], s.exact[2]) for orbit in s.paths])


def definition(s: OrbitSamples) -> float:
    """Compare three compiled steps with the definition, solved by JAX."""
    need(s.discrete.route.compiled_route is not None, "the step that runs is the definition")
    need(s.discrete.forces is None, "forces act: check the system inside")
    slow = simulate(s.discrete, steps=3, backend="jax", **s.first)
    return max(relative(getattr(s.orbit[:4], name), getattr(slow, name)) for name in _AGREE)


@measures(FORCED, "no forces", "with neither potential nor force the bits are those of the system inside", 0.0)
def without_forces(s: OrbitSamples) -> float:
    """Count the states that differ."""
    alone = [dataclasses.replace(s.free, system=each) for each in (Forced(s.free.system), s.free.system)]
    size = s.step / s.discrete.time_step
    runs = [simulate(each, steps=s.steps, throw=False, **s.moving(size)) for each in alone]
    states = [np.concatenate([each.restricted_momentum.ravel(), each.configuration.ravel()]) for each in runs]
    return float(np.sum(states[0] != states[1])) if states[0].shape == states[1].shape else np.inf


@measures(FORCED, "order of the balance", "energy less work changes by the square of the step: |slope - 2|", 0.15)
def order_of_balance(s: OrbitSamples) -> float:
    """Return the distance of the order of the balance's residual from two."""
    left = [orbit.energy - orbit.energy[0] - orbit.work for orbit in s.paths]
    return off_two([largest(each) / largest(orbit.energy) for each, orbit in zip(left, s.paths, strict=True)])


@measures(FORCED, "friction", "friction alone never adds energy: its largest growth, relative", 1e-12)
def friction(s: OrbitSamples) -> float:
    """Return the largest growth of the energy in one step, relative to the first energy."""
    forced = s.forced
    need(forced and [*forced.parts] == ["friction"] and forced.potential is None, "not friction alone")
    need(s.free.conserves_energy, "free steps do not keep the energy")
    return float(np.diff(s.orbit.energy).max() / s.orbit.energy[0])


def checks_of_claims(samples: OrbitSamples) -> tuple[Check, ...]:
    """Return the checks that depend on what the discretization claims."""
    discrete = samples.discrete
    is_named = isinstance(discrete.difference, str) and discrete.constraint in ("skew", "exponential")
    claims = (
        ("reversal", "the way back solves the equations", is_named and samples.reverses, 1e-11, reversal),
        ("compiled reversal", "one compiled step and one back lead home", is_named, 1e-11, compiled_reversal),
        ("energy", "the constrained energy is constant", discrete.conserves_energy, 1e-12, energy_drift),
    )
    return tuple(
        Check(name, words if is_claimed else f"{words}: not required", tolerance if is_claimed else None, measure)
        for name, words, is_claimed, tolerance, measure in claims
    )


DEFINITION = Check("definition", "compiled steps solve the equations that JAX solves", 1e-11, definition)
