r"""The displacement variety: where displacements may lie, as a chart and the equations that the chart leaves over.

"skew": $(W - W^{-1})/2 \in \mathfrak{d}$, through the identity. "exponential": $\exp\mathfrak{d}$. "naive": $W - I$,
projected to the algebra, in $\mathfrak{d}$. Or functions $f_j(W) = 0$. If $X^3 \in \mathfrak{d}$ for every
$X \in \mathfrak{d}$ (symmetric pairs, the whole algebra, one dimension), the first two are the same set, and the Cayley
image of $\mathfrak{d}$ too.
"""

import dataclasses
import functools
from collections.abc import Callable

import numpy as np

from nonholo._checks import choice, error
from nonholo._types import Array, Float
from nonholo.groups import AbstractMatrixGroup
from nonholo.systems import AbstractSystem

Constraint = str | tuple[Callable[[Array], Array], ...]

_NAMES = ("skew", "exponential", "naive")
_ROUNDING = 1e-10  # relative, of cubes that must stay in the subspace
_STEP = 1e-6  # of the differences that compare the tangent space of functions with the subspace


@dataclasses.dataclass(frozen=True, eq=False)
class Variety:
    """A chart of displacements and the equations that it leaves over.

    Attributes:
        group: The group.
        chart: Rows span the directions of the chart, shape (m, dim).
        annihilator: Rows of the forbidden directions, shape (s, dim).
        constraint: "skew", "exponential", "naive" or functions.
        exponential: Whether the chart is exp, not the group's retraction.
    """

    group: AbstractMatrixGroup
    chart: Float[np.ndarray, "m dim"]
    annihilator: Float[np.ndarray, "s dim"]
    constraint: Constraint
    exponential: bool

    @property
    def exact(self) -> bool:
        """Whether the chart covers the variety and no equations are left."""
        return self.chart.shape[0] + self.annihilator.shape[0] == self.group.dim

    def displaced(self, y: Float[Array, "... m"]) -> Float[Array, "... N N"]:
        """Return the displacement with chart coordinates y, tangent to 2 y."""
        x = 2 * y @ y.__array_namespace__().asarray(self.chart, dtype=y.dtype)
        return self.group.exp(x) if self.exponential else self.group.retract(x)

    def increment(self, y: Float[Array, "... m"]) -> Float[Array, "... N N"]:
        """Return the displacement minus the identity, without cancellation."""
        x = 2 * y @ y.__array_namespace__().asarray(self.chart, dtype=y.dtype)
        return self.group.exp_increment(x) if self.exponential else self.group.retract_increment(x)

    def equations(self, W: Float[Array, "... N N"]) -> Float[Array, "... j"]:
        """Return what must vanish on the variety and is not built into the chart."""
        xp = W.__array_namespace__()
        if self.exact:
            return xp.zeros((*W.shape[:-2], 0), dtype=W.dtype)
        if not isinstance(self.constraint, str):
            return xp.stack([f(W) for f in self.constraint], axis=-1)
        if self.constraint == "skew":
            moved = (W - self.group.inverse(W)) / 2
        else:
            moved = W - xp.asarray(self.group.identity, dtype=W.dtype)
        return self.group.vee(moved) @ xp.asarray(self.annihilator, dtype=W.dtype).T


def variety_of(system: AbstractSystem, constraint: Constraint) -> Variety:
    """Return the displacement variety of a system, in its canonical frame."""
    canonical = system.canonical
    subspace, annihilator = np.asarray(canonical.constraint_subspace), np.asarray(canonical.annihilator)
    rows = (subspace.tobytes(), subspace.shape, annihilator.tobytes(), annihilator.shape)
    return _variety(system.group, rows, constraint)


@functools.lru_cache(maxsize=256)
def _variety(group: AbstractMatrixGroup, rows: tuple, constraint: Constraint) -> Variety:
    data, shape, other, other_shape = rows
    subspace = np.frombuffer(data).reshape(shape)
    annihilator = np.frombuffer(other).reshape(other_shape)
    if constraint in ("skew", "exponential") and (group.is_rigid and _cubes_stay(group, subspace, annihilator)):
        return Variety(group, subspace, annihilator, constraint, exponential=False)
    if constraint == "exponential":
        return Variety(group, subspace, annihilator, constraint, exponential=True)
    return Variety(group, np.eye(group.dim), annihilator, constraint, exponential=False)


def _cubes_stay(group: AbstractMatrixGroup, subspace: np.ndarray, annihilator: np.ndarray) -> bool:
    """Tell whether X^3 lies in the subspace for every X in it; a polynomial identity, tried on random X."""
    draws = np.random.default_rng(0).normal(size=(4, len(subspace))) @ subspace
    X = group.hat(draws)
    cubes = group.vee(X @ X @ X)
    return bool(np.abs(cubes @ annihilator.T).max(initial=0.0) <= _ROUNDING * np.abs(X).max(initial=0.0) ** 3)


def checked_constraint(where: str, system: AbstractSystem, constraint: object) -> Constraint:
    """Return a named constraint, or functions that pass through the identity with tangent space d."""
    if callable(constraint):
        constraint = (constraint,)
    if not isinstance(constraint, list | tuple):
        return choice(where, constraint, _NAMES, "Or pass functions f_j(W), zero on the variety.")
    functions = tuple(constraint)
    group, canonical = system.group, system.canonical
    s = len(canonical.annihilator)
    if len(functions) != s:
        raise error(where, f"be {s} functions, one per forbidden direction", f"{len(functions)}", "Pass as many.")
    values = _values(where, functions, group.identity)
    if np.abs(values).max(initial=0.0) > _STEP**2:
        raise error(where, "vanish at the identity", f"values {values}", "Subtract them.")
    directions = np.concatenate([canonical.constraint_subspace, canonical.annihilator])
    ahead = np.stack([_values(where, functions, group.exp(_STEP * x)) for x in directions])
    behind = np.stack([_values(where, functions, group.exp(-_STEP * x)) for x in directions])
    slopes = (ahead - behind) / (2 * _STEP)
    k = len(canonical.constraint_subspace)
    if np.abs(slopes[:k]).max(initial=0.0) > 1e-6 * np.abs(slopes).max(initial=1.0):
        got = f"a derivative {np.abs(slopes[:k]).max():.3g} along d"
        raise error(where, "be tangent to d at the identity", got, "Check the functions against constraint_subspace.")
    if s and np.linalg.matrix_rank(slopes[k:], tol=1e-6 * np.abs(slopes).max()) < s:
        raise error(where, "be independent at the identity", "dependent derivatives", "Drop what repeats another.")
    return functions


def _values(where: str, functions: tuple[Callable[[Array], Array], ...], W: np.ndarray) -> np.ndarray:
    values = [np.asarray(f(W), dtype=np.float64) for f in functions]
    if any(value.shape != () for value in values):
        shapes = [value.shape for value in values]
        raise error(where, "be scalar functions of a matrix", f"values of shapes {shapes}", "Return one number each.")
    if not np.all(np.isfinite(values)):
        raise error(where, "be finite at the identity", f"{values}", "Check the functions.")
    return np.stack(values) if values else np.zeros(0)
