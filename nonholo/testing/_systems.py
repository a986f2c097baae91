"""Whether a system fits together and moves as its equations say."""

import functools
from collections.abc import Callable
from typing import Any

import numpy as np

from nonholo.analysis import ConservedMomenta, conserved_momenta
from nonholo.base.checks import error, flags, generator, refuse_given
from nonholo.base.types import Float
from nonholo.continuous import vector_field
from nonholo.systems import AbstractCoordinateSystem, AbstractSystem, Equilibria, refuse_slip
from nonholo.testing import _report as report
from nonholo.testing._coordinates import SYSTEM, CoordinateSamples
from nonholo.testing._report import Check, Report, derivative, gap, largest, measures, need, relative, run_checks

_COUNT = 4
CHECKS: list[Check] = []
"""Tolerances leave room for rounding at inertias of a few units, and for central differences, good to 1e-11 or so."""


class SystemSamples:
    """Random admissible states of a system, with momenta and velocities from the definitions.

    Args:
        system: The system.
        rng: Where the numbers come from.
    """

    def __init__(self, system: AbstractSystem, rng: np.random.Generator) -> None:
        self.moving, self.forced = system, system.forces
        self.system = system.inside  # forces are all that is added to it
        self.group = system.group
        self.spatial = system.is_spatial
        self.S, self.A = np.asarray(system.constraint_subspace), np.asarray(system.annihilator)
        self.inertia = np.asarray(system.inertia_operator)
        self.covectors = rng.normal(size=(_COUNT, self.group.dim))
        self._rows = rng.normal(size=(_COUNT, len(self.S)))
        self._rng = rng

    @functools.cached_property
    def velocity(self) -> Float[np.ndarray, "4 k"]:
        """Admissible velocities of norm one, in rows of the constraint subspace (spatial ones for an LR system)."""
        return self._rows / np.linalg.norm(self._rows @ self.S, axis=1)[:, None]

    @functools.cached_property
    def g(self) -> Float[np.ndarray, "4 N N"]:
        """Poses."""
        return np.stack([self.group.random(self._rng) for _ in range(_COUNT)])

    @functools.cached_property
    def directions(self) -> Float[np.ndarray, "4 k dim"]:
        """The admissible directions in the body."""
        rows = np.swapaxes(self.system.carried(np.linalg.inv(self.g)) @ self.S.T, -1, -2)
        return np.broadcast_to(rows, (_COUNT, *self.S.shape))

    @functools.cached_property
    def body_velocity(self) -> Float[np.ndarray, "4 dim"]:
        """The body velocities."""
        return (self.velocity[:, None, :] @ self.directions)[:, 0]

    @functools.cached_property
    def momentum(self) -> Float[np.ndarray, "4 dim"]:
        """Their momenta."""
        return self.body_velocity @ self.inertia.T

    @functools.cached_property
    def restricted(self) -> Float[np.ndarray, "4 k"]:
        """The momenta along the admissible directions."""
        return (self.directions @ self.momentum[:, :, None])[:, :, 0]

    @functools.cached_property
    def rate(self) -> tuple[Float[np.ndarray, "4 k"], Float[np.ndarray, "4 N N"]]:
        """The rates of restricted momentum and pose by the vector field of the system."""
        k = len(self.S)
        need(self.forced is None or self.forced.table is None, "one force for each step")
        rate = vector_field(self.moving)(0.0, np.concatenate([self.restricted, self.g.reshape(_COUNT, -1)], axis=-1))
        return rate[:, :k], rate[:, k:].reshape(self.g.shape)

    def along_the_motion(self, quantity: Callable[[np.ndarray, np.ndarray], Any]) -> np.ndarray:
        """Return the rate of change of a function of restricted momentum and pose."""
        momentum_rate, pose_rate = self.rate
        turn = self.group.vee(np.linalg.inv(self.g) @ pose_rate)
        return derivative(lambda t: quantity(self.restricted + t * momentum_rate, self.g @ self.group.exp(t * turn)))

    @functools.cached_property
    def force(self) -> Float[np.ndarray, "4 dim"]:
        """The forces of a function or of friction on them at time zero."""
        states = zip(self.g, self.body_velocity, strict=True)
        rows = [] if self.forced is None else [self.forced.applied_force(0.0, *state) for state in states]
        return np.reshape(rows or np.zeros_like(self.momentum), self.momentum.shape)

    def potential(self, g: np.ndarray) -> Any:
        """Return the potential energy."""
        return 0.0 if self.forced is None else self.forced.potential_energy(g)

    def full_momentum(self, restricted: np.ndarray, g: np.ndarray) -> np.ndarray:
        """Return the momentum of the admissible velocity with these momenta along the constraint."""
        velocity = self.system.restricted_velocity(restricted, g) @ self.S
        return (self.system.carried(np.linalg.inv(g)) @ velocity[..., None])[..., 0] @ self.inertia.T


