r"""Decoders of displacements: rows of canonical chart coordinates as what a user reads, in the user's frame.

A row has the same bits alone and among others. `DisplacementDecoder` is for any left-invariant constraint, by NumPy;
`ClosedDisplacementDecoder` for the difference "matrix" where a Cayley image with two coordinates on SO(3) or SE(2) is
all of the variety, compiled. With $F(W) = P(W)|_\mathfrak{d}$ a step takes $r = F(W)$ to $r' = -F(W^{-1})$.
"""

import dataclasses

import numpy as np

from nonholo.base.numerics import applied
from nonholo.base.types import Float
from nonholo.discrete._scheme import Scheme, legendre, matrix_legendre
from nonholo.kernels import decoding

Charts = Float[np.ndarray, "K m"]


@dataclasses.dataclass(frozen=True, eq=False)
class DisplacementDecoder:
    """Columns that are read from the displacements of single steps of any left-invariant map."""

    discrete: Scheme

    def momentum(self, charts: Float[np.ndarray, "K m"], side: str) -> Float[np.ndarray, "K dim"]:
        """Return the momenta that set out (side "left") or arrive ("right")."""
        discrete, system, X = self.discrete, self.discrete.system, self.discrete.variety.increment(charts)
        group, canonical = system.group, system.canonical
        if discrete.difference == "matrix":
            reduced = matrix_legendre(group, canonical.homogeneous_mass_tensor, X, side) / discrete.time_step
            return reduced if canonical is system else group.coadjoint(group.inverse(system.frame), reduced)
        return legendre(discrete, system.from_canonical_frame(X), side)

    def displacement(self, charts: Float[np.ndarray, "... m"]) -> Float[np.ndarray, "... N N"]:
        """Return the displacements as matrices."""
        return self.discrete.system.from_canonical_frame(self.discrete.variety.displaced(charts))

    def multipliers(self, charts: Charts, following: Charts) -> Float[np.ndarray, "K s"]:
        """Return the impulses between displacements and those that follow."""
        jump = self.momentum(following, "left") - self.momentum(charts, "right")
        return applied(np.linalg.pinv(self.discrete.system.annihilator).T, jump)

    def tangent(self, charts: Float[np.ndarray, "K m"]) -> Float[np.ndarray, "K k k"]:
        """Return the derivatives of restricted momenta after a step by those before it, for the difference "matrix"."""
        return step_jacobians(self.discrete, self.displacement(charts))


@dataclasses.dataclass(frozen=True, eq=False)
class ClosedDisplacementDecoder:
    """The same of closed forms."""

    numbers: decoding.Reading
    time_step: float

    def momentum(self, charts: Float[np.ndarray, "K 2"], side: str) -> Float[np.ndarray, "K 3"]:
        """Return the momenta that set out (side "left") or arrive ("right")."""
        sign = 1.0 if side == "left" else -1.0
        return decoding.read(decoding.write_momenta, self.numbers, (charts,), (3,), sign, self.time_step)

    def displacement(self, charts: Float[np.ndarray, "... 2"]) -> Float[np.ndarray, "... 3 3"]:
        """Return the displacements as matrices."""
        matrices = decoding.read(decoding.write_displacements, self.numbers, (charts.reshape(-1, 2),), (3, 3))
        return matrices.reshape(*charts.shape[:-1], 3, 3)

    def multipliers(self, charts: Charts, following: Charts) -> Float[np.ndarray, "K 1"]:
        """Return the impulses between displacements and those that follow."""
        return decoding.read(decoding.write_multipliers, self.numbers, (charts, following), (1,), self.time_step)

    def tangent(self, charts: Float[np.ndarray, "K 2"]) -> Float[np.ndarray, "K 2 2"]:
        """Return the derivatives of restricted momenta after a step by those before it."""
        return decoding.read(decoding.write_tangents, self.numbers, (charts,), (2, 2))


def step_jacobians(discrete: Scheme, W: Float[np.ndarray, "... N N"]) -> Float[np.ndarray, "... k k"]:
    r"""Return the derivatives of restricted momenta after a step by those before it, at each displacement.

    Where the constraint is no chart, $(W - W^{-1})/2 \in \mathfrak{d}$ ties the directions of Cayley coordinates.
    """
    group, system = discrete.system.group, discrete.system
    directions = None if discrete.variety.exact else group.basis
    after, before = (momentum_slope(discrete, V, directions) for V in (group.inverse(W), W))
    if directions is None:
        return after @ np.linalg.inv(before)
    sum_, inverse = (W + group.identity)[..., None, :, :], group.inverse(W)[..., None, :, :]
    dW = sum_ @ directions @ sum_ / 2
    forbidden = group.vee((dW + inverse @ dW @ inverse) / 2) @ system.annihilator.T  # of (W - W^-1)/2
    slopes = np.concatenate([before, np.swapaxes(forbidden, -1, -2)], axis=-2)
    return after @ np.linalg.inv(slopes)[..., : system.rank]


def momentum_slope(
    discrete: Scheme, W: Float[np.ndarray, "... N N"], directions: Float[np.ndarray, "m N N"] | None = None
) -> Float[np.ndarray, "... k m"]:
    r"""Return the derivative of hF by the definition, in directions of Cayley coordinates, by default those of d.

    From $W = (I - Y)^{-1}(I + Y)$ follows $dW = \tfrac12(W + I)\,dY\,(W + I)$, and
    $h\langle P, x\rangle = \mathrm{tr}(\hat x W\mathbb{J}(W - I)^*)$.
    """
    system, star = discrete.system, discrete.system.group.form_adjoint
    rows, tensor = system.group.hat(system.constraint_subspace), np.asarray(system.homogeneous_mass_tensor)
    sum_, X = (W + system.group.identity)[..., None, :, :], W - system.group.identity
    dW = sum_ @ (rows if directions is None else directions) @ sum_ / 2
    arm = dW @ tensor @ star(X)[..., None, :, :]
    return np.einsum("iab,...jba->...ij", rows, arm + (W @ tensor)[..., None, :, :] @ star(dW))
