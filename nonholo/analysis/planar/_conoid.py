r"""The momentum locus of the sleigh: Pluecker's conoid, a cubic surface ruled by lines that meet one axis.

With scaled momenta $hP$ in the canonical frame, $X = ap_1 + 2ma^2$, $Y = ap_2$, $Z = \pi - ap_2$ (balanced: $X = p_1$,
$Y = p_2$, $Z = \pi$), and the step angle $\Delta$,

$$ X : Y = \cos\tfrac\Delta2 : \sin\tfrac\Delta2, \qquad Z = J\sin\Delta, \qquad Z(X^2 + Y^2) = 2JXY. $$
"""

import dataclasses

import numpy as np

from nonholo.base.types import Float
from nonholo.groups import SE


@dataclasses.dataclass(frozen=True, eq=False)
class Conoid:
    """The coordinates X, Y, Z in units of J, as an affine function of momenta in the user's frame.

    Attributes:
        matrix: Its linear part.
        offset: Its value at momentum zero.
    """

    matrix: Float[np.ndarray, "3 3"]
    offset: Float[np.ndarray, "3"]

    def implicit(self, momentum: Float[np.ndarray, "... 3"]) -> Float[np.ndarray, "..."]:
        """Return the cubic polynomial."""
        X, Y, Z = np.moveaxis(momentum @ self.matrix.T + self.offset, -1, 0)
        return Z * (X * X + Y * Y) - 2 * X * Y

    def double_lines(self) -> Float[np.ndarray, "1 2 3"]:
        """Return the ends Z = -J and Z = J of the part of the axis that the rulings meet."""
        ends = np.array([[0.0, 0.0, -1.0], [0.0, 0.0, 1.0]]) - self.offset
        return np.linalg.solve(self.matrix, ends.T).T[None]

    def triple_point(self) -> None:
        """Return None: the rulings meet one axis."""


def conoid(mass: float, inertia: float, a: float, frame: Float[np.ndarray, "3 3"], time_step: float) -> Conoid:
    """Return the conoid of a sleigh."""
    m, J = mass, inertia
    arm = a or np.sqrt(J / m)  # a length for the balanced sleigh, where any serves
    rows = np.array([[0.0, arm, 0.0], [0.0, 0.0, arm], [1.0, 0.0, -a]])
    to_canonical = SE(2).coadjoint(frame, np.eye(3)).T
    return Conoid(rows @ to_canonical * (time_step / J), np.array([2 * m * a * a / J, 0.0, 0.0]))
