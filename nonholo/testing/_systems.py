"""Whether a system fits together and moves as its equations say."""

from typing import Any

from nonholo.base.checks import error, flags
from nonholo.systems import AbstractSystem, refuse_forces
from nonholo.testing._measures import seeded
from nonholo.testing._report import Report, run_checks
from nonholo.testing._system_motion import MOTION
from nonholo.testing._system_samples import SystemSamples
from nonholo.testing._system_statics import STATICS


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
    refuse_forces("check_system(system=...)", system)
    if not isinstance(system, AbstractSystem):
        remedy = "Pass an LLSystem, another system on a group or your own class; not a system in coordinates."
        raise error("check_system(system=...)", "be a system on a group", _named(system), remedy)
    flags("check_system", throw=throw)
    samples = SystemSamples(system, seeded(rng))
    owner = f"check_system({_named(system)} on {system.group!r})"
    return run_checks(owner, (*STATICS, *MOTION), samples, tolerance_factor, throw)


def _named(thing: Any) -> str:
    return type(thing).__name__
