r"""All complex roots of the equations of `_branch_equations`, with multiplicity.

First the secular polynomial: companion eigenvalues, then Newton's method. Where the body or the momentum is special and
roots are missing, the roots of a generic problem close by are followed to the given one.

Reference: docs/theory/branches.md.
"""

import dataclasses
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from nonholo._types import Array, Inexact
from nonholo.discrete._branch_candidates import candidates
from nonholo.discrete._branch_equations import Equations

_EPS = float(np.finfo(np.float64).eps)
_CLOSE = 3e-7  # relative distance, about sqrt(eps), below which two roots cannot be told from a double one
_BLURRED = 3e-5  # the same for three roots, about eps^(1/3)
_FOLDED = 1e-5  # least singular value that a root of multiplicity above one may have
_ISOLATED = 1e-10  # least singular value of a root that has no other close by
_FAR = 1e5  # size of a root that counts as infinite
_SETTLED = 1e-14  # relative residual below which an iteration that gains no more has converged
_TINY = 1e-10  # part of the largest equation that others are measured by, where their own terms vanish
_ARRIVED = 1e-12  # of the homotopy parameter, from where Newton's method takes over


class Root(NamedTuple):
    """A point on the sphere, how often it is a root, and whether it is real."""

    point: Inexact[Array, "m"]
    multiplicity: int
    is_real: bool


def roots_of(equations: Equations) -> list[Root]:
    """Return the isolated roots of a real problem: real ones by step angle, then the complex ones."""
    found = _merged(equations, _polished(equations, candidates(equations)))
    if not equations.is_balanced and sum(root.multiplicity for root in found) != equations.count:
        found = _merged(equations, _by_continuation(equations))
    found = [_realified(equations, root) for root in found]
    return sorted(found, key=lambda root: (not root.is_real, np.linalg.norm(root.point[1:]), root.point[0].imag))


def _polished(equations: Equations, starts: Iterable[Array]) -> list[Array]:
    roots = (_newton(equations, x) for x in starts if np.all(np.isfinite(x)) and np.abs(x).max() < _FAR)
    return [x for x in roots if x is not None and np.abs(x).max() < _FAR]


def _newton(equations: Equations, x: Array, steps: int = 40, reach: float = np.inf) -> Array | None:
    """Return the root that Newton's method reaches, moving no further than `reach` at first; or None."""
    best, least = None, 1e-13
    for i in range(steps):
        residual, sizes = equations.residual(x)
        error = float((np.abs(residual) / (sizes + _TINY * sizes.max())).max())
        stagnates = error > least / 2 and least < _SETTLED
        if error < least:
            best, least = x, error
        if not np.isfinite(error) or stagnates or error == 0:
            break
        correction = np.linalg.lstsq(equations.slope(x), residual, rcond=1e-13)[0]
        if i == 0 and np.linalg.norm(correction) > reach * np.linalg.norm(x):
            break
        x = x - correction
    return best


def _merged(equations: Equations, points: list[Array]) -> list[Root]:
    """Join what rounding cannot tell from a multiple root; drop what is a point of a continuum of roots."""
    left = [x if x[0].real >= 0 else -x for x in points]
    found = []
    while left:
        x = left[0]
        blur = _blur(equations, x)
        group = [y for y in left if _distance(x, y) <= max(blur, _blur(equations, y))]
        left = [y for y in left if not any(y is member for member in group)]
        centre = sum(y if np.vdot(x, y).real >= 0 else -y for y in group) / len(group)
        regularity = equations.regularity(x)
        if regularity > _FOLDED:
            found.append(Root(x, 1, False))
        elif len(group) > 1:
            found.append(Root(_centred(equations, centre), len(group), False))
        elif regularity > _ISOLATED:
            found.append(Root(x, 1, False))
    return found


def _blur(equations: Equations, x: Array) -> float:
    """Return the relative distance within which rounding may have moved a root."""
    return min(_BLURRED, _CLOSE + 10 * _EPS / max(equations.regularity(x), _EPS))


def _distance(x: Array, y: Array) -> float:
    return float(min(np.linalg.norm(x - y), np.linalg.norm(x + y)) / max(1.0, np.linalg.norm(x)))


def _centred(equations: Equations, x: Array) -> Array:
    """Correct the mean of a multiple root across the direction in which it is not determined."""
    for _ in range(3):
        U, values, V = np.linalg.svd(equations.slope(x))
        right = U.conj().T @ equations.residual(x)[0]
        x = x - V[:-1].conj().T @ (right[:-1] / values[:-1])
    return x


def _realified(equations: Equations, root: Root) -> Root:
    """Mark a root that cannot be told from its own conjugate as real, and make it so."""
    x = root.point
    if _distance(x, x.conj()) > _blur(equations, x):
        return root
    real = np.array(x.real)
    polished = _newton(equations, real) if root.multiplicity == 1 else None
    return Root(real if polished is None else polished, root.multiplicity, True)


def _by_continuation(equations: Equations) -> list[Array]:
    """Return the ends of all paths from a generic problem; roots at infinity have none."""
    rng = np.random.default_rng(0)
    for _ in range(5):
        generic = _disturbed(equations, rng)
        starts = _polished(generic, candidates(generic))
        if sum(root.multiplicity for root in _merged(generic, starts)) == generic.count:
            break
    ends = (_followed(equations, generic, x) for x in starts)
    return [x for x in ends if x is not None and np.abs(x).max() < _FAR]


def _disturbed(equations: Equations, rng: np.random.Generator) -> Equations:
    def near(value: Array) -> Array:
        noise = rng.normal(size=np.shape(value)) + 1j * rng.normal(size=np.shape(value))
        return value + 0.2 * (1 + np.abs(value).max()) * noise

    names = ("stiffness", "coupling", "target", "push")
    changed = {name: near(np.asarray(getattr(equations, name))) for name in names}
    return dataclasses.replace(equations, **changed)


def _between(start: Equations, end: Equations, t: float) -> Equations:
    names = ("stiffness", "coupling", "target", "push")
    mixed = {name: (1 - t) * getattr(end, name) + t * getattr(start, name) for name in names}
    return dataclasses.replace(end, **mixed)


def _followed(end: Equations, start: Equations, x: Array) -> Array | None:
    """Follow a root while t falls from 1 to almost 0 by factors, then solve the given problem; None if it is lost."""
    t, ratio = 1.0, 0.8
    while t > _ARRIVED:
        here = _between(start, end, t)
        change = start.residual(x)[0] - end.residual(x)[0]
        predicted = x + (1 - ratio) * t * np.linalg.lstsq(here.slope(x), change, rcond=1e-13)[0]
        corrected = _newton(_between(start, end, ratio * t), predicted, 6, 0.05)
        if corrected is not None and np.linalg.norm(corrected - x) <= 0.5 * np.linalg.norm(x):
            x, t, ratio = corrected, ratio * t, max(ratio**1.5, 0.05)
        else:
            ratio = ratio**0.5
        if ratio > 1 - 1e-4 or np.abs(x).max() > _FAR:
            return None
    return _newton(end, np.asarray(x, dtype=complex), 40, 1e-3)
