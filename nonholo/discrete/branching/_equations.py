r"""The momentum equations of tops and sleighs on the sphere over their displacement variety, in units of the body.

A displacement of $\exp\mathfrak{d}$ is a pair $\pm(z_0, z)$ with $z_0^2 + z\cdot z = 1$, of a sleigh also a length
$u$; angle $\pi$ is $z_0 = 0$, and no other sheet exists here. All roots are found in `_roots`; one is followed here,
while the momentum moves along a segment.

Reference: docs/theory/branches.md, "Following a value".
"""

import dataclasses
from collections.abc import Sequence
from typing import ClassVar, cast

import numpy as np

from nonholo import kernels
from nonholo.base.checks import error
from nonholo.base.numerics import applied
from nonholo.base.results import Outcome
from nonholo.base.types import Array, Bool, Float, Inexact
from nonholo.discrete._discretization import Discretization
from nonholo.systems import NormalForm

_BALANCED = 8 * np.finfo(np.float64).eps  # coupling, relative to the inertia, that counts as zero
_RANK = 1e-13  # relative singular value below which a direction is left alone
FAR = 1e5  # times the size that target and push ask for: a root that counts as infinite
_AT_PI = 1e-75  # stands for the cosine of half the angle pi, which Cayley coordinates cannot be divided by


@dataclasses.dataclass(frozen=True, eq=False)
class Equations:
    r"""The equations $z_0 B_1z + (z\cdot z)c - (c\cdot z)z + \tfrac\alpha2 uz = r$, $uz_0 - 2\alpha z\cdot z = p$.

    Attributes:
        stiffness: Diagonal of B, with B_1 = B + alpha^2.
        coupling: c.
        target: r.
        lever: alpha; None for a top, which has no u and no p.
        push: p.
    """

    stiffness: Inexact[Array, "k"]
    coupling: Inexact[Array, "k"]
    target: Inexact[Array, "k"]
    lever: float | None = None
    push: Array = 0.0
    parameters: ClassVar[tuple[str, ...]] = ("stiffness", "coupling", "target", "push")

    @property
    def arm(self) -> float:
        """The lever, zero for a top."""
        return 0.0 if self.lever is None else self.lever

    @property
    def is_balanced(self) -> bool:
        """Whether the equations are odd: two roots only."""
        return self.arm == 0 and not np.any(self.coupling)

    @property
    def count(self) -> int:
        """Number of complex roots in general."""
        return 2 if self.is_balanced else 2 * len(self.stiffness) + (self.arm != 0)

    @property
    def most(self) -> int:
        """Number of complex roots that no momentum exceeds."""
        return self.count

    @property
    def slides(self) -> Bool[np.ndarray, "m"]:
        """Which coordinates of a point are lengths."""
        return np.arange(1 + len(self.stiffness) + (self.lever is not None)) > len(self.stiffness)

    @property
    def horizon(self) -> Float[np.ndarray, "m"]:
        """Sizes of coordinates that count as infinite, by those that target and push ask for."""
        turning = np.abs(self.target).max()
        turn, slide = np.sqrt(max(1.0, turning, abs(self.arm * self.push))), max(1.0, turning, abs(self.push))
        return FAR * np.where(self.slides, slide, turn)

    def extent(self, x: Inexact[Array, "... m"]) -> Float[np.ndarray, "... m"]:
        """Return units for the moves of a point: the sizes of its turn and of its slide, at least one."""
        sizes = [np.linalg.norm(x * part, axis=-1, keepdims=True) for part in (~self.slides, self.slides)]
        return np.maximum(1.0, np.where(self.slides, sizes[1], sizes[0]))

    def points(self, rows: Sequence[Inexact[Array, "m"]]) -> Inexact[np.ndarray, "B m"]:
        """Stack points, none as well."""
        return np.array(rows).reshape(-1, len(self.slides))

    def starts(self) -> Inexact[np.ndarray, "B m"] | None:
        """Return approximate roots; None where the secular polynomial has them."""
        return None

    def around(self) -> tuple["Equations", Inexact[np.ndarray, "B m"]]:
        """Return a generic problem and its roots, for equations without starts."""
        return self, self.points([])

    def solve(self, x: Inexact[Array, "... m"], right: Inexact[Array, "... e"]) -> Inexact[Array, "... m"]:
        """Return the shortest move from a point that changes the residual by the right-hand side, or nearly."""
        return (np.linalg.pinv(self.slope(x), rcond=_RANK) @ right[..., None])[..., 0]

    def residual(self, x: Inexact[Array, "... m"]) -> tuple[Inexact[Array, "... m"], Inexact[Array, "... m"]]:
        """Return the equations, the last one that of the sphere, and the sizes of their terms."""
        b, c, a = self.stiffness + self.arm**2, self.coupling, self.arm
        z0, z, u = _parts(self, x)
        along, square, length = (z @ c)[..., None], _square(z), _square(np.abs(z))
        rows = [z0 * b * z + square * c - along * z + a / 2 * u * z - self.target, z0 * z0 + square - 1]
        factor = np.abs(z0 * b) + np.abs(along) + np.abs(a * u)
        sizes = [factor * np.abs(z) + length * np.abs(c) + np.abs(self.target), 1 + np.abs(z0) ** 2 + length]
        if self.lever is not None:
            rows.insert(1, u * z0 - 2 * a * square - self.push)
            sizes.insert(1, np.abs(u * z0) + 2 * abs(a) * length + abs(self.push))
        return np.concatenate(rows, axis=-1), np.concatenate(sizes, axis=-1)

    def slope(self, x: Inexact[Array, "... m"]) -> Inexact[Array, "... m m"]:
        """Return the derivative of the residual."""
        b, c, a, k = self.stiffness + self.arm**2, self.coupling, self.arm, len(self.stiffness)
        z0, z, u = _parts(self, x)
        J = np.zeros((*x.shape, x.shape[-1]), dtype=np.result_type(x, c, b))
        J[..., :k, 0] = b * z
        J[..., :k, 1 : k + 1] = 2 * c[:, None] * z[..., None, :] - z[..., :, None] * c
        J[..., range(k), range(1, k + 1)] += z0 * b - (z @ c)[..., None] + a / 2 * u
        if self.lever is not None:
            J[..., :k, -1] = a / 2 * z
            J[..., k, :1], J[..., k, 1:-1], J[..., k, -1:] = u, -4 * a * z, z0
        J[..., -1, :1], J[..., -1, 1 : k + 1] = 2 * z0, 2 * z
        return J

    def kick(self, x: Inexact[Array, "m"]) -> tuple[Inexact[Array, "k"], Array]:
        """Return the change of target and push by the step after x: twice the terms that are even in z and u."""
        c, a = self.coupling, self.arm
        _, z, u = _parts(self, x)
        return 2 * ((c @ z) * z - (z @ z) * c) - a * u * z, 4 * a * (z @ z)

    def regularity(self, x: Inexact[Array, "... m"]) -> Float[np.ndarray, "..."]:
        """Return the least singular value of the derivative along the sphere, one at the identity, zero at a fold."""
        J = self.slope(x)
        along = np.swapaxes(np.linalg.svd(J[..., -1:, :])[2][..., 1:, :].conj(), -1, -2)
        inertia = np.ones(x.shape[-1] - 1)
        inertia[: len(self.stiffness)] = np.abs(self.stiffness + self.arm**2)
        return np.linalg.svd((J[..., :-1, :] @ along) / inertia[:, None], compute_uv=False)[..., -1]


