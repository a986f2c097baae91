r"""All complex roots of the equations of `_equations`, with multiplicity.

First the secular polynomial: companion eigenvalues, then Newton's method. Where the body or the momentum is special and
roots are missing, the roots of a generic problem close by are followed to the given one.

Reference: docs/theory/branches.md.
"""

import dataclasses
import functools
import itertools
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from nonholo.base.types import Array, Bool, Float, Inexact
from nonholo.discrete.branching._equations import Equations

Points = Inexact[Array, "B m"]


def candidates(equations: Equations) -> Inexact[Array, "B m"]:
    """Return approximate roots, only finite ones; by the secular polynomial, or the one of a special case."""
    with np.errstate(all="ignore"):
        if (points := equations.starts()) is None:
            is_planar = len(equations.stiffness) == 1
            vectors = _odd if equations.is_balanced else _planar if is_planar else _generic
            points = equations.points([_with_length(equations, v) for v in vectors(equations)])
    return points[np.isfinite(points).all(axis=1)]


def _generic(equations: Equations) -> Array:
    """Return the points (z_0, z) over the roots of the secular polynomial."""
    N1, N2, Y = _secular(equations)
    products = [np.convolve(N2, np.append(N1[:1], N1[1:] - N2)), *(-np.convolve(row, row) for row in Y)]
    polynomial = functools.reduce(np.polyadd, products)
    if not np.all(np.isfinite(polynomial)) or not np.any(polynomial):
        return np.zeros((0, len(Y) + 1))
    mu = np.roots(polynomial)
    points = np.array([np.polyval(row, mu) for row in (N2, *Y)]).T
    return points / np.sqrt((points * points).sum(axis=1, keepdims=True) + 0j)


def _secular(equations: Equations) -> tuple[Array, Array, list[Array]]:
    r"""Return polynomials in $\mu$: $y\cdot y + 1 = N_1/N_2$ and $y = Y/N_2$ where $N_2(N_1 - N_2) = Y\cdot Y$.

    The cancellation of $b_i + \mu$ in $Y_i$ is done by hand, so equal eigenvalues do no harm. N_1 has one coefficient
    more than N_2 and the components of Y.
    """
    b, c, k = equations.stiffness, equations.coupling, len(equations.stiffness)
    d, half = equations.target - c, _half_of_p(equations)

    def product(*left_out: int) -> Array:
        factors = [np.array([1.0, b[i]]) for i in range(k) if i not in left_out]
        return functools.reduce(np.convolve, factors, np.ones(1))

    whole, without = product(), np.array([product(i) for i in range(k)])
    N1 = np.append(whole, 0.0) + np.pad((c * c) @ without, (2, 0))
    N2 = half * whole - np.pad((c * d) @ without, (1, 0))
    pairs = {(i, j): np.pad(product(i, j), (2, 0)) for i in range(k) for j in range(i)}
    Y = []
    for i in range(k):
        row = np.convolve(without[i], np.array([d[i], c[i] * half]))
        for j in set(range(k)) - {i}:
            row = row + c[j] * (c[j] * d[i] - c[i] * d[j]) * pairs[max(i, j), min(i, j)]
        Y.append(row)
    return N1, N2, Y


def _planar(equations: Equations) -> list[Array]:
    r"""Return the roots of the cubic $(1 + y^2)(\tfrac12\hat p\,y - r) + by = 0$; y infinite if $\hat p = 0$."""
    b, r = equations.stiffness[0], equations.target[0]
    half = _half_of_p(equations)
    finite = [np.array([1.0, y]) / np.sqrt(1 + y * y + 0j) for y in np.roots([half, -r, half + b, -r])]
    return finite + ([np.array([0j, 1.0])] if half == 0 else [])


def _half_of_p(equations: Equations) -> Array:
    r"""Return $\hat p/2$, $\hat p = \alpha p + 2\alpha^2$."""
    return equations.arm * (equations.push / 2 + equations.arm)


def _odd(equations: Equations) -> list[Array]:
    """Return the two roots z_0 z = B^-1 r; one if r = 0, where the other is a whole sphere of half-turns."""
    w = equations.target / equations.stiffness
    larger = (1 + np.sqrt(1 - 4 * (w @ w) + 0j)) / 2
    squares = [larger, (w @ w) / larger] if w @ w else [larger]
    return [np.array([z0, *(w / z0)]) for z0 in np.sqrt(np.array(squares))]


def _with_length(equations: Equations, v: Array) -> Array:
    """Append u, from whichever equation determines it better."""
    if equations.lever is None:
        return v
    z0, z, a = v[0], v[1:], equations.arm
    if abs(z0) ** 2 > 1e-6 * (abs(z) ** 2).sum() or a == 0:
        return np.append(v, (equations.push + 2 * a * (z @ z)) / z0)
    b, c = equations.stiffness + a * a, equations.coupling
    rest = equations.target - z0 * b * z - (z @ z) * c + (c @ z) * z
    return np.append(v, 2 * (z @ rest) / (a * (z @ z)))


