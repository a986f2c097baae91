"""Whether a system fits together and moves as its equations say."""

from typing import Any

import numpy as np

from nonholo.analysis import conserved_momenta
from nonholo.base.checks import error, flags
from nonholo.systems import AbstractSystem, Equilibria
from nonholo.testing._measures import derivative, gap, largest, seeded
from nonholo.testing._report import Check, NotApplicableError, Report, need, run_checks
from nonholo.testing._system_samples import SystemSamples
from nonholo.testing._system_statics import STATICS, need_motion


def check_system(
    system: AbstractSystem, *, rng: Any = None, tolerance_factor: float = 1.0, throw: bool = True
) -> Report:
    r"""Check that group, inertia, constraint, energy and frame of a system belong together, and that it moves rightly.

    $$ \mathbb{I}_{ij} = \mathrm{tr}(E_i\,\mathbb{J}\,E_j^T), \qquad a^j|_{\mathfrak{d}} = 0, \qquad
       E = \tfrac12\langle\mathbb{I}\omega, \omega\rangle, \qquad
       \langle\dot p, x\rangle = \langle p, [\omega, x]\rangle \ (x \in \mathfrak{d}). $$

    Measured on random admissible states: symmetry and positivity of the inertia; subspace and annihilator; restriction
    of momenta and constrained energy against their definitions; the canonical frame; constraint and energy along
    `vector_field`; equilibria and their attraction; `conserved_momenta`. The group is taken as right: `check_group`
    checks it.

    Args:
        system: A system on a group.
        rng: Seed or generator of the samples; by default a fixed seed.
        tolerance_factor: On every tolerance, for badly scaled units.
        throw: Raise if a check fails; otherwise only the report says so.

    Returns:
        What was measured.

    Raises:
        ValueError: `system` is not a system on a group.
        AssertionError: With `throw`: names every check that failed, what is required and what was measured.

    Example:
        >>> report = nh.testing.check_system(nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.5))
        >>> report["energy conserved"].status, report["attraction"].value < 0
        ('ok', True)
    """
    if not isinstance(system, AbstractSystem):
        remedy = "Pass an LLSystem, another system on a group or your own class; not a system in coordinates."
        raise error("check_system(system=...)", "be a system on a group", _named(system), remedy)
    flags("check_system", throw=throw)
    samples = SystemSamples(system, seeded(rng))
    owner = f"check_system({_named(system)} on {system.group!r})"
    return run_checks(owner, (*STATICS, *MOTION), samples, tolerance_factor, throw)


def _named(thing: Any) -> str:
    return type(thing).__name__


def _equations(s: SystemSamples) -> float:
    """Compare the rate of momentum with <p, [omega, S_i]>; momenta along a constraint fixed in space are constant."""
    need_motion(s)
    brackets = s.group.bracket(s.body_velocity[:, None, :], s.directions)
    expected = 0 * s.restricted if s.spatial else (brackets @ s.momentum[:, :, None])[:, :, 0]
    return largest(s.rate[0] - expected) / largest(s.momentum)


def _reconstruction(s: SystemSamples) -> float:
    return gap(s.rate[1], s.g @ s.group.hat(s.body_velocity))


def _constraint(s: SystemSamples) -> float:
    back = np.linalg.inv(s.g)
    velocity = s.rate[1] @ back if s.spatial else back @ s.rate[1]
    return largest(s.group.vee(velocity) @ s.A.T)


def _energy(s: SystemSamples) -> float:
    need_motion(s)
    return largest(s.along_the_motion(s.energy)) / largest(s.energy(s.restricted, s.g))


def _equilibria(s: SystemSamples) -> tuple[Equilibria, ...]:
    """Return each linear space of equilibria."""
    need_motion(s)
    system: Any = s.system
    need(not s.spatial, "a right-invariant constraint")
    try:
        known = system.equilibria()
    except ValueError:
        raise NotApplicableError("the system refuses to name its equilibria") from None
    return known, *known.others


def _rate_at(s: SystemSamples, velocity: np.ndarray) -> np.ndarray:
    """Return the rate of change of body velocities, in rows of the subspace."""
    w = velocity @ np.linalg.pinv(s.S)
    brackets = s.group.bracket(velocity[:, None, :], s.S)
    inertia = s.S @ s.inertia @ s.S.T
    return np.linalg.solve(inertia, (brackets @ (w @ s.S @ s.inertia.T)[:, :, None])[:, :, 0].T).T


def _at_rest(s: SystemSamples) -> float:
    spaces = [known.subspace for known in _equilibria(s)]
    mixed = np.concatenate([*spaces, *(rows.sum(axis=0)[None] for rows in spaces)])
    forbidden = largest(mixed @ s.A.T)
    return max(forbidden, largest(_rate_at(s, mixed)))


def _growth(s: SystemSamples) -> float:
    """Return the largest growth rate across the equilibria that attract, relative to the velocity."""
    attracting = [known for known in _equilibria(s) if known.attracting is not None]
    need(attracting, "no equilibrium attracts")
    return max(_growth_beside(s, known) for known in attracting)


def _growth_beside(s: SystemSamples, known: Equilibria) -> float:
    velocity = np.asarray(known.attracting)
    w = velocity @ np.linalg.pinv(s.S)

    def nearby(t: float) -> np.ndarray:
        return _rate_at(s, (w + t * np.eye(len(w))) @ s.S)

    rates = np.sort(np.linalg.eigvals(derivative(nearby, 0.1).T).real)
    across = len(w) - len(known.subspace)
    return float(rates[across - 1] / np.linalg.norm(velocity))


def _in_body(s: SystemSamples) -> float:
    need_motion(s)
    return _change(s, conserved_momenta(s.system).body, s.full_momentum)


def _in_space(s: SystemSamples) -> float:
    need_motion(s)

    def spatial(restricted: np.ndarray, g: np.ndarray) -> np.ndarray:
        return s.group.coadjoint(s.group.inverse(g), s.full_momentum(restricted, g))

    return _change(s, conserved_momenta(s.system).spatial, spatial)


def _change(s: SystemSamples, rows: np.ndarray, quantity: Any) -> float:
    need(len(rows), "none is conserved")
    slope = s.along_the_motion(quantity) @ rows.T
    return largest(slope) / (1 + largest(quantity(s.restricted, s.g)))


MOTION = (
    Check("equations of motion", "rate of <p, S_i> = <p, [omega, S_i]> (in space: zero)", 1e-11, _equations),
    Check("reconstruction", "g' = g hat(omega)", 1e-11, _reconstruction),
    Check("constraint", "the vector field keeps the constraint", 1e-11, _constraint),
    Check("energy conserved", "the constrained energy is constant along the vector field", 1e-8, _energy),
    Check("equilibria", "equilibria are admissible and their velocities constant", 1e-11, _at_rest),
    Check("attraction", "small deviations from the attracting equilibrium decay: negative growth rate", -1e-9, _growth),
    Check("conserved body momenta", "conserved_momenta(...).body are constant along the vector field", 1e-8, _in_body),
    Check("conserved spatial momenta", "conserved_momenta(...).spatial are constant along it", 1e-8, _in_space),
)
"""In the order of the report; rates of change are central differences of order four, good to 1e-11 or so."""