def _parts(equations: Equations, x: Array) -> tuple[Array, Array, Array]:
    k = len(equations.stiffness)
    return x[..., :1], x[..., 1 : k + 1], (x[..., -1:] if equations.lever is not None else 0.0)


def _square(z: Array) -> Array:
    return (z * z).sum(axis=-1, keepdims=True)


@dataclasses.dataclass(frozen=True, eq=False)
class Frame:
    r"""The way from a body in its canonical frame to its equations.

    Attributes:
        discrete: The discretization of the body.
        axes: Columns are principal axes of B.
        stiffness: Eigenvalues of B over `inertia`.
        coupling: c in these axes over `inertia`.
        inertia: Largest eigenvalue of B_1, the unit of inertia.
        length: The unit of length; None for a top.
        lever: a_1 over `length`; None for a top.
        form: The normal form of the body.
    """

    discrete: Discretization
    axes: Float[np.ndarray, "k k"]
    stiffness: Float[np.ndarray, "k"]
    coupling: Float[np.ndarray, "k"]
    inertia: float
    length: float | None
    lever: float | None
    form: NormalForm

    @property
    def stretch(self) -> Float[np.ndarray, "N N"]:
        """Factors of the entries of W - I, for the body's unit of length."""
        shrink = np.ones(len(self.stiffness) + 1 + (self.length is not None))
        if self.length is not None:
            shrink[:-1] /= self.length
        return np.outer(shrink, 1 / shrink)

    def equations(self, momentum: Inexact[np.ndarray, "m"]) -> Equations:
        """Return the equations for canonical restricted momenta, multiplied by the time step."""
        momentum = momentum if self.form.frame_map is None else self.form.frame_map @ momentum
        if self.length is None:
            return Equations(self.stiffness, self.coupling, self.axes.T @ momentum / (2 * self.inertia))
        along = momentum[-1]
        r = self.axes.T @ (momentum[:-1] - self.form.offset * along) / (2 * self.inertia)
        return Equations(self.stiffness, self.coupling, r, self.lever, along * self.length / self.inertia)

    def momentum(self, target: Inexact[Array, "... k"], push: Array) -> Inexact[Array, "... m"]:
        """Return the momenta, multiplied by the time step, that `equations` brings to targets and pushes."""
        turning = 2 * self.inertia * applied(self.axes, target)
        if self.length is not None:
            along = np.asarray(push)[..., None] * self.inertia / self.length
            turning = np.concatenate([turning + self.form.offset * along, along], axis=-1)
        rows = self.form.frame_map
        return turning if rows is None else np.linalg.solve(rows, turning[..., None])[..., 0]

    def chart(self, x: Float[np.ndarray, "... m"]) -> Float[np.ndarray, "... k"]:
        """Return the canonical Cayley coordinates of displacements; huge at angle pi."""
        k = len(self.stiffness)
        z0 = np.where(x[..., :1] != 0, x[..., :1], _AT_PI)
        y = applied(self.axes, x[..., 1 : k + 1]) / z0
        if self.length is not None:
            nu = self.length * x[..., -1:] - 2 * applied(self.form.offset[None], y * z0)
            y = np.concatenate([y, nu / (2 * z0)], axis=-1)
        return y if self.form.frame_map is None else applied(self.form.frame_map.T, y)

    def increment(self, x: Inexact[Array, "... m"]) -> Inexact[Array, "... N N"]:
        """Return the canonical displacements minus the identity, without cancellation."""
        k = len(self.stiffness)
        z0, z = x[..., :1], applied(self.axes, x[..., 1 : k + 1])
        if self.length is None:
            q, sign = np.concatenate([z, z0], axis=-1), np.append(-np.ones(k), 1.0)
            X = 2 * (q[..., :, None] * q[..., None, :]) * sign
            X[..., -1, -1] = -2 * (z * z).sum(axis=-1)
        else:
            q, sign = np.concatenate([z0, -z], axis=-1), np.append(1.0, -np.ones(k))
            X = np.zeros((*x.shape[:-1], k + 2, k + 2), dtype=x.dtype)
            X[..., :-1, :-1] = 2 * (q[..., :, None] * q[..., None, :]) * sign
            X[..., 0, 0] = -2 * (z * z).sum(axis=-1)
            X[..., :-1, -1] = (self.length * x[..., -1:] - 2 * applied(self.form.offset[None], z)) * q
        return X if self.form.frame is None else self.form.frame @ X @ np.linalg.inv(self.form.frame)

    def point(self, W: Inexact[np.ndarray, "N N"]) -> Inexact[np.ndarray, "m"]:
        """Return the point over a canonical displacement of the variety, real or complex."""
        if self.form.frame is not None:
            W = np.linalg.inv(self.form.frame) @ W @ self.form.frame
        n = len(self.stiffness) + 1
        sign = -np.ones(n)
        sign[-1 if self.length is None else 0] = 1.0
        square = (np.eye(n) + W[:n, :n] * sign) / 2  # q q^T
        best = int(np.argmax(np.abs(np.diag(square))))
        row = square[best]
        q = row / (np.sqrt(row[best]) if np.iscomplexobj(W) else np.linalg.norm(row))
        if self.length is None:
            return np.append(q[-1], self.axes.T @ q[:-1])
        nu, z = W[:-1, -1] @ q, -q[1:]
        return np.concatenate([q[:1], self.axes.T @ z, [(nu + 2 * self.form.offset @ z) / self.length]])


