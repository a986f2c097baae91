r"""The principal root by plain continuation in NumPy, for many problems at once; shares no code with the library.

Unknowns are $y = z/z_0$ of the displacements of tops and sleighs, momenta are multiplied by the time step:
$By + |y|^2c - (c\cdot y)y + (1 + |y|^2)(qy - r) = 0$ with $2q = a_1p_1 + 2ma_1^2$, zero for a top.
"""

import dataclasses

import numpy as np

import nonholo as nh

FAMILIES = ("top 3", "top 4", "top 6", "sleigh", "motion 3")
_NEWTON = 12
_JUMP = 0.1  # a root that moves further in one continuation step, relative to 1 + |y|^2, was not followed


@dataclasses.dataclass(frozen=True)
class Problems:
    """Bodies and momenta, one per row: top if mass is None, otherwise sleigh about its center of mass."""

    systems: list
    B: np.ndarray
    c: np.ndarray
    r: np.ndarray
    mass: np.ndarray | None = None
    center: np.ndarray | None = None
    p: np.ndarray | None = None

    def times(self, s: np.ndarray) -> "Problems":
        """Return the problems with momenta grown by factors."""
        p = None if self.p is None else s * self.p
        return dataclasses.replace(self, r=s[:, None] * self.r, p=p)

    def only(self, rows: np.ndarray) -> "Problems":
        """Return some of the problems."""
        arrays = {name: getattr(self, name) for name in ("B", "c", "r", "mass", "center", "p")}
        values = {name: None if x is None else x[rows] for name, x in arrays.items()}
        return Problems([self.systems[i] for i in np.flatnonzero(rows)], **values)

    @property
    def q(self) -> np.ndarray:
        """Half the shifted momentum along the blade."""
        if self.mass is None:
            return np.zeros(len(self.r))
        a = self.center[:, 0]
        return (a * self.p + 2 * self.mass * a * a) / 2

    @property
    def restricted(self) -> np.ndarray:
        """Momenta along the constraint subspace of the systems, multiplied by the time step."""
        if self.mass is None:
            return 2 * self.r
        turning = 2 * self.r + self.center[:, 1:] * self.p[:, None]
        return np.column_stack([turning if self.B.shape[1] > 1 else -turning, self.p])

    def residual(self, y: np.ndarray) -> np.ndarray:
        """Return the polynomials."""
        square, along = (y * y).sum(1)[:, None], (self.c * y).sum(1)[:, None]
        turned = (self.B @ y[..., None])[..., 0]
        return turned + square * self.c - along * y + (1 + square) * (self.q[:, None] * y - self.r)

    def slope(self, y: np.ndarray) -> np.ndarray:
        """Return their derivatives."""

        def outer(a: np.ndarray, b: np.ndarray) -> np.ndarray:
            return a[:, :, None] * b[:, None, :]

        weight = self.q * (1 + (y * y).sum(1)) - (self.c * y).sum(1)
        bent = 2 * outer(self.c, y) - outer(y, self.c) + 2 * outer(self.q[:, None] * y - self.r, y)
        return self.B + bent + weight[:, None, None] * np.eye(y.shape[1])

    def following(self, y: np.ndarray) -> "Problems":
        """Return the problems of the next step."""
        z, z0 = _on_the_sphere(y)
        even = (z * z).sum(1)[:, None] * self.c - (self.c * z).sum(1)[:, None] * z
        if self.mass is None:
            return dataclasses.replace(self, r=self.r - 2 * even)
        a = self.center[:, 0]
        pushed = self.mass * a * (z * z).sum(1)
        slide = a * (self.p + 2 * pushed) / z0
        return dataclasses.replace(self, r=self.r - 2 * even - slide[:, None] * z, p=self.p + 4 * pushed)

    def displacement(self, y: np.ndarray) -> np.ndarray:
        """Return the displacements as matrices."""
        z, z0 = _on_the_sphere(y)
        k = y.shape[1]
        if self.mass is None:
            q = np.column_stack([z, z0])
            return (np.eye(k + 1) - 2 * q[:, :, None] * q[:, None, :]) * np.append(np.ones(k), -1.0)
        q = np.column_stack([z0, -z])
        a = self.center[:, 0]
        along = (self.p + 2 * self.mass * a * (z * z).sum(1)) / (self.mass * z0)
        W = np.zeros((len(y), k + 2, k + 2))
        W[:, :-1, :-1] = (2 * q[:, :, None] * q[:, None, :] - np.eye(k + 1)) * np.append(1.0, -np.ones(k))
        W[:, :-1, -1] = (along - 2 * (self.center[:, 1:] * z).sum(1))[:, None] * q
        W[:, -1, -1] = 1.0
        return W


