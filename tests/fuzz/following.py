r"""The principal root of any left-invariant system by plain continuation in NumPy, shares no code with the library.

For a body with tensor $J$ on SO(n) or SE(n), homogeneous there, with $X_i$ the basis of the algebra,

$$ \langle P(W), X_i\rangle = \tfrac1h \operatorname{tr}\bigl(X_i W J (W - I)^T\bigr), \qquad (W - W^{-1})/2 \in d, $$

and the step asks for the $W'$ whose $P(W')$ agrees along $d$ with $\tfrac1h\operatorname{tr}(W X_i J (W - I)^T)$.
The unknowns are all coordinates $y$ of $W = (I + Y)(I - Y)^{-1}$, so that the variety is an equation here, no chart.
"""

import dataclasses

import numpy as np

_NEWTON = 10
_JUMP = 0.1  # a root that moves further in one step of the continuation, relative to 1 + |y|, was not followed
_BENT = 0.2  # nor one that misses its tangent by more of its way
_FAR = 1e8
_SMALLEST = 1e-11
_FOLD = 1e-3  # relative size of the determinant where the smallest step fails: there the square root of 1e-11 is 3e-6


@dataclasses.dataclass(frozen=True)
class Equations:
    """The equations of one body: basis (dim, N, N), tensor (N, N), rows (k, dim) that span d, and its annihilator.

    Momenta are multiplied by the time step and divided by the size of the tensor.
    """

    basis: np.ndarray
    tensor: np.ndarray
    rows: np.ndarray
    annihilator: np.ndarray

    def momentum(self, W: np.ndarray, side: str = "left") -> np.ndarray:
        """Return the momenta along d of displacements, or what they leave for the next ones."""
        scaled = self.tensor @ np.swapaxes(W - np.eye(W.shape[-1]), -1, -2)
        pushed = W @ scaled if side == "left" else scaled @ W
        return np.einsum("aij,...ji->...a", self.basis, pushed) @ self.rows.T  # tr(W X S) = tr(X S W)

    def scale(self, W: np.ndarray) -> np.ndarray:
        """Return the sizes of what is summed in momenta."""
        size = np.abs(W) @ np.abs(self.tensor) @ np.swapaxes(np.abs(W - np.eye(W.shape[-1])), -1, -2)
        return size.max((-1, -2)) * np.abs(self.rows).max()

    def off_the_variety(self, W: np.ndarray) -> np.ndarray:
        """Return the coordinates of (W - W^-1)/2 across d."""
        return self._coordinates((W - np.linalg.inv(W)) / 2) @ self.annihilator.T

    def unknowns(self, W: np.ndarray) -> np.ndarray:
        """Return the coordinates y of displacements."""
        unit = np.eye(W.shape[-1])
        return self._coordinates(np.linalg.solve(np.swapaxes(W + unit, -1, -2), np.swapaxes(W - unit, -1, -2)), True)

    def system(self, y: np.ndarray, r: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the residuals of the equations and their derivatives."""
        unit, Y = np.eye(self.tensor.shape[0]), np.einsum("...a,aij->...ij", y, self.basis)
        right, left = np.linalg.inv(unit - Y), np.linalg.inv(unit + Y)
        W, back = (unit + Y) @ right, (unit - Y) @ left
        dW = (unit + W)[:, None] @ self.basis @ right[:, None]
        variety = self._coordinates((W - back) / 2) @ self.annihilator.T
        bent = self._coordinates((dW + back[:, None] @ dW @ back[:, None]) / 2) @ self.annihilator.T
        across = self.tensor @ np.swapaxes(W - unit, -1, -2)
        turned = dW @ across[:, None] + W[:, None] @ self.tensor @ np.swapaxes(dW, -1, -2)
        slopes = np.einsum("aij,mbji->mba", self.basis, turned) @ self.rows.T
        residual = np.concatenate([variety, self.momentum(W) - r], axis=1)
        return residual, np.swapaxes(np.concatenate([bent, slopes], axis=2), 1, 2)

    def _coordinates(self, X: np.ndarray, transposed: bool = False) -> np.ndarray:
        X = np.swapaxes(X, -1, -2) if transposed else X
        flat = self.basis.reshape(len(self.basis), -1)
        return X.reshape(*X.shape[:-2], flat.shape[1]) @ np.linalg.pinv(flat)


@dataclasses.dataclass(frozen=True)
class Path:
    """Where continuation along s r has come: the last root, s, whether a fold ended it, how far it is from one.

    `slopes` are determinants relative to those at rest: they vanish at a fold.
    """

    unknowns: np.ndarray
    s: np.ndarray
    folded: np.ndarray
    slopes: np.ndarray

    @property
    def whole(self) -> np.ndarray:
        """Which paths have reached s = 1."""
        return self.s >= 1.0


def followed(equations: Equations, r: np.ndarray, rounds: int = 400) -> Path:
    """Follow the root of zero momentum along s r, each path with steps of its own, as long as its tangent foretells."""
    y, s, size = np.zeros((len(r), len(equations.basis))), np.zeros(len(r)), np.full(len(r), 0.05)
    rates, zero = _rates(equations, y, 0 * r, r)
    det = zero.copy()
    for _ in range(rounds):
        at = np.flatnonzero((s < 1.0) & (size > _SMALLEST))
        if not len(at):
            break
        ahead = np.minimum(s[at] + size[at], 1.0)
        moved = rates[at] * (ahead - s[at])[:, None]
        found, good, _ = newton(equations, y[at] + moved, ahead[:, None] * r[at])
        missed, way = np.abs(found - y[at] - moved).max(1), np.abs(moved).max(1)
        onwards, slope = _rates(equations, found, ahead[:, None] * r[at], r[at])
        good &= (missed <= _BENT * way) & (way <= _JUMP * (1 + np.abs(y[at]).max(1))) & (slope * zero[at] > 0)
        on = at[good]
        y[on], s[on], det[on], rates[on] = found[good], ahead[good], slope[good], onwards[good]
        size[at] = np.where(good, 1.5 * size[at], size[at] / 2)
    with np.errstate(invalid="ignore"):
        slopes = np.abs(det / zero)
    return Path(y, s, (s < 1.0) & (size <= _SMALLEST) & (slopes < _FOLD), slopes)


def _rates(equations: Equations, y: np.ndarray, r: np.ndarray, direction: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the velocities of roots as momenta grow, and the determinants of the derivative."""
    y = np.where((np.abs(y).max(1) < _FAR)[:, None], y, 0.0)
    slopes = equations.system(y, r)[1]
    determinant = np.linalg.det(slopes)
    slopes[determinant == 0] = np.eye(y.shape[1])
    growth = np.zeros_like(y)
    growth[:, y.shape[1] - r.shape[1] :] = direction
    return np.linalg.solve(slopes, growth[..., None])[..., 0], determinant


def newton(equations: Equations, y: np.ndarray, r: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return roots next to guesses, which of them converged, and the determinants of the derivative."""
    sound = np.ones(len(y), dtype=bool)
    for _ in range(_NEWTON):
        sound &= np.abs(y).max(1) < _FAR
        y = np.where(sound[:, None], y, 0.0)
        residual, slopes = equations.system(y, r)
        determinant = np.linalg.det(slopes)
        sound &= determinant != 0
        slopes[determinant == 0] = np.eye(y.shape[1])
        correction = np.linalg.solve(slopes, residual[..., None])[..., 0]
        y = y - correction
    return y, sound & (np.abs(correction).max(1) < 1e-9 * (1 + np.abs(y).max(1))), determinant
