r"""The route of any constraint with difference "matrix" whose variety has no exponential chart: matrix equations.

Its body has a ball in which a root is certainly principal.

Let $\kappa$ be the coordinates of $K = (W - W^{-1})/2 \in \mathfrak{d}$ and $x = \mathbb{I}_\mathfrak{d}^{1/2}\kappa$.
The equations read $x + \phi(x) = \tilde m$ with an even $\phi$. Where $\phi$ has a Lipschitz constant $L < 1$ on
$|x| \le \rho$ and $|\tilde m| \le (1 - L)\rho$ there is exactly one root in the ball, and it is the principal one,
since this holds for every $s\tilde m$. Energy is conserved: $|\tilde m|$ is the same at every step.

Reference: docs/theory/general-step.md.
"""

import dataclasses
import functools
from typing import ClassVar

import numpy as np

from nonholo import kernels
from nonholo.base.numerics import product_and_remainder
from nonholo.base.types import Array, Float
from nonholo.discrete._scheme import Variety, forbidden_matrices, free_rows
from nonholo.discrete.routes._base import AbstractCompiledRoute, plain
from nonholo.systems import AbstractSystem, System, inertia_from_mass_tensor

_SINES = np.linspace(0.0, 1.0, 401)[1:-1]  # of the largest angle in the ball
_MARGIN = 1 - 1e-9
_BITS = 32  # of the steps between units of mass


@dataclasses.dataclass(frozen=True, eq=False)
class MatrixRoute(AbstractCompiledRoute):
    """Momenta in the body's own units, the chart of the variety, and poses as matrices."""

    system: System
    variety: Variety
    time_step: Array
    name: ClassVar[str] = "matrix"

    @functools.cached_property
    def _body_and_unit(self) -> tuple[kernels.GeneralBody, float]:
        return general_body(self.system, self.variety)

    @property
    def body(self) -> kernels.GeneralBody:
        """The matrices of the body."""
        return self._body_and_unit[0]

    @property
    def scale(self) -> Array:
        """The time step over the unit of momenta."""
        return self.time_step / self._body_and_unit[1]


def general_body(system: AbstractSystem, variety: Variety) -> tuple[kernels.GeneralBody, float]:
    """Return the body of the general kernel in its own units of length and mass, and the unit of its momenta / h."""
    group, unit = system.group, _length_unit(system)
    N, n = group.identity.shape[0], free_rows(system.group)
    shrink = np.where(np.arange(N) < n, 1 / unit, 1.0)
    motions = np.outer(shrink, 1 / shrink)
    chart = group.hat(variety.chart) * motions
    lengths = np.exp2(np.round(np.log2(np.linalg.norm(chart, axis=(1, 2)))))  # exact: the chart spans the directions
    directions = group.hat(system.constraint_subspace) * motions
    annihilator = np.zeros((0, group.dim)) if variety.exact else variety.annihilator
    forbidden = forbidden_matrices(group, annihilator) / motions
    completion = _completion(forbidden, directions)
    own_tensor = system.homogeneous_mass_tensor * np.outer(shrink, shrink)
    # a power of 2 changes no digit, and one of 2^32 no pivot for a body of ordinary mass, whose bits stay
    mass = float(np.exp2(_BITS * np.round(np.log2(np.abs(own_tensor).max(initial=1e-300)) / _BITS)))
    tensor, form, inverse_form = own_tensor / mass, np.zeros((0, 0)), np.zeros((0, 0))
    if group.form is not None:  # J G^-1 and G D_i
        form, inverse_form = group.form, np.linalg.inv(group.form)
        tensor, directions = tensor @ inverse_form, form @ directions
    spatial = system.is_spatial
    pairings, remainders = product_and_remainder(directions, tensor)
    radius, level = (0.0, 0.0) if spatial else _certain_ball(system, own_tensor, unit, mass)
    body = kernels.GeneralBody(
        tensor=plain(tensor),
        directions=plain(directions),
        places=np.ascontiguousarray(np.argwhere(chart)),  # of one layout, empty or not: compiled once
        entries=plain((chart / lengths[:, None, None])[chart != 0]),
        forbidden=plain(forbidden),
        pairings=plain(pairings),
        remainders=plain(np.concatenate([0 * remainders if spatial else remainders, completion])),
        size=n,
        spatial=spatial,
        metric=plain(np.linalg.inv(system.constrained_inertia / mass) * unit**2),
        radius=radius,
        level=level,
        unit=unit,
        stretch=plain(1 / lengths),
        form=plain(form),
        inverse_form=plain(inverse_form),
    )
    return body, mass * unit**2