@measures(CHECKS, "sizes", "constraint_subspace (k, dim), annihilator (dim - k, dim), inertia_operator (dim, dim)", 0.0)
def _sizes(s: SystemSamples) -> float:
    dim = s.group.dim
    shapes = [(s.S, (len(s.S), dim)), (s.A, (dim - len(s.S), dim)), (s.inertia, (dim, dim))]
    return sum(array.shape != shape for array, shape in shapes)


@measures(CHECKS, "complementary", "rows of constraint_subspace and annihilator together span the space", 0.0)
def _complementary(s: SystemSamples) -> float:
    rows = np.concatenate([s.S, s.A])
    return s.group.dim - np.linalg.matrix_rank(rows / np.linalg.norm(rows, axis=1)[:, None])


@measures(CHECKS, "annihilator", "annihilator @ constraint_subspace.T = 0", 1e-13)
def _annihilator(s: SystemSamples) -> float:
    scale = np.linalg.norm(s.A, axis=1)[:, None] * np.linalg.norm(s.S, axis=1)
    return largest(s.A @ s.S.T / scale)


@measures(CHECKS, "inertia of the mass tensor", "inertia_operator[i, j] = tr(E_i J E_j*)", 1e-12)
def _mass_tensor(s: SystemSamples) -> float:
    tensor = s.system.homogeneous_mass_tensor
    need(tensor is not None, "the kinetic energy comes from an inertia operator")
    E = s.group.basis
    form = np.eye(s.group.size) if s.group.form is None else s.group.form  # tr(E_i J E_j*)
    return relative(s.inertia, np.einsum("iab,bc,jdc,da->ij", E, np.asarray(tensor) @ np.linalg.inv(form), E, form))


@measures(CHECKS, "inertia symmetric", "inertia_operator is symmetric", 1e-13)
def _symmetry(s: SystemSamples) -> float:
    return largest(s.inertia - s.inertia.T) / max(largest(s.inertia), np.finfo(float).tiny)


@measures(CHECKS, "inertia positive", "inertia along the constraint is positive, with a form invertible", 1e13)
def _positive(s: SystemSamples) -> float:
    """Return the condition of the inertia along the constraint, infinite if an eigenvalue is not positive.

    On a group with a form they may be negative.
    """
    need_motion(s)
    Q = np.linalg.qr(s.S.T)[0]
    eigenvalues = np.linalg.eigvalsh(Q.T @ (s.inertia + s.inertia.T) @ Q / 2)
    if s.group.form is not None:
        eigenvalues = np.sort(np.abs(eigenvalues))
    return float(eigenvalues[-1] / eigenvalues[0]) if eigenvalues[0] > 0 else np.inf


@measures(CHECKS, "constrained_inertia", "constrained_inertia = S I S^T", 1e-12)
def _constrained_inertia(s: SystemSamples) -> float:
    return relative(s.system.constrained_inertia, s.S @ s.inertia @ s.S.T)


