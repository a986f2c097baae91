r"""The deltoid of a sleigh, inside which all three branches are real, and energies below which there is one.

The branches at scaled momenta $(\pi, \hat p)$ are the tangents of the deltoid; energy levels are ellipses. Theory:
docs/theory/chaplygin-sleigh.md.
"""

import dataclasses
from typing import Any, cast

import numpy as np

from nonholo.analysis.planar import Strip, planar_map, planar_variety
from nonholo.base.checks import array, error, shape_of, shown
from nonholo.base.limits import bounded_count
from nonholo.base.types import Array, Float
from nonholo.discrete import Discretization, refuse_composition


@dataclasses.dataclass(frozen=True, eq=False)
class Deltoid:
    r"""The discriminant curve of the discrete sleigh; momenta are restricted ones, $(p_\theta, p_1)$, physical.

    Attributes:
        discrete: The discretized sleigh.
        cusps: The lower one and the two upper ones (for a > 0), where all three branches meet; shape (3, 2).
    """

    discrete: Discretization
    cusps: Float[np.ndarray, "3 2"]

    def boundary(self, points: int = 361) -> Float[np.ndarray, "K 2"]:
        r"""Return the closed curve where two branches meet, $\varkappa = 2e^{i\alpha} + e^{-2i\alpha}$.

        Raises:
            ValueError: A number of points that is not positive.
        """
        rows = bounded_count("Deltoid.boundary(points=...)", points, 100.0, "Pass the number of points.")
        return self.touching(np.linspace(0.0, 2 * np.pi, rows))

    def touching(self, angle: Array) -> Float[np.ndarray, "... 2"]:
        r"""Return where the momenta of all displacements with a step angle, a line, touch the boundary.

        The line over the angle $\alpha$ is the tangent at $\varkappa = 2e^{i\alpha} + e^{-2i\alpha}$: the values over a
        momentum are the tangents through it.
        """
        where, remedy = "Deltoid.touching(angle=...)", "Pass step angles."
        turn = np.exp(1j * array(where, angle, (None,) * len(shape_of(angle)), remedy))
        return _restricted(self.discrete, 2 * turn + turn**-2)

    def discriminant(self, restricted_momentum: Array) -> Float[np.ndarray, "..."]:
        r"""Return $27 - 18|\varkappa|^2 + 8\,\mathrm{Re}\,\varkappa^3 - |\varkappa|^4$, positive inside."""
        trace = _trace(self.discrete, self._plane("discriminant", restricted_momentum))
        square = np.abs(trace) ** 2
        return 27 - 18 * square + 8 * np.real(trace**3) - square**2

    def real_branches(self, restricted_momentum: Array) -> np.ndarray:
        """Return the number of displacements over restricted momenta, with multiplicity: 3 inside, 1 outside."""
        where = self._plane("real_branches", restricted_momentum)
        return np.where(self.discriminant(where) >= 0, 3, 1)

    def resting(self, points: int = 361) -> Float[np.ndarray, "K 2"]:
        r"""Return the ellipse $\pi = I\sin\Delta$, $p_1 = -am(1 - \cos\Delta)$: turns without translation.

        For b = 0 these are the displacements with $V_1 = 0$ but for those of angle pi.
        """
        strip = _strip(self.discrete)
        rows = bounded_count("Deltoid.resting(points=...)", points, 100.0, "Pass the number of points.")
        m, a, angle = strip.mass, strip.arm, np.linspace(0.0, 2 * np.pi, rows)
        canonical = np.stack([(strip.inertia + m * a * a) * np.sin(angle), -a * m * (1 - np.cos(angle))], axis=-1)
        return strip.restricted_momenta(canonical) / float(self.discrete.time_step)

    def _plane(self, method: str, value: Array) -> Float[np.ndarray, "... 2"]:
        leading = (None,) * (len(shape_of(value)) - 1)
        where = f"Deltoid.{method}(restricted_momentum=...)"
        return array(where, value, (*leading, 2), "Pass the two components (p_theta, p_1).")


def deltoid(discrete: Discretization) -> Deltoid:
    r"""Return the deltoid of a sleigh: inside it the map has three real values, outside it one.

    The three step angles over a momentum are the angles of the roots U of

    $$ U^3 - \varkappa U^2 + \bar\varkappa U - 1 = 0, \qquad
       J\varkappa = -(2\hat p + J) + 2i\,h\pi, \qquad \hat p = a\,hp_1 + 2ma^2, $$

    the characteristic polynomial of a matrix of SU(3) with trace $\varkappa$ if all three are real.

    Reference: [fedorov-zenkov-2004], section 6, figure of the discriminant curve; docs/theory/chaplygin-sleigh.md.

    Args:
        discrete: A discretized sleigh with a not zero.

    Raises:
        ValueError: Another system or discretization, or a = 0 (then two values are real if h |pi| < J, none beyond).

    Example:
        >>> curve = deltoid(nh.discretize(nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=1.0), 1.0))
        >>> curve.cusps
        array([[ 0.        , -4.        ],
               [ 1.29903811, -1.75      ],
               [-1.29903811, -1.75      ]])
        >>> curve.real_branches([[0.0, -2.5], [0.0, 0.0]]).tolist()
        [3, 1]
    """
    discrete, variety = planar_map("deltoid(discrete=...)", discrete)
    if not variety.form.is_sleigh:
        raise error("deltoid(discrete=...)", "be of a sleigh", shown(discrete.system), "Tops have no deltoid.")
    if variety.form.arm == 0:
        remedy = "A balanced sleigh has two real values if h |pi| < J, none beyond."
        raise error("deltoid(discrete=...)", "have a != 0", shown(discrete.system), remedy)
    return Deltoid(discrete, _restricted(discrete, 3 * np.exp(2j * np.pi * np.array([0.0, 1.0, -1.0]) / 3)))


def _strip(discrete: Discretization) -> Strip:
    return cast(Strip, planar_map("Deltoid", discrete)[1])


def _trace(discrete: Discretization, restricted: Float[np.ndarray, "... 2"]) -> np.ndarray:
    """Return kappa of restricted momenta."""
    strip = _strip(discrete)
    pi, p1 = np.moveaxis(strip.canonical_momenta(restricted) * float(discrete.time_step), -1, 0)
    phat = strip.arm * p1 + 2 * strip.mass * strip.arm**2
    return (-(2 * phat + strip.inertia) + 2j * pi) / strip.inertia


def _restricted(discrete: Discretization, trace: np.ndarray) -> Float[np.ndarray, "... 2"]:
    """Return the restricted momenta of kappa."""
    strip = _strip(discrete)
    phat = -(np.real(trace) + 1) * strip.inertia / 2
    p1 = (phat - 2 * strip.mass * strip.arm**2) / strip.arm
    canonical = np.stack([np.imag(trace) * strip.inertia / 2, p1], axis=-1)
    return strip.restricted_momenta(canonical) / float(discrete.time_step)


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
    strip, h = _strip_and_step("single_valued_region(sleigh=...)", sleigh)
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


def _strip_and_step(where: str, discrete: Any) -> tuple[Strip, float]:
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
