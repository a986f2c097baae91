r"""Up to which energies the discrete Chaplygin sleigh has exactly one real branch, and a principal one everywhere.

The branches at scaled momenta $(\pi, \hat p)$ are the tangents of a deltoid; energy levels are ellipses. Theory:
docs/theory/chaplygin-sleigh.md.
"""

import dataclasses
from typing import Any

import numpy as np

from nonholo.analysis.planar import Strip, planar_variety
from nonholo.base.checks import error, shown
from nonholo.base.types import Float
from nonholo.discrete import Discretization, refuse_composition


@dataclasses.dataclass(frozen=True, eq=False)
class SingleValuedRegion:
    """The region in which the discrete sleigh has one real branch, and where its branches merge.

    Attributes:
        energy: The sharp bound: below it every momentum has exactly one real branch, and at it one has more.
        principal_energy: The larger bound below which every momentum has a principal value, though others may be real:
            no orbit on the principal branch ends. Above it a part of the energy level has none.
        bound_of_the_paper: The bound printed in the paper, between 3.79 and 4 times smaller.
        contact: Momenta (p_theta, p_1) at the sharp bound where real branches merge, shape (j, 2).
        cusps: Momenta (p_theta, p_1) of the three cusps of the deltoid, where all three branches merge, shape (3, 2).
    """

    energy: float
    principal_energy: float
    bound_of_the_paper: float
    contact: Float[np.ndarray, "j 2"]
    cusps: Float[np.ndarray, "3 2"]


def single_valued_region(sleigh: Discretization) -> SingleValuedRegion:
    r"""Return the energy below which the discrete sleigh is single-valued.

    With $M = ma^2$ and $I = J + M$

    $$ E^* = \frac{1}{2Mh^2}\,\min\Bigl\{4M^2,\ \bigl(\tfrac J4 - 2M\bigr)^2 + \frac{27MJ^2}{16\,I}\Bigr\}, \qquad
       E_\mathrm{paper} = \frac{M}{2h^2} . $$

    The principal branch ends only on two of the three sides of the deltoid. The least energy on them is

    $$ E^\dagger = \frac{1}{2Mh^2}\Bigl[\bigl(\tfrac J4 - 2M\bigr)^2 + \frac{27MJ^2}{16\,I}\Bigr] \ (J \le 2M), \qquad
       E^\dagger = \frac{I^2}{2Jh^2} \ (J \ge 2M). $$

    On $E < E^*$ the momentum $\pi = p_\theta + bp_1$ keeps its sign and $ap_1$ grows: the orbit runs from one straight
    motion to the opposite one.

    Reference: [fedorov-zenkov-2004], the theorem of section 7, which is not sharp.

    Args:
        sleigh: A discretized `ChaplyginSleigh`, difference "matrix", constraint "skew" or "exponential".

    Raises:
        ValueError: Another system or discretization, or a = 0 (then two branches are real however small the energy).

    Example:
        >>> region = single_valued_region(nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1))
        >>> print(f"{region.energy:.10f} {region.principal_energy:.10f} {region.bound_of_the_paper:.10f}")
        50.0000000000 78.1250000000 12.5000000000
    """
    strip, h = _checked("single_valued_region(sleigh=...)", sleigh)
    J, M = strip.inertia, strip.mass * strip.arm**2
    cusp_at = 3 * np.sqrt(3) / 4 * J, J / 4
    cusps = np.array([[0.0, -2 * J], [-cusp_at[0], cusp_at[1]], cusp_at])
    ratio = J / M  # the two entries divided by 4 M^2; Python numbers do not overflow where a tends to zero
    at_cusp = (ratio / 8 - 1) ** 2 + 27 * ratio * (ratio / (1 + ratio)) / 64
    touching = [[0.0, 0.0]] if at_cusp > 1 else cusps[1:] if at_cusp < 1 else [[0.0, 0.0], *cusps[1:]]
    return SingleValuedRegion(
        energy=float(2 * M / h**2 * min(1.0, at_cusp)),
        principal_energy=float(2 * M / h**2 * at_cusp if ratio <= 2 else (J + M) ** 2 / (2 * J * h**2)),
        bound_of_the_paper=float(M / (2 * h**2)),
        contact=_momenta(np.array(touching), M, strip, h),
        cusps=_momenta(cusps, M, strip, h),
    )


def _checked(where: str, discrete: Any) -> tuple[Strip, float]:
    remedy = "Pass `discretize(ChaplyginSleigh(...), time_step)`."
    variety = planar_variety(discrete.system) if isinstance(discrete, Discretization) else None
    if not isinstance(variety, Strip):
        raise error(where, "be a discretized Chaplygin sleigh", shown(discrete), remedy)
    refuse_composition(where, discrete, "Pass the discretization of order 2 that is composed.")
    if not discrete.conserves_energy:
        got = f"difference={discrete.difference!r}, constraint={discrete.constraint!r}"
        raise error(where, "be the map with three branches", got, "Use the defaults of `discretize`.")
    if variety.arm == 0:
        remedy = "A balanced sleigh has two real branches, with angles D and pi - D, at every |p_theta + b p_1| < J/h."
        raise error(where, "have its center of mass off the blade's normal", "a = 0", remedy)
    return variety, float(discrete.time_step)


def _momenta(plane: Float[np.ndarray, "j 2"], M: float, strip: Strip, h: float) -> Float[np.ndarray, "j 2"]:
    r"""Return restricted momenta of scaled points $(\pi, \hat p)$, $\hat p = ap_1 + 2M$."""
    p1 = (plane[:, 1] - 2 * M) / strip.arm
    return strip.restricted_momenta(np.stack([plane[:, 0], p1], axis=1)) / h