_EPS = float(np.finfo(np.float64).eps)
_CLOSE = 3e-7  # relative distance, about sqrt(eps), below which two roots cannot be distinguished from a double one
_BLURRED = 3e-5  # the same for three roots, about eps^(1/3)
_FOLDED = 1e-5  # least singular value that a root of multiplicity above one may have
_ISOLATED = 1e-10  # least singular value of a root that has no other close by
_SETTLED = 1e-14  # relative residual below which an iteration that gains no more has converged
_TINY = 1e-10  # part of the largest equation that others are measured by, where their own terms vanish
_REACHED = 1e-13  # relative residual of a root
_LOOPS = 40  # of problems around a generic one
_ARRIVED = 1e-12  # of the homotopy parameter, from where Newton's method takes over


class Root(NamedTuple):
    """A point on the sphere, how often it is a root, and whether it is real."""

    point: Inexact[Array, "m"]
    multiplicity: int
    is_real: bool


def roots_of(equations: Equations) -> list[Root]:
    """Return the isolated roots: of a real problem the real ones by step angle, then the complex ones."""
    roots = _merge(equations, polish(equations, candidates(equations)))
    complete = equations.is_balanced or _count(roots) == equations.count
    is_crowded = len(equations.stiffness) > 1 and not equations.is_balanced and any(r.multiplicity > 2 for r in roots)
    if not complete or is_crowded:  # iterations that missed hidden roots may have been counted at a multiple one
        by_path = _merge(equations, _by_continuation(equations))
        roots = by_path if _count(by_path) >= min(_count(roots), equations.count) else roots
    if not _is_complex(equations):
        roots = _mark_real(equations, roots)
    return sorted(roots, key=place)


def _count(roots: list[Root]) -> int:
    return sum(root.multiplicity for root in roots)


def place(root: Root) -> tuple:
    """Return what roots are sorted by: real ones first, by step angle."""
    x = root.point
    side = x.imag[np.argmax(np.abs(x.imag) > _BLURRED * np.linalg.norm(x))]  # of a pair
    return not root.is_real, float(f"{np.linalg.norm(x[1:]):.8g}"), side  # lengths that rounding parts are one


def polish(equations: Equations, starts: Inexact[Array, "B m"]) -> Inexact[Array, "C m"]:
    """Return the roots that Newton's method reaches from points."""
    roots, converged = _newton(equations, _finite(equations, starts))
    return _finite(equations, roots[converged])


def _finite(equations: Equations, points: Inexact[Array, "B m"]) -> Inexact[Array, "C m"]:
    return points[(np.abs(points) < equations.horizon).all(axis=1)]


def _newton(equations: Equations, x: Points, steps: int = 40, reach: float = np.inf) -> tuple[Points, Bool[Array, "B"]]:
    """Return the roots that Newton's method reaches, moving no further than `reach` at first, and where it does."""
    x, best, least, active = x.copy(), x.copy(), np.full(len(x), _REACHED), np.arange(len(x))
    for i in range(steps):
        residual, sizes = equations.residual(x[active])
        sizes[:, :-1] += _TINY * sizes.max(axis=1, keepdims=True)  # the last ones, of the sphere, do not vanish
        error = (np.abs(residual) / sizes).max(axis=1)
        stagnates = (error > least[active] / 2) & (least[active] < _SETTLED)
        better = active[error < least[active]]
        best[better], least[active] = x[better], np.fmin(error, least[active])
        on = np.isfinite(error) & ~stagnates & (error != 0)
        active, residual = active[on], residual[on]
        if len(active) == 0:
            break
        correction = equations.solve(x[active], residual)
        if i == 0:
            near = _length(equations, correction, x[active]) <= reach
            active, correction = active[near], correction[near]
        x[active] -= correction
    return best, least < _REACHED


def _merge(equations: Equations, points: Inexact[Array, "B m"]) -> list[Root]:
    """Join what rounding cannot tell from a multiple root; drop what is a point of a continuum of roots."""
    points = np.where(points[:, :1].real >= 0, points, -points)
    regularity = _regularity(equations, points)
    blur = _blur(regularity)
    near = distance(equations, points[:, None], points) <= np.maximum(blur[:, None], blur)
    left, roots = np.ones(len(points), dtype=bool), []
    while left.any():
        i = int(np.argmax(left))
        members = near[i] & left
        left &= ~members
        group = points[members]
        if len(group) > 1 and regularity[i] <= _FOLDED:
            sides = np.where((group @ points[i].conj()).real >= 0, 1.0, -1.0)
            roots.append(Root(_center(equations, sides @ group / len(group)), len(group), False))
        elif regularity[i] > _ISOLATED:
            roots.append(Root(points[i], 1, False))
    return roots


def _blur(regularity: Float[np.ndarray, "B"]) -> Float[np.ndarray, "B"]:
    """Return the relative distance within which rounding may have moved a root."""
    return np.minimum(_BLURRED, _CLOSE + 10 * _EPS / np.maximum(regularity, _EPS))


def _regularity(equations: Equations, x: Inexact[Array, "B m"]) -> Float[np.ndarray, "B"]:
    """Return the regularity of roots, far ones as if they were near."""
    return equations.regularity(x) / equations.extent(x)[:, 0]


