r"""Displacements of a sleigh in the plane as a strip: $(\Delta, \nu)$, the step angle and the translation along it.

The translation is that along the direction $\Delta/2$, and $(\Delta, \nu) \sim (\Delta + 2\pi, -\nu)$: a Moebius band.

Energy levels on the Moebius band of displacements of a sleigh, in the coordinates $(\Delta, \nu)$.

In the canonical frame $h\pi = I\sin\Delta + am\nu\sin\tfrac\Delta2$ and $hp_1 = m\nu\cos\tfrac\Delta2 - 2amx$, with
$x = \sin^2\tfrac\Delta2$. In $2Eh^2 = (h\pi)^2/I + (hp_1)^2/m$ the terms linear in $\nu$ cancel:

$$ 2Eh^2 = \bigl(1 - \tfrac JIx\bigr)\,(m\nu^2 + 4Ix). $$

The momentum locus of the sleigh: Pluecker's conoid, a cubic surface ruled by lines that meet one axis.

With scaled momenta $hP$ in the canonical frame, $X = ap_1 + 2ma^2$, $Y = ap_2$, $Z = \pi - ap_2$ (balanced: $X = p_1$,
$Y = p_2$, $Z = \pi$), and the step angle $\Delta$,

$$ X : Y = \cos\tfrac\Delta2 : \sin\tfrac\Delta2, \qquad Z = J\sin\Delta, \qquad Z(X^2 + Y^2) = 2JXY. $$
"""

from typing import NamedTuple

import numpy as np

from nonholo.analysis.planar._base import FOLD, Arc, HalfPlanes, PlanarBody
from nonholo.base.types import Array, Float
from nonholo.groups import SE


class Conoid(NamedTuple):
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


_NEAR_HALF_TURN = 0.04  # balanced sleighs: the level goes to infinity at the angle pi; it is cut so far from there


class StripLevel(NamedTuple):
    """The level 2 E h^2 of a sleigh; `whole` is I = J + m a^2."""

    mass: float
    inertia: float
    whole: float
    e: float

    def over(self, direction: float) -> Float[np.ndarray, "m 2"]:
        """Return the points over an angle."""
        angle = np.array([direction])
        if self._square(angle)[0] < 0:
            return np.empty((0, 2))
        return np.concatenate([self._points(sign, angle) for sign in (-1, 1)])

    def components(self, count: int) -> tuple[Float[np.ndarray, "K 2"], ...]:
        """Return the connected curves; those of a balanced sleigh that go to infinity are cut."""
        # the translation is zero where 4 x (I - J x) = 2 E h^2
        under, folds = self.whole**2 - self.inertia * self.e, []
        if under >= 0:
            larger = self.whole + np.sqrt(under)
            turning = self.e / (2 * larger), larger / (2 * self.inertia)
            folds = [float(2 * np.arcsin(np.sqrt(x))) for x in turning if x < 1]
        if self.whole == self.inertia:
            return self._balanced_components(folds, count)
        if not folds:  # the two solutions are one curve, which closes after two turns
            return (self._points(1, np.linspace(-np.pi, 3 * np.pi, 2 * count)),)
        around = [(-folds[0], folds[0])] + [(last, 2 * np.pi - last) for last in folds[1:]]
        return tuple(self._oval(start, stop, count) for start, stop in around)

    def _balanced_components(self, folds: list[float], count: int) -> tuple[Float[np.ndarray, "K 2"], ...]:
        end = np.pi - _NEAR_HALF_TURN
        if not folds:
            return tuple(self._points(sign, np.linspace(-end, end, count)) for sign in (1, -1))
        inner = self._oval(-folds[0], folds[0], count)
        if folds[1] >= end:
            return (inner,)
        angle = folds[1] + (end - folds[1]) * np.linspace(0.0, 1.0, count) ** 2  # denser at the fold
        outer = np.concatenate([self._points(1, angle[::-1]), self._points(-1, angle[1:])])
        return inner, outer, outer * np.array([-1.0, 1.0])

    def _oval(self, start: float, stop: float, count: int) -> Float[np.ndarray, "K 2"]:
        angle = Arc(1, start, stop, (FOLD, FOLD)).directions(count)
        oval = np.concatenate([self._points(1, angle), self._points(-1, angle[-2::-1])])
        oval[-1] = oval[0]
        return oval

    def _square(self, angle: np.ndarray) -> np.ndarray:
        x = np.sin(angle / 2) ** 2
        return self.whole * (self.e / (self.whole - self.inertia * x) - 4 * x) / self.mass

    def _points(self, sign: int, angle: np.ndarray) -> Float[np.ndarray, "K 2"]:
        return np.stack([angle, sign * np.sqrt(np.maximum(self._square(angle), 0.0))], axis=-1)


_BACK = np.array([-1.0, 1.0])  # the plane e_1^e_2 turns against the angle


