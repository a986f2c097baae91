"""The deltoid in the plane of restricted momenta of a sleigh, inside which all three branches are real."""

import dataclasses
from typing import cast

import numpy as np

from nonholo.analysis.planar import Strip, planar_map
from nonholo.base.checks import array, error, shape_of, shown
from nonholo.base.limits import bounded_count
from nonholo.base.types import Array, Float
from nonholo.discrete import Discretization


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
    checked, variety = planar_map("deltoid(discrete=...)", discrete)
    if not variety.form.is_sleigh:
        raise error("deltoid(discrete=...)", "be of a sleigh", shown(checked.system), "Tops have no deltoid.")
    if variety.form.arm == 0:
        remedy = "A balanced sleigh has two real values if h |pi| < J, none beyond."
        raise error("deltoid(discrete=...)", "have a != 0", shown(checked.system), remedy)
    return Deltoid(checked, _restricted(checked, 3 * np.exp(2j * np.pi * np.array([0.0, 1.0, -1.0]) / 3)))


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