def _completion(forbidden: Float[np.ndarray, "s N N"], directions: Float[np.ndarray, "k N N"]) -> np.ndarray:
    """Return what rounded annihilators lack to vanish on the directions, as they are stored, with twice the digits."""
    A, D = (x.reshape(len(x), directions.shape[1] ** 2) for x in (forbidden, directions))
    high, low = product_and_remainder(A, D.T)
    return -(np.linalg.solve(D @ D.T, (high + low).T).T @ D).reshape(forbidden.shape)


def _certain_ball(system: AbstractSystem, tensor: np.ndarray, unit: float, mass: float) -> tuple[float, float]:
    """Return the squared radius of the ball and the largest squared momentum for which it certifies.

    In the units of length and mass of the body. Zeros if there is no ball; no momentum at all on a group with a form,
    where the energy need not be definite: there every root is followed from momentum zero.
    """
    if system.group.form is not None:
        return 0.0, -np.inf
    lipschitz, least = _stiffness(system, tensor, unit)
    reach = np.where(lipschitz < 1, (1 - lipschitz) * _SINES, 0.0)
    best = int(np.argmax(reach))
    size = least / mass * _MARGIN
    return float(_SINES[best] ** 2 * size), float(reach[best] ** 2 * size)


def _length_unit(system: AbstractSystem) -> float:
    """Return the length that makes translations comparable with rotations; one for rotations alone."""
    tensor, n = np.asarray(system.homogeneous_mass_tensor), free_rows(system.group)
    if n == len(tensor) or tensor[n, n] <= 0 or np.trace(tensor[:n, :n]) <= 0:  # no length is distinguished
        return 1.0
    return float(np.sqrt(np.trace(tensor[:n, :n]) / tensor[n, n]))


def _stiffness(system: AbstractSystem, tensor: np.ndarray, unit: float) -> tuple[np.ndarray, float]:
    r"""Return the Lipschitz constants of $\phi$, by the sine of the largest angle, and the least inertia.

    $\phi(E) = \mathrm{tr}(E\,\mathbb{J}\,S^T)$ with $S = (W + W^{-1})/2 - I$; on SO(n) a multiple of the identity in
    $\mathbb{J}$ does not count.
    """
    n = free_rows(system.group)
    turning = np.any(system.group.basis[:, :n, :n], axis=(1, 2))
    rows = system.constraint_subspace * np.where(turning, 1.0, 1 / unit)
    orthonormal = np.linalg.qr(rows.T)[0].T
    inertia = orthonormal @ inertia_from_mass_tensor(system.group, tensor) @ orthonormal.T
    least = float(np.linalg.eigvalsh(inertia)[0]) if len(inertia) else 1.0
    s, c, spread = _SINES, np.sqrt(1 - _SINES**2), np.linalg.eigvalsh(tensor)
    if n == len(tensor):
        return (spread[-1] - spread[0]) / least * s / c, least
    if spread[0] < -1e-12 * spread[-1]:
        return np.full_like(s, np.inf), least
    half = s / (1 + c)
    shear = (1 + half**2) / (2 * c) * s
    return np.sqrt(spread[-1] / least) * np.sqrt(2 * (s / c) ** 2 + shear**2 + half**2), least
