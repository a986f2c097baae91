r"""The principal root of any left-invariant system by plain continuation in NumPy, shares no code with the library.

For a body with tensor $J$ on SO(n) or SE(n), homogeneous there, with $X_i$ the basis of the algebra,

$$ \langle P(W), X_i\rangle = \tfrac1h \operatorname{tr}\bigl(X_i W J (W - I)^T\bigr), \qquad (W - W^{-1})/2 \in d, $$

and the step asks for the $W'$ whose $P(W')$ agrees along $d$ with $\tfrac1h\operatorname{tr}(W X_i J (W - I)^T)$.
The unknowns are all coordinates $y$ of $W_k (I + Y)(I - Y)^{-1}$ about the last $W_k$, in each prediction and each
correction: no angle is special for them. The variety is an equation here, which is singular at half-turns, where other
sheets pass. So a fold is seen by the derivative of momenta along the tangent plane of the variety, which turns
continuously along the sheet that is followed.
"""

import dataclasses
import functools

import numpy as np

_NEWTON = 10
_JUMP = 0.1  # a root that moves further in one step of the continuation was not followed
_BENT = 0.2  # nor one that misses its tangent by more of its way
_TURNED = 0.5  # nor one whose tangent plane has less of the volume of the last one above that one
_FAR = 1.0  # a correction so large leads elsewhere
_SURE = 1e-13  # a correction after which there are no more
SHARP = 1e-7  # the last correction of a root; rounding makes more of it where bodies are very uneven
_BLURRED = 1e-3  # on the way, the last correction relative to the step: more than rounding makes of it near half-turns
_REST = 1e-6  # what is left of the way to s = 1 where the tangent alone continues
_SMALLEST = 1e-11
_FOLD = 10.0  # this many of its last steps at most from a fold, where squares of determinants vanish linearly


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
        return self._paired(W @ scaled if side == "left" else scaled @ W)  # tr(W X S) = tr(X S W)

    def scale(self, W: np.ndarray) -> np.ndarray:
        """Return the sizes of what is summed in momenta."""
        size = np.abs(W) @ np.abs(self.tensor) @ np.swapaxes(np.abs(W - np.eye(W.shape[-1])), -1, -2)
        return size.max((-1, -2)) * np.abs(self.rows).max()

    def off_the_variety(self, W: np.ndarray) -> np.ndarray:
        """Return the coordinates of (W - W^-1)/2 across d."""
        return self._across((W - np.linalg.inv(W)) / 2)

    def system(self, W: np.ndarray, r: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the residuals of the equations and their derivatives by y at y = 0, where dW = 2 W dY."""
        turned, back = W[:, None] @ self.basis, np.linalg.inv(W)[:, None]
        off = np.swapaxes(W - np.eye(W.shape[-1]), -1, -2)[:, None]
        grown = 2 * (turned @ self.tensor @ off + W[:, None] @ self.tensor @ np.swapaxes(turned, -1, -2))
        slopes = np.concatenate([self._across(turned + self.basis @ back), self._paired(grown)], axis=2)
        residual = np.concatenate([self.off_the_variety(W), self.momentum(W) - r], axis=1)
        return residual, np.swapaxes(slopes, 1, 2)

    def moved(self, W: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Return W (I + Y)(I - Y)^-1."""
        Y = np.einsum("...a,aij->...ij", y, self.basis)
        return W + 2 * W @ Y @ np.linalg.inv(np.eye(W.shape[-1]) - Y)

    def _across(self, X: np.ndarray) -> np.ndarray:
        return X.reshape(*X.shape[:-2], X.shape[-1] ** 2) @ self._annihilators

    def _paired(self, S: np.ndarray) -> np.ndarray:
        return S.reshape(*S.shape[:-2], S.shape[-1] ** 2) @ self._directions

    @functools.cached_property
    def _annihilators(self) -> np.ndarray:
        return np.linalg.pinv(self.basis.reshape(len(self.basis), -1)) @ self.annihilator.T

    @functools.cached_property
    def _directions(self) -> np.ndarray:
        return np.swapaxes(self.basis, 1, 2).reshape(len(self.basis), -1).T @ self.rows.T


@dataclasses.dataclass(frozen=True)
class Path:
    """Where continuation along s r has come: the last root, s, whether a fold ended it, how far it is from one.

    `slopes` are determinants relative to those at rest: they vanish at a fold.
    """

    roots: np.ndarray
    s: np.ndarray
    folded: np.ndarray
    slopes: np.ndarray

    @property
    def whole(self) -> np.ndarray:
        """Which paths have reached s = 1."""
        return self.s >= 1.0


@dataclasses.dataclass(frozen=True)
class Tangents:
    """The velocities y of roots as momenta grow, tangent planes (M, dim, k) of the variety, determinants along them."""

    rates: np.ndarray
    planes: np.ndarray
    determinants: np.ndarray

    @classmethod
    def at(cls, equations: Equations, W: np.ndarray, r: np.ndarray) -> "Tangents":
        """Return the tangents of paths along s r."""
        slopes, k = equations.system(W, r)[1], r.shape[1]
        planes = np.linalg.qr(np.swapaxes(slopes[:, :-k], 1, 2), mode="complete")[0][:, :, -k:]
        rates, determinants = _solved(slopes[:, -k:] @ planes, r)
        return cls((planes @ rates[..., None])[..., 0], planes, determinants)

    def continues(self, before: "Tangents") -> np.ndarray:
        """Return where a plane continues with another one, and the determinants have one sign."""
        volumes = np.linalg.det(np.swapaxes(before.planes, 1, 2) @ self.planes)
        return (np.abs(volumes) > _TURNED) & (before.determinants * self.determinants * volumes > 0)

    def __getitem__(self, at: np.ndarray) -> "Tangents":
        return Tangents(self.rates[at], self.planes[at], self.determinants[at])

    def __setitem__(self, at: np.ndarray, values: "Tangents") -> None:
        for field in dataclasses.fields(self):
            getattr(self, field.name)[at] = getattr(values, field.name)


def distance(V: np.ndarray, W: np.ndarray) -> np.ndarray:
    """Return the greatest difference of entries; those of translations are relative to them beyond 1."""
    size = np.maximum(1.0, np.abs(W).max(-2, keepdims=True))
    return (np.abs(V - W) / size).max((-1, -2), initial=0.0)


def followed(equations: Equations, r: np.ndarray, rounds: int = 400) -> Path:
    """Follow the root of zero momentum along s r, each path with steps of its own, as long as its tangent foretells."""
    W, s = np.tile(np.eye(len(equations.tensor)), (len(r), 1, 1)), np.zeros(len(r))
    tangents, size, fold = Tangents.at(equations, W, r), np.full(len(r), 0.05), np.full(len(r), np.inf)
    zero, ends = tangents.determinants.copy(), np.full_like(W, np.nan)
    for _ in range(rounds):
        at = np.flatnonzero((s < 1.0) & (size > _SMALLEST))
        if not len(at):
            break
        ahead = np.minimum(s[at] + size[at], 1.0)
        step = ahead - s[at]
        guess = equations.moved(W[at], tangents.rates[at] * step[:, None])
        root, last = newton(equations, guess, ahead[:, None] * r[at])
        missed, way = distance(root, guess), distance(guess, W[at])
        new = Tangents.at(equations, root, r[at])
        blur = np.where(ahead < 1.0, _BLURRED * way, 0.0)  # the last root is sharp, or that of the tangent
        good = (last <= np.maximum(SHARP, blur)) & (missed <= _BENT * way) & (way <= _JUMP)
        good &= new.continues(tangents[at])
        on = at[good]
        fold[on] = _fold(tangents[on].determinants, new[good].determinants)
        W[on], s[on], tangents[on] = root[good], ahead[good], new[good]
        size[at] = np.where(good, 1.5 * size[at], size[at] / 2)
        end = equations.moved(W[on], tangents[on].rates * (1.0 - s[on])[:, None])
        first = np.isnan(ends[on, 0, 0]) & (distance(end, W[on]) < _REST)  # closer to a half-turn rounding has its say
        ends[on[first]] = end[first]
    folded = (s < 1.0) & (size <= _SMALLEST) & (fold < _FOLD)
    near = ~folded & (s < 1.0) & ~np.isnan(ends[:, 0, 0])
    ends, s = np.where(near[:, None, None], ends, W), np.where(near, 1.0, s)
    return Path(ends, s, folded, np.abs(tangents.determinants / zero))


def _fold(before: np.ndarray, after: np.ndarray) -> np.ndarray:
    """Return after how many more such steps the squares of determinants vanish, if they do so linearly."""
    fall = (before / after) ** 2 - 1
    return np.where(fall > 0, 1 / np.where(fall > 0, fall, 1.0), np.inf)


def _solved(slopes: np.ndarray, right: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return solutions, the right sides themselves where the determinant is 0, and the determinants."""
    determinant = np.linalg.det(slopes)
    regular = np.where((determinant == 0)[:, None, None], np.eye(slopes.shape[1]), slopes)
    return np.linalg.solve(regular, right[..., None])[..., 0], determinant


def newton(equations: Equations, W: np.ndarray, r: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return roots next to guesses, and the last corrections, infinite where they lead elsewhere."""
    sound, last = np.ones(len(W), dtype=bool), np.zeros(len(W))
    for _ in range(_NEWTON):
        correction, determinant = _solved(*equations.system(W, r)[::-1])
        nearer = equations.moved(W, -correction)
        last = distance(nearer, W)
        sound &= (determinant != 0) & (last < _FAR)  # False for NaN too
        W = np.where(sound[:, None, None], nearer, W)
        if (last[sound] < _SURE).all():
            break
    return W, np.where(sound, last, np.inf)