def _length(equations: Equations, move: Inexact[Array, "... m"], x: Inexact[Array, "... m"]) -> Float[Array, "..."]:
    """Return the size of a move from a point, relative to the sizes of its turn and slide."""
    return np.linalg.norm(move / equations.extent(x), axis=-1)


def distance(equations: Equations, x: Inexact[Array, "... m"], y: Inexact[Array, "... m"]) -> Float[Array, "..."]:
    """Return the distance of two points, either sign of them, relative to the sizes of turn and slide of one."""
    return np.minimum(_length(equations, x - y, x), _length(equations, x + y, x))


def _center(equations: Equations, x: Array) -> Array:
    """Correct the mean of a multiple root across the direction in which it is not determined."""
    for _ in range(3):
        U, values, V = np.linalg.svd(equations.slope(x), full_matrices=False)
        right = U.conj().T @ equations.residual(x)[0]
        x = x - V[:-1].conj().T @ (right[:-1] / values[:-1])
    return x


def _mark_real(equations: Equations, roots: list[Root]) -> list[Root]:
    """Mark roots that cannot be distinguished from their own conjugates as real, and make them so."""
    x = equations.points([root.point for root in roots])
    real = distance(equations, x, x.conj()) <= _blur(_regularity(equations, x))
    pairs = zip(roots, real, strict=True)
    result = [Root(root.point.real.copy(), root.multiplicity, True) if on else root for root, on in pairs]
    simple = [i for i, root in enumerate(result) if root.is_real and root.multiplicity == 1]
    points, converged = _newton(equations, np.real(x[simple]))
    for i, point, good in zip(simple, points, converged, strict=True):
        result[i] = Root(point, 1, True) if good else result[i]
    return result


def _by_continuation(equations: Equations) -> Inexact[Array, "B m"]:
    """Return the ends of all paths from a generic problem; roots at infinity have none."""
    rng = np.random.default_rng(0)
    for _ in range(5):
        generic = disturb(equations, rng)
        starts = polish(generic, candidates(generic))
        if _count(_merge(generic, starts)) == generic.count:
            break
    if len(starts) == 0:
        generic, starts = equations.around()
    ends = _finite(equations, follow_all(equations, generic, starts))
    if _is_complex(equations) or len(ends) == 0:
        return ends
    alone = distance(equations, ends.conj()[:, None], ends).min(axis=1) > _BLURRED  # real problems have them in pairs
    return np.concatenate([ends, ends[alone].conj()])


def _is_complex(equations: Equations) -> bool:
    return np.iscomplexobj(equations.target) or np.iscomplexobj(equations.push)


def by_loops(
    generic: Equations, points: Points, draw: Callable[[], Equations], is_complete: Callable[[Points], bool]
) -> Inexact[Array, "C m"]:
    """Return the roots of a generic problem: the known ones, and those where loops of problems lead them."""
    points = distinct(generic, points)
    for _ in range(_LOOPS):
        if is_complete(points):
            break
        ends, way = points, (generic, draw(), draw(), generic)
        for begin, end in itertools.pairwise(way):
            ends = follow_all(end, begin, ends)
        points = distinct(generic, np.concatenate([points, ends]))
    return points


def distinct(equations: Equations, points: Inexact[Array, "B m"]) -> Inexact[Array, "C m"]:
    """Return isolated roots, each once."""
    return equations.points([root.point for root in _merge(equations, points)])


def disturb(equations: Any, rng: np.random.Generator) -> Any:
    """Return a generic complex problem near one."""

    def near(value: Array) -> Array:
        noise = rng.normal(size=np.shape(value)) + 1j * rng.normal(size=np.shape(value))
        return value + 0.2 * (1 + np.abs(value).max()) * noise

    values = {name: near(np.asarray(getattr(equations, name))) for name in equations.parameters}
    return dataclasses.replace(equations, **values)


def _between(start: Equations, end: Any, t: float) -> Equations:
    values = {name: (1 - t) * getattr(end, name) + t * getattr(start, name) for name in end.parameters}
    return dataclasses.replace(end, **values)


def follow_all(end: Equations, start: Equations, x: Inexact[Array, "B m"]) -> Inexact[Array, "C m"]:
    """Follow roots while t falls from 1 to almost 0 by factors, then solve the given problem; some are lost."""
    t, ratio = 1.0, 0.8
    while t > _ARRIVED and len(x) > 0:
        change = start.residual(x)[0] - end.residual(x)[0]
        guess = x + (1 - ratio) * t * _between(start, end, t).solve(x, change)
        points, converged = _newton(_between(start, end, ratio * t), guess, 6, 0.05)
        good = converged & (_length(end, points - x, x) <= 0.5)
        if not good.all() and ratio < 1 - 1e-4:
            ratio = ratio**0.5
            continue
        x, t = _finite(end, points[good]), ratio * t
        ratio = max(ratio**1.5, 0.05)
    roots, converged = _newton(end, x.astype(complex), 40, 1e-3)
    return roots[converged]