class Strip(PlanarBody):
    """The displacements of a sleigh, by coordinates that cover all of them, the angle pi included."""

    @property
    def inertia(self) -> float:
        """J, about the center of mass."""
        return float(self.form.stiffness[0, 0])

    @property
    def mass(self) -> float:
        """The mass m."""
        return float(self.form.mass)

    @property
    def arm(self) -> float:
        """The coordinate a of the center of mass along the blade."""
        return float(self.form.arm)

    @property
    def across(self) -> float:
        """The coordinate of the origin of body coordinates across the blade."""
        return float((SE(2).inverse(self.frame) @ [0.0, 0.0, 1.0])[1])

    @property
    def blade(self) -> Float[np.ndarray, "3 3"]:
        """The axes of the blade at its contact point, the first along it, as seen from the user's frame."""
        shift = np.eye(3)
        shift[1, 2] = self.across
        return self.frame @ shift

    def displacement(self, points: Float[np.ndarray, "... 2"]) -> Float[np.ndarray, "... 3 3"]:
        """Return the motions with these angles and translations."""
        angle, along = np.moveaxis(points, -1, 0)
        zero, one = np.zeros_like(angle), np.ones_like(angle)
        c, s = np.cos(angle), np.sin(angle)
        rows = ((c, -s, along * np.cos(angle / 2)), (s, c, along * np.sin(angle / 2)), (zero, zero, one))
        return self.frame @ np.stack([np.stack(row, axis=-1) for row in rows], axis=-2) @ SE(2).inverse(self.frame)

    def points(self, displacement: Float[np.ndarray, "... 3 3"]) -> Float[np.ndarray, "... 2"]:
        """Return angles between -pi and pi and translations."""
        W = SE(2).inverse(self.frame) @ displacement @ self.frame
        angle = np.arctan2(W[..., 1, 0], W[..., 0, 0])
        along = W[..., 0, 2] * np.cos(angle / 2) + W[..., 1, 2] * np.sin(angle / 2)
        return np.stack([angle, along], axis=-1)

    def canonical_momenta(self, restricted: Float[np.ndarray, "... 2"]) -> Float[np.ndarray, "... 2"]:
        r"""Return $(\pi, p_1)$ of momenta along the user's rows."""
        return _BACK * (restricted @ self.to_rows.T)

    def restricted_momenta(self, canonical: Float[np.ndarray, "... 2"]) -> Float[np.ndarray, "... 2"]:
        r"""Return momenta along the user's rows from $(\pi, p_1)$."""
        return np.linalg.solve(self.to_rows, (_BACK * canonical)[..., None])[..., 0] + 0.0

    def mesh(self, rows: int) -> tuple[Float[np.ndarray, "R C 2"], Float[np.ndarray, "R C 2"]]:
        """Return angles and translations of pieces of the rulings whose middles are on the axis, twice."""
        m, J, a = self.mass, self.inertia, self.arm
        reach = (2 * J + 2 * m * a * a) / (m * abs(a)) if a else 2 * np.sqrt(J / m)
        along, angle = np.meshgrid(np.linspace(-1, 1, rows), np.linspace(-np.pi, np.pi, 2 * rows + 1), indexing="ij")
        points = np.stack([angle, reach * along - 2 * a * np.cos(angle / 2)], axis=-1)
        return points, points

    def area_factor(self, points: Float[np.ndarray, "... 2"]) -> tuple[Float[Array, "..."], Float[Array, "..."]]:
        r"""Return $f = \cos\tfrac\Delta2\,(J\cos\Delta + ma^2) + \tfrac12 am\nu$, over m, in $\Delta$ and $\nu/2$."""
        angle, along, lever = points[..., 0], points[..., 1], self.mass * self.arm
        return np.cos(angle / 2) * (self.inertia * np.cos(angle) + lever * self.arm), lever * along / 2

    def sides(self, points: Float[np.ndarray, "... 2"]) -> tuple[HalfPlanes, Float[Array, "..."]]:
        r"""Return $(s, Q) = (\sin\tfrac\Delta2, am\nu)$ and the weight $\Lambda = 2I\cos\tfrac\Delta2$.

        The side of the momentum is $s\,(\Lambda + Q)$ before the step and $s\,(\Lambda - Q)$ after it.
        """
        angle, along, lever = points[..., 0], points[..., 1], self.arm * self.mass
        whole = self.inertia + lever * self.arm
        return HalfPlanes(np.sin(angle / 2), lever * along), 2 * whole * np.cos(angle / 2)

    def sides_of_momenta(self, restricted: Float[np.ndarray, "... 2"]) -> HalfPlanes:
        r"""Return $(\pi, a p_1)$."""
        canonical = self.canonical_momenta(restricted)
        return HalfPlanes(canonical[..., 0], self.arm * canonical[..., 1])

    def level(self, energy: float) -> StripLevel:
        """Return the level over the angles."""
        return StripLevel(self.mass, self.inertia, self.inertia + self.mass * self.arm**2, 2 * energy)

    def surface(self, time_step: float) -> Conoid:
        """Return Pluecker's conoid."""
        m, J, a = self.mass, self.inertia, self.arm
        arm = a or np.sqrt(J / m)  # a length for the balanced sleigh, where any serves
        rows = np.array([[0.0, arm, 0.0], [0.0, 0.0, arm], [1.0, 0.0, -a]])
        to_canonical = SE(2).coadjoint(self.frame, np.eye(3)).T
        return Conoid(rows @ to_canonical * (time_step / J), np.array([2 * m * a * a / J, 0.0, 0.0]))