def _on_the_sphere(y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    z0 = 1 / np.sqrt(1 + (y * y).sum(1))
    return y * z0[:, None], z0


def random_problems(family: str, count: int, rng: np.random.Generator, degrees: float = 40.0) -> Problems:
    """Draw bodies of a few mass points, and the momenta of displacements that turn by at most so much."""
    kind, n = family.split(maxsplit=1)[0], int((family + " 2").split()[1])
    k = n - 1
    points = rng.normal(size=(count, n + 3, n))
    y = rng.normal(size=(count, k))
    y *= (np.tan(np.radians(rng.uniform(0, degrees, count)) / 2) / np.linalg.norm(y, axis=1))[:, None]
    nothing = np.zeros((count, k))
    if kind == "top":
        J = np.swapaxes(points, 1, 2) @ points / (n + 3)
        B = J[:, :k, :k] + J[:, k, k][:, None, None] * np.eye(k)
        problems = Problems([nh.SuslovTop(tensor) for tensor in J], B, J[:, :k, k], nothing)
        return _with_root(problems, y)
    mass, center = rng.uniform(0.3, 2, count), rng.normal(size=(count, n))
    points -= points.mean(1)[:, None]
    J = mass[:, None, None] * (np.swapaxes(points, 1, 2) @ points) / (n + 3)
    p = mass * rng.normal(size=count)
    if kind == "motion":
        systems = [nh.MultidimensionalSleigh(*body) for body in zip(mass, center, J, strict=True)]
        B = J[:, 1:, 1:] + J[:, 0, 0][:, None, None] * np.eye(k)
        return _with_root(Problems(systems, B, -J[:, 0, 1:], nothing, mass, center, p), y)
    inertia = np.trace(J, axis1=1, axis2=2)
    systems = [nh.ChaplyginSleigh(*body) for body in zip(mass, inertia, *center.T, strict=True)]
    return _with_root(Problems(systems, inertia[:, None, None], nothing, nothing, mass, center, p), y)


def _with_root(problems: Problems, y: np.ndarray) -> Problems:
    """Give the problems the momenta r of which y are roots."""
    weight = 1 + (y * y).sum(1)
    return dataclasses.replace(problems, r=problems.residual(y) / weight[:, None])


def newton(problems: Problems, y: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the roots next to guesses, which of them converged, and the determinants of the derivative."""
    for _ in range(_NEWTON):
        J = problems.slope(y)
        sound = np.isfinite(J).all((1, 2)) & (np.abs(np.linalg.det(np.where(np.isfinite(J), J, 0))) > 1e-300)
        J[~sound] = np.eye(y.shape[1])
        correction = np.linalg.solve(J, problems.residual(y)[..., None])[..., 0]
        correction[~sound] = np.nan
        y = y - correction
    with np.errstate(invalid="ignore"):
        return y, np.linalg.norm(correction, axis=1) < 1e-9 * (1 + (y * y).sum(1)), np.linalg.det(problems.slope(y))


def followed(problems: Problems, steps: int = 100) -> tuple[np.ndarray, np.ndarray]:
    """Return the roots that zero reaches along s r in this many equal steps, and whether they were followed surely."""
    y = before = np.zeros_like(problems.r)
    sure = np.ones(len(y), dtype=bool)
    zero = np.linalg.det(problems.times(np.zeros(len(y))).slope(y))
    for i in range(1, steps + 1):
        result, converged, det = newton(problems.times(np.full(len(y), i / steps)), 2 * y - before)
        near = np.linalg.norm(result - y, axis=1) <= _JUMP * (1 + (y * y).sum(1))
        sure &= converged & near & (det * zero > 0)
        y, before = np.where(sure[:, None], result, y), y
    return y, sure


def fold_factors(problems: Problems, largest: float = 100.0) -> np.ndarray:
    """Return by which factor the momenta reach the fold of their ray; NaN where none was found."""
    count = len(problems.r)
    y, s, size = np.zeros_like(problems.r), np.zeros(count), np.full(count, 0.02)
    zero = det = np.linalg.det(problems.times(s).slope(y))
    for _ in range(600):
        result, converged, ahead = newton(problems.times(s + size), y)
        near = np.linalg.norm(result - y, axis=1) <= _JUMP * (1 + (y * y).sum(1))
        good = converged & near & (ahead * zero > 0) & (s < largest)
        y, s, det = np.where(good[:, None], result, y), np.where(good, s + size, s), np.where(good, ahead, det)
        size = np.where(good, 1.5 * size, size / 2)
        size = np.maximum(size, 1e-11 * (s + 1e-3))
    met = (np.abs(det) < 1e-3 * np.abs(zero) * (1 + (y * y).sum(1))) & (s < largest) & (np.abs(y).max(1) < 30)
    return np.where(met, s, np.nan)
