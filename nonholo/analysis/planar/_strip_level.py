r"""Energy levels on the Moebius band of displacements of a sleigh, in the coordinates $(\Delta, \nu)$.

In the canonical frame $h\pi = I\sin\Delta + am\nu\sin\tfrac\Delta2$ and $hp_1 = m\nu\cos\tfrac\Delta2 - 2amx$, with
$x = \sin^2\tfrac\Delta2$. In $2Eh^2 = (h\pi)^2/I + (hp_1)^2/m$ the terms linear in $\nu$ cancel:

$$ 2Eh^2 = \bigl(1 - \tfrac JIx\bigr)\,(m\nu^2 + 4Ix). $$
"""

import dataclasses

import numpy as np

from nonholo.analysis.planar._level_arcs import FOLD, Arc
from nonholo.base.types import Float

_NEAR_HALF_TURN = 0.04  # balanced sleighs: the level goes to infinity at the angle pi; it is cut so far from there


@dataclasses.dataclass(frozen=True, eq=False)
class StripLevel:
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
        folds = [float(2 * np.arcsin(np.sqrt(x))) for x in self._turning()]
        if self.whole == self.inertia:
            return self._balanced(folds, count)
        if not folds:  # the two solutions are one curve, which closes after two turns
            return (self._points(1, np.linspace(-np.pi, 3 * np.pi, 2 * count)),)
        around = [(-folds[0], folds[0])] + [(last, 2 * np.pi - last) for last in folds[1:]]
        return tuple(self._oval(start, stop, count) for start, stop in around)

    def _balanced(self, folds: list[float], count: int) -> tuple[Float[np.ndarray, "K 2"], ...]:
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

    def _turning(self) -> list[float]:
        """Return the x up to 1 where the translation is zero, 4 x (I - J x) = 2 E h^2, ascending."""
        under = self.whole**2 - self.inertia * self.e
        if under < 0:
            return []
        larger = self.whole + np.sqrt(under)
        return [x for x in (self.e / (2 * larger), larger / (2 * self.inertia)) if x < 1]

    def _square(self, angle: np.ndarray) -> np.ndarray:
        x = np.sin(angle / 2) ** 2
        return self.whole * (self.e / (self.whole - self.inertia * x) - 4 * x) / self.mass

    def _points(self, sign: int, angle: np.ndarray) -> Float[np.ndarray, "K 2"]:
        return np.stack([angle, sign * np.sqrt(np.maximum(self._square(angle), 0.0))], axis=-1)