@measures(CHECKS, "restriction", "restrict(p) = S p (in space: S coadjoint(g^-1, p))", 1e-12)
def _restriction(s: SystemSamples) -> float:
    return relative(s.system.restrict_at(s.momentum, s.g), s.restricted)


@measures(CHECKS, "restricted_velocity", "restricted_velocity inverts velocity -> momentum", 1e-11)
def _velocity(s: SystemSamples) -> float:
    need_motion(s)
    return relative(s.full_momentum(s.restricted, s.g), s.momentum)


@measures(CHECKS, "energy", "constrained_energy = kinetic energy of the admissible velocity", 1e-11)
def _kinetic_energy(s: SystemSamples) -> float:
    need_motion(s)
    return relative(s.system.constrained_energy(s.restricted, s.g), np.sum(s.momentum * s.body_velocity, axis=-1) / 2)


@measures(CHECKS, "energy of full momenta", "constrained_energy(p) = constrained_energy(p along S)", 1e-11)
def _full_energy(s: SystemSamples) -> float:
    need_motion(s)
    need(len(s.S) < s.group.dim, "nothing is forbidden: full momenta are restricted ones")
    return relative(s.system.constrained_energy(s.momentum, s.g), s.system.constrained_energy(s.restricted, s.g))


def _into_canonical(s: SystemSamples) -> np.ndarray:
    """Return the matrix of Ad of the frame; refuse where the frame is the user's own."""
    need(s.system.canonical is not s.system, "the canonical frame is the user's")
    return s.group.adjoint(np.asarray(s.system.frame))


measures(CHECKS, "frame", "residual(frame) = 0", 1e-12)(lambda s: largest(s.group.residual(np.asarray(s.system.frame))))


@measures(CHECKS, "frame and constraint", "Ad of frame^-1 maps d to the canonical d", 1e-12)
def _frame_of_subspace(s: SystemSamples) -> float:
    return largest(np.asarray(s.system.canonical.annihilator) @ np.linalg.solve(_into_canonical(s), s.S.T))


@measures(CHECKS, "frame and inertia", "canonical inertia = Ad_T^T I Ad_T", 1e-11)
def _frame_of_inertia(s: SystemSamples) -> float:
    into = _into_canonical(s)
    return relative(s.system.canonical.inertia_operator, into.T @ s.inertia @ into)


@measures(CHECKS, "frame and momenta", "frame_map takes momenta along d to canonical ones", 1e-11)
def _frame_of_momenta(s: SystemSamples) -> float:
    into = _into_canonical(s)
    return relative(s.restricted @ s.system.frame_map.T, s.system.canonical.restrict(s.momentum @ into))


@measures(CHECKS, "frame and energy", "the canonical energy is the energy", 1e-11)
def _frame_of_energy(s: SystemSamples) -> float:
    _into_canonical(s)
    energy = s.system.canonical.constrained_energy(s.restricted @ s.system.frame_map.T)  # type: ignore[attr-defined]
    return relative(energy, s.system.constrained_energy(s.restricted, s.g))


def need_motion(s: SystemSamples) -> None:
    need(len(s.S), "the constraint forbids all motion")