def has_frame(discrete: Discretization) -> bool:
    """Return whether all branches of a discretization are known."""
    has_form = discrete.system.normal_form is not None
    return has_form and discrete.difference == "matrix" and discrete.constraint in ("skew", "exponential")


def frame_of(where: str, discrete: Discretization) -> Frame:
    """Return the frame of a system whose branches are known, or refuse it."""
    if not has_frame(discrete):
        requirement = "be a top or a sleigh with difference 'matrix'"
        name = type(discrete.system).__name__
        got = f"{name}, difference {discrete.difference!r}, constraint {discrete.constraint!r}"
        remedy = "Discretize one of them with constraint 'skew' or 'exponential'; of others only the principal "
        raise error(where, requirement, got, remedy + "branch is computed (`step`, `simulate`).")
    form = cast(NormalForm, discrete.system.normal_form)
    eigenvalues, axes = np.linalg.eigh(form.stiffness_matrix)
    unit = float(eigenvalues[-1] + (form.mass * form.arm**2 if form.is_sleigh else 0.0))
    length = float(np.sqrt(unit / form.mass)) if form.is_sleigh else None
    coupling = axes.T @ form.coupling / unit
    if np.linalg.norm(coupling) <= _BALANCED:
        coupling = np.zeros_like(coupling)
    lever = None if length is None else float(form.arm / length)
    return Frame(discrete, axes, eigenvalues / unit, coupling, unit, length, lever, form)


