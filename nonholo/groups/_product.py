"""Direct products of groups as block-diagonal matrices, every operation by blocks."""

import dataclasses
import functools
from collections.abc import Callable
from itertools import accumulate

import numpy as np

from nonholo.base.checks import assign, error, shown
from nonholo.base.numerics import block_diagonal
from nonholo.base.types import Array, Float, Int
from nonholo.groups._base import AbstractMatrixGroup


@dataclasses.dataclass(frozen=True, init=False, repr=False)
class ProductGroup(AbstractMatrixGroup):
    r"""The product $G_1 \times \dots \times G_m$; coordinates and poses are those of the factors, one after another.

    It is not rigid, even if its factors are: no one mass tensor gives the kinetic energy of several bodies.

    Args:
        *factors: The groups.

    Raises:
        ValueError: No factor is given, or something that is not a group.

    Example:
        A body in the plane that carries two wheels:

        >>> group = ProductGroup(SE(2), Translations(2))
        >>> group.dim, group.size, group.pose_size
        (5, 6, 6)
        >>> group.pose_from_matrix(group.exp(np.array([0.0, 1.0, 2.0, 3.0, 4.0])))
        array([1., 0., 1., 2., 3., 4.])
    """

    factors: tuple[AbstractMatrixGroup, ...]

    def __init__(self, *factors: AbstractMatrixGroup) -> None:
        wrong = [factor for factor in factors if not isinstance(factor, AbstractMatrixGroup)]
        if wrong or not factors:
            got = shown(wrong[0]) if wrong else "no factor"
            raise error("ProductGroup(*factors)", "be given groups", got, "Pass groups such as SE(2), Translations(2).")
        sizes = {name: sum(getattr(factor, name) for factor in factors) for name in ("dim", "size", "pose_size")}
        assign(self, factors=factors, **sizes)

    def __repr__(self) -> str:
        return f"ProductGroup({', '.join(map(repr, self.factors))})"

    @functools.cached_property
    def basis(self) -> np.ndarray:
        """The basis of the algebra, shape (dim, N, N)."""
        return self._assemble(lambda factor, part: factor.hat(part), self._vectors(np.eye(self.dim)))

    def exp_increment(self, x: Float[Array, "... dim"]) -> Float[Array, "... N N"]:
        """Return `exp(x)` minus the identity, without cancellation."""
        return self._assemble(lambda factor, part: factor.exp_increment(part), self._vectors(x))

    def log(self, g: Float[Array, "... N N"]) -> Float[Array, "... dim"]:
        """Return the logarithms of the factors."""
        return self._concatenate(lambda factor, block: factor.log(block), self._blocks(g))

    def cayley_increment(self, x: Float[Array, "... dim"]) -> Float[Array, "... N N"]:
        """Return `cayley(x)` minus the identity, without cancellation."""
        return self._assemble(lambda factor, part: factor.cayley_increment(part), self._vectors(x))

    def dexp_inverse(self, x: Float[Array, "... dim"]) -> Float[Array, "... dim dim"]:
        r"""Return the matrix of $\mathrm{dexp}_x^{-1}$, block-diagonal."""
        return self._assemble(lambda factor, part: factor.dexp_inverse(part), self._vectors(x))

    def inverse(self, g: Float[Array, "... N N"]) -> Float[Array, "... N N"]:
        """Return the inverse of every block."""
        return self._assemble(lambda factor, block: factor.inverse(block), self._blocks(g))

    def residual(self, g: Float[Array, "... N N"]) -> Float[Array, "..."]:
        """Return the largest residual of a factor, or the largest entry outside the blocks."""
        g = self._matrix(g)
        xp, blocks = g.__array_namespace__(), self._blocks(g)
        outside = xp.max(abs(g - block_diagonal(blocks)), axis=(-2, -1))
        inside = [factor.residual(block) for factor, block in zip(self.factors, blocks, strict=True)]
        return functools.reduce(xp.maximum, inside, outside)

    @property
    def has_drift(self) -> bool:  # type: ignore[override]
        """Whether poses of a factor that grow leave it by rounding."""
        return any(factor.has_drift for factor in self.factors)

    def leading_elements(self, g: Float[Array, "... K N N"]) -> Int[Array, "..."]:
        """Return how many of the first poses precede one of which a part has left its factor."""
        pairs = zip(self.factors, self._blocks(g), strict=True)
        counts = [factor.leading_elements(block) for factor, block in pairs if factor.has_drift]
        return np.minimum.reduce([np.full(g.shape[:-3], g.shape[-3]), *counts])

    def angle(self, x: Float[Array, "... dim"]) -> Float[Array, "..."]:
        """Return the largest angle of a factor."""
        parts = self._vectors(x)
        angles = [factor.angle(part) for factor, part in zip(self.factors, parts, strict=True)]
        return functools.reduce(parts[0].__array_namespace__().maximum, angles)

    def random(self, rng: int | np.random.Generator) -> Float[np.ndarray, "N N"]:
        """Draw every factor."""
        rng = self._generator(rng)
        return block_diagonal([factor.random(rng) for factor in self.factors])

    def matrix_from_pose(self, pose: Float[Array, "... size"]) -> Float[Array, "... N N"]:
        """Return the block-diagonal matrix of the factors' poses."""
        return self._assemble(lambda factor, part: factor.matrix_from_pose(part), self._poses(pose))

    def pose_from_matrix(self, g: Float[Array, "... N N"]) -> Float[Array, "... size"]:
        """Return the poses of the factors, one after another."""
        return self._concatenate(lambda factor, block: factor.pose_from_matrix(block), self._blocks(g))

    def normalize_pose(self, pose: Float[Array, "... size"]) -> Float[Array, "... size"]:
        """Return the normalized poses of the factors."""
        return self._concatenate(lambda factor, part: factor.normalize_pose(part), self._poses(pose))

    def pose_rate(self, pose: Float[Array, "... size"], x: Float[Array, "... dim"]) -> Float[Array, "... size"]:
        """Return the rates of the factors' poses."""
        pairs = zip(self._poses(pose), self._vectors(x), strict=True)
        return self._concatenate(lambda factor, pair: factor.pose_rate(*pair), list(pairs))

    def _cuts(self, name: str) -> list[int]:
        return list(accumulate(getattr(factor, name) for factor in self.factors))[:-1]

    def _vectors(self, x: Array) -> list[Array]:
        x = self._vector(x)
        return x.__array_namespace__().split(x, self._cuts("dim"), axis=-1)

    def _poses(self, pose: Array) -> list[Array]:
        pose = self._pose(pose)
        return pose.__array_namespace__().split(pose, self._cuts("pose_size"), axis=-1)

    def _blocks(self, g: Array) -> list[Array]:
        g = self._matrix(g)
        ends = [*self._cuts("size"), self.size]
        return [g[..., a:b, a:b] for a, b in zip([0, *ends], ends, strict=False)]

    def _assemble(self, function: Callable[..., Array], parts: list[Array]) -> Array:
        return block_diagonal([function(factor, part) for factor, part in zip(self.factors, parts, strict=True)])

    def _concatenate(self, function: Callable[..., Array], parts: list[Array]) -> Array:
        pieces = [function(factor, part) for factor, part in zip(self.factors, parts, strict=True)]
        return pieces[0].__array_namespace__().concatenate(pieces, axis=-1)