def check_system(
    system: AbstractSystem | AbstractCoordinateSystem,
    *,
    rng: int | np.random.Generator = 0,
    configuration: Any = None,
    tolerance_factor: float = 1.0,
    throw: bool = True,
) -> Report:
    r"""Check that group, inertia, constraint, energy and frame of a system belong together, and that it moves rightly.

    $$ \mathbb{I}_{ij} = \mathrm{tr}(E_i\,\mathbb{J}\,E_j^T), \qquad a^j|_{\mathfrak{d}} = 0, \qquad
       E = \tfrac12\langle\mathbb{I}\omega, \omega\rangle, \qquad
       \langle\dot p, x\rangle = \langle p, [\omega, x]\rangle \ (x \in \mathfrak{d}). $$

    Measured on random admissible states: symmetry and positivity of the inertia; subspace and annihilator; restriction
    of momenta and constrained energy against their definitions; the canonical frame; constraint and energy along
    `vector_field`; equilibria and their attraction; `conserved_momenta`; under forces their part in the equations and
    in the energy. The group is taken as right: `check_group` checks it. Of a `LagrangeDAlembert` or a
    `GroupLagrangeDAlembert` momentum, energy, constraint, equations and balance along its flow, against differences of
    the functions it was made of.

    Args:
        system: A system on a group, `Forced` or free, or one by functions.
        rng: A generator of the samples, or an integer that makes one.
        configuration: Where motions begin, of a system by functions; random by default.
        tolerance_factor: On every tolerance, for badly scaled units.
        throw: Raise if a check fails; otherwise only the report has it.

    Returns:
        What was measured.

    Raises:
        ValueError: `system` is not such a system.
        AssertionError: With `throw`: names every check that failed, what is required and what was measured.

    Example:
        >>> report = nh.testing.check_system(nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.5))
        >>> report["energy conserved"].status, report["attraction"].value < 0
        ('ok', True)
    """
    flags("check_system", throw=throw)
    if isinstance(system, AbstractCoordinateSystem):
        there = CoordinateSamples(system, generator("check_system(rng=...)", rng), configuration)
        return run_checks(f"check_system({there.system.name})", SYSTEM, there, tolerance_factor, throw)
    refuse_given("check_system", "be left out on a group", "Leave it out.", configuration=(configuration, None))
    kind = type(system).__name__
    if not isinstance(system, AbstractSystem):
        raise error("check_system(system=...)", "be a system", kind, "Pass an LLSystem or your own class.")
    refuse_slip("check_system(system=...)", system)
    samples = SystemSamples(system, generator("check_system(rng=...)", rng))
    return run_checks(f"check_system({kind} on {system.group!r})", CHECKS, samples, tolerance_factor, throw)


@measures(CHECKS, "equations of motion", "rate of <p, S_i> = <p, [omega, S_i]> (in space: zero) + <f - dU, S_i>", 1e-11)
def _equations(s: SystemSamples) -> float:
    """Compare with <p, [omega, S_i]>, zero along a constraint fixed in space, and forces along the directions."""
    need_motion(s)
    brackets = s.group.bracket(s.body_velocity[:, None, :], s.directions)
    exact = 0 * s.restricted if s.spatial else (brackets @ s.momentum[:, :, None])[:, :, 0]
    if s.forced is not None:
        push = s.force + s.forced.potential_force(s.g)
        exact = exact + (s.directions @ push[:, :, None])[:, :, 0]
    return largest(s.rate[0] - exact) / largest(s.momentum)


@measures(CHECKS, "reconstruction", "g' = g hat(omega)", 1e-11)
def _reconstruction(s: SystemSamples) -> float:
    return gap(s.rate[1], s.g @ s.group.hat(s.body_velocity))


@measures(CHECKS, "constraint", "the vector field keeps the constraint", 1e-11)
def _constraint(s: SystemSamples) -> float:
    back = np.linalg.inv(s.g)
    return largest(s.group.vee(s.rate[1] @ back if s.spatial else back @ s.rate[1]) @ s.A.T)


@measures(CHECKS, "energy conserved", "along the vector field the energy changes by the power of the force", 1e-8)
def _energy(s: SystemSamples) -> float:
    need_motion(s)
    power = np.sum(s.force * s.body_velocity, axis=-1)
    rate = s.along_the_motion(lambda restricted, g: s.system.constrained_energy(restricted, g) + s.potential(g))
    return largest(rate - power) / max(largest(s.system.constrained_energy(s.restricted, s.g)), largest(power))