_LONGEST = 0.1  # a predicted move per continuation step, on the sphere
_CLOSE = 0.1  # part of the predicted move that the corrector may add
_SMALL = 1e-3  # a corrector's move that is always accepted where the predicted one is smaller
_CORRECTIONS = 6  # of Newton's method
_CONVERGED = 1e-11  # a correction after which the next one is below rounding
_SHORTEST = 1e-10  # change of target and push below which the root is given up
_PROGRESS = 8 * np.finfo(np.float64).eps  # of a place on the segment, below which steps may be lost by rounding
_FOLD = 1e-2  # regularity below which a root that cannot be followed has met a fold
_SINGULAR = 1e-8  # regularity of a root that cannot be followed at all
_CLEAR = 10.0  # times that, for a bound of it that rounding has moved
_TRANSVERSAL = 1e-6  # part of the momentum's motion across a fold below which the singular point is no fold


def follow(start: Equations, end: Equations, x: Float[np.ndarray, "m"]) -> tuple[Outcome, Float[np.ndarray, "m"]]:
    """Follow a real root of the first equations to the second ones, which differ in target and push alone.

    Returns:
        The outcome, and the root or the last point that was reached.
    """
    if start.regularity(x) < _SINGULAR:
        return Outcome.branch_unverified, x
    push = [] if start.lever is None else [end.push - start.push]
    direction = np.array([*(end.target - start.target), *push, 0.0])  # of the right-hand sides
    slope, shortest = start.slope(x), _SHORTEST / max(1.0, float(np.linalg.norm(direction)))
    side, s, size = np.sign(np.linalg.det(slope)), 0.0, 1.0
    while s < 1.0:
        tangent = np.linalg.solve(slope, direction)
        pace = _length(tangent, x)
        size = min(size, 1.0 - s, _LONGEST / pace if pace > 0 else 1.0)
        ahead = 1.0 if size == 1.0 - s else s + size
        next_point = _correct(_between(start, end, ahead), x + size * tangent, size * pace)
        if next_point is not None and np.sign(np.linalg.det(end.slope(next_point))) == side:
            x, s, size, slope = next_point, ahead, 2 * size, end.slope(next_point)
        elif size > max(shortest, _PROGRESS * s):
            size /= 4
        else:
            return _why_it_ended(_between(start, end, s), direction, x), x
    return Outcome.successful, x


def nearest_body(equations: Equations) -> kernels.NearestBody:
    """Return what a kernel follows the roots of equations by, for every target and push."""
    slides, inertia = equations.lever is not None, equations.stiffness + equations.arm**2
    how = (_LONGEST, _CLOSE, _SMALL, _CORRECTIONS, _CONVERGED, _SHORTEST, _CLEAR * _SINGULAR)
    return kernels.NearestBody(inertia, equations.coupling, equations.arm, slides, *how)


def _between(start: Equations, end: Equations, s: float) -> Equations:
    if s == 1.0:
        return end
    target, push = start.target + s * (end.target - start.target), start.push + s * (end.push - start.push)
    return dataclasses.replace(start, target=target, push=push)


def _length(move: np.ndarray, x: np.ndarray) -> float:
    """Return the size of a move, of the length u relative to u where that is large."""
    return float(np.linalg.norm(move / np.maximum(1.0, np.abs(x))))


def _correct(equations: Equations, guess: np.ndarray, reach: float) -> Float[np.ndarray, "m"] | None:
    """Return the root next to a guess by Newton's method; None if it is further away than the prediction allows."""
    x, limit = guess, max(_CLOSE * reach, min(_SMALL, reach))
    for _ in range(_CORRECTIONS):
        try:
            correction = np.linalg.solve(equations.slope(x), equations.residual(x)[0])
        except np.linalg.LinAlgError:
            return None
        x = x - correction
        if not _length(x - guess, guess) <= limit + _CONVERGED:
            return None
        if _length(correction, x) <= _CONVERGED:
            return x
    return None


def _why_it_ended(equations: Equations, direction: np.ndarray, x: np.ndarray) -> Outcome:
    """Distinguish a fold, another singular point, a root that goes to infinity, and a failure to converge."""
    if not np.all(np.isfinite(x)):
        return Outcome.nonfinite
    if np.any(np.abs(x) > equations.horizon):
        return Outcome.branch_unverified
    if equations.regularity(x) > _FOLD:
        return Outcome.not_converged
    left = np.linalg.svd(equations.slope(x))[0][:, -1]
    across = abs(left @ direction) > _TRANSVERSAL * np.linalg.norm(direction)
    return Outcome.no_real_branch if across else Outcome.branch_unverified
