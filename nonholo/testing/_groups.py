"""Whether a group is one, and does what systems and discretizations expect of it."""

from typing import Any

from nonholo.base.checks import error, flags
from nonholo.groups import AbstractMatrixGroup
from nonholo.testing._group_algebra import ALGEBRA
from nonholo.testing._group_maps import COMPILED, MAPS
from nonholo.testing._group_samples import GroupSamples
from nonholo.testing._measures import seeded
from nonholo.testing._report import Report, run_checks


def check_group(
    group: AbstractMatrixGroup,
    *,
    rng: Any = None,
    compiled: bool = True,
    tolerance_factor: float = 1.0,
    throw: bool = True,
) -> Report:
    r"""Check that a group is a group of matrices whose functions agree with their definitions.

    Samples are built from the basis by `scipy.linalg.expm`, and the conventions are those of docs/conventions.md:

    $$ \mathrm{hat}(x) = \sum x_i E_i, \qquad \mathrm{Ad}_g x = g\,x\,g^{-1}, \qquad
       \langle\mathrm{Ad}^*_g p, x\rangle = \langle p, \mathrm{Ad}_g x\rangle. $$

    Measured are: sizes, basis and brackets; `exp`, `log` (small, moderate and near angle pi), `cayley`, `retract` and
    `dexp_inverse`; conjugation and its transpose; `random` and `residual`; compact poses; leading axes; agreement of
    NumPy and JAX.

    Args:
        group: Your group.
        rng: Seed or generator of the samples; by default a fixed seed.
        compiled: Also compare with compiled JAX functions, which takes seconds.
        tolerance_factor: On every tolerance, for a basis of badly scaled matrices.
        throw: Raise if a check fails; otherwise only the report says so.

    Returns:
        What was measured.

    Raises:
        ValueError: `group` is not a group.
        AssertionError: With `throw`: names every check that failed, what is required and what was measured.

    Example:
        >>> nh.testing.check_group(nh.ProductGroup(nh.SE(2), nh.Translations(1))).passed
        True
    """
    if not isinstance(group, AbstractMatrixGroup):
        remedy = "Pass SO(n), a MatrixGroup or your own class that implements AbstractMatrixGroup."
        raise error("check_group(group=...)", "be a group", type(group).__name__, remedy)
    flags("check_group", compiled=compiled, throw=throw)
    samples = GroupSamples(group, seeded(rng))
    checks = (*ALGEBRA, *MAPS, *((COMPILED,) if compiled else ()))
    return run_checks(f"check_group({group!r})", checks, samples, tolerance_factor, throw)