@measures(CHECKS, "potential force", "the force of the potential is -dU", 1e-8)
def _potential_force(s: SystemSamples) -> float:
    forced: Any = s.forced
    need(forced and forced.potential is not None, "no potential")
    g, x = s.g[:, None], np.eye(s.group.dim)
    slope = derivative(lambda t: forced.potential_energy(g @ s.group.exp(t * x)))
    return relative(forced.potential_force(s.g), -slope)


@measures(CHECKS, "friction", "friction never adds energy: its largest power", 0.0)
def _friction(s: SystemSamples) -> float:
    friction: Any = s.forced and s.forced.friction
    need(friction, "no friction")
    return float(np.sum(friction.covector(s.body_velocity) * s.body_velocity, axis=-1).max())


def _equilibria(s: SystemSamples) -> tuple[Equilibria, ...]:
    """Return each linear space of equilibria."""
    need_motion(s)
    system: Any = s.system
    need(not s.spatial, "a right-invariant constraint")
    need(not s.moving.is_forced, "forces act")
    try:
        family = system.equilibria()
    except ValueError:
        raise report.NotApplicableError("the system refuses to name its equilibria") from None
    return family, *family.others


def _rate_at(s: SystemSamples, velocity: np.ndarray) -> np.ndarray:
    """Return the rate of change of body velocities, in rows of the subspace."""
    w = velocity @ np.linalg.pinv(s.S)
    brackets = s.group.bracket(velocity[:, None, :], s.S)
    inertia = s.S @ s.inertia @ s.S.T
    return np.linalg.solve(inertia, (brackets @ (w @ s.S @ s.inertia.T)[:, :, None])[:, :, 0].T).T


@measures(CHECKS, "equilibria", "equilibria are admissible and their velocities constant", 1e-11)
def _at_rest(s: SystemSamples) -> float:
    spaces = [family.subspace for family in _equilibria(s)]
    velocities = np.concatenate([*spaces, *(rows.sum(axis=0)[None] for rows in spaces)])
    return max(largest(velocities @ s.A.T), largest(_rate_at(s, velocities)))


@measures(CHECKS, "attraction", "small deviations from the attracting equilibrium decay: negative growth rate", -1e-9)
def _growth(s: SystemSamples) -> float:
    """Return the largest growth rate across the equilibria that attract, relative to the velocity."""
    attracting = [family for family in _equilibria(s) if family.attracting is not None]
    need(attracting, "no equilibrium attracts")
    return max(_growth_beside(s, family) for family in attracting)


def _growth_beside(s: SystemSamples, family: Equilibria) -> float:
    velocity = np.asarray(family.attracting)
    w = velocity @ np.linalg.pinv(s.S)
    slope = derivative(lambda t: _rate_at(s, (w + t * np.eye(len(w))) @ s.S), 0.1)
    rates = np.sort(np.linalg.eigvals(slope.T).real)
    return float(rates[len(w) - len(family.subspace) - 1] / np.linalg.norm(velocity))


@measures(CHECKS, "conserved body momenta", "conserved_momenta(...).body are constant along the vector field", 1e-8)
def _in_body(s: SystemSamples) -> float:
    return _change(s, _conserved(s).body, s.full_momentum)


@measures(CHECKS, "conserved spatial momenta", "conserved_momenta(...).spatial are constant along it", 1e-8)
def _in_space(s: SystemSamples) -> float:

    def spatial(restricted: np.ndarray, g: np.ndarray) -> np.ndarray:
        return s.group.coadjoint(s.group.inverse(g), s.full_momentum(restricted, g))

    return _change(s, _conserved(s).spatial, spatial)


def _conserved(s: SystemSamples) -> ConservedMomenta:
    need_motion(s)
    need(not s.moving.is_forced, "forces act")
    return conserved_momenta(s.system)


def _change(s: SystemSamples, rows: np.ndarray, quantity: Any) -> float:
    need(len(rows), "none is conserved")
    return largest(s.along_the_motion(quantity) @ rows.T) / (1 + largest(quantity(s.restricted, s.g)))
