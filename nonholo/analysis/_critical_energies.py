r"""Critical energies of the discrete Suslov top: where the level curves on the displacement variety change (n = 3).

The variety is a projective plane, $W \leftrightarrow \pm(z_0, z)$; the energy on it is a quartic with isolated critical
points. Branches and their regions live elsewhere.

Up to the energy of the first fold momenta determine the displacement around the identity. On a ray of displacements
with one axis $\cot(\theta/2)$ of a fold is a root of a cubic; the least energy of all folds is found by a search along
the circle of axes. For n > 3 it has a lower bound. Theory: docs/theory/critical-energies.md.
"""

import functools
from typing import Any

import numpy as np
import scipy  # its parts load on first use

from nonholo.analysis._equilibria import highest_energy
from nonholo.analysis.planar import check_conserves_energy
from nonholo.base.checks import error
from nonholo.base.numerics import real_cubic_roots
from nonholo.base.results import result
from nonholo.base.types import Float
from nonholo.discrete import Discretization, as_discretization
from nonholo.discrete.branching import Landscape, landscape
from nonholo.systems import NormalForm

_COINCIDENT = 1e-14  # relative distance of two energies below which a curve of critical points is assumed
_AT_SADDLE = 1e-12  # relative distance below which a fold is the saddle, through which a line of folds passes

_UNIFORM = 720  # directions around the circle, once in the metric of the energy and once in that of the plane
_NEAR_SADDLE = 200  # on each side: folds leave the saddle at every scale


@result
class CriticalPoint:
    r"""A displacement at which the energy is stationary on the displacement variety.

    Attributes:
        energy: Physical energy.
        kind: "minimum", "saddle" or "maximum".
        on_equator: Whether the displacement is a half-turn.
        stationary: Whether it is an equilibrium of the map (on the line of permanent rotations).
        half_turn_vector: $z = \sin(\theta/2)\,u$ in the rows of the canonical constraint subspace, $u$ a unit vector;
            $-z$ is critical too, the same displacement on the equator.
    """

    energy: float
    kind: str
    on_equator: bool
    stationary: bool
    half_turn_vector: Float[np.ndarray, "2"]


@result
class CriticalEnergies:
    r"""Critical values of the energy of a discrete top, in physical units; None where there is no such point.

    For n > 3 only `fold`, `line` and `regular` are known; no point is listed.

    Attributes:
        saddle: $h^*$: two opposite saddles off the equator. Below it, in the regular regime, the component of the
            level curve around the identity is separate, and each momentum has a displacement on it.
        center: $h^{**}$: two opposite maxima off the equator. Equal to `saddle` if a closed curve of maxima replaces
            the four points.
        equatorial_saddle: $h_e$: the highest saddle among half-turns.
        fold: Below it each momentum has exactly one displacement in the part of the level around the identity, the
            principal one, and no principal orbit ends. For n = 3 it is $h_f$, always defined: the least energy of a
            fold that can be reached from the identity through lower energies. In the regular regime
            $\tfrac{125}{128}h^* < h_f \le h^*$, and $h_f = h^*$ if $\det B \ge 3|c|^2$. For n > 3 it is a proved
            lower bound of $h_f$, more than $\tfrac{125}{128}(1 - \sigma)h_f$: $b_1/(2h^2)$ if
            $\sigma = |c|^2/(b_1b_2) \le \tfrac13$ with the two least eigenvalues of B, and
            $1 - (3\sigma - 1)^3(1 + \sigma)/(16\sigma)$ of that for $\sigma < \tfrac12$. Beyond nothing is known,
            and it is 0.
        line: The highest energy of an equilibrium, $q_c/(2h^2|c|^2)$, which turns by 90 degrees in a step. Above it
            every real orbit ends, on any branches. None for a balanced body, all of whose states are equilibria.
        regular: $\det B > 2|c|^2$, for n > 3 $b_1b_2 > 2|c|^2$.
        points: All isolated critical points, the two (on the equator: one) opposite ones once, from low to high.
    """

    saddle: float | None
    center: float | None
    equatorial_saddle: float | None
    fold: float
    line: float | None
    regular: bool
    points: tuple[CriticalPoint, ...]

    @property
    def centre(self) -> float | None:
        """The same as `center`."""
        return self.center


def critical_energies(discrete: Discretization) -> CriticalEnergies:
    r"""Return the critical values of the energy on the displacement variety of a top.

    In three dimensions, with $z = \sqrt\varrho\,u$, $|u| = 1$, $D = \det B$ and
    $\kappa(u) = 1 - (c\cdot u^\perp)^2/D$

    $$ E = \tfrac{2}{h^2}\,(u\cdot Bu)\,(\varrho - \kappa\varrho^2), \qquad 0 \le \varrho \le 1 . $$

    Off the equator $\varrho = 1/(2\kappa) < 1$ and $Bu = \mu\,(\mathrm{Id} - c^\perp c^{\perp T}/D)\,u$ with
    $E = \mu/(2h^2)$; on it $\varrho = 1$ and $E = 2\,(u\cdot Bu)(c\cdot u^\perp)^2/(h^2D)$ is stationary, a cubic.

    Reference: [fedorov-zenkov-2004], section 6, "Invariant curves", which lacks $h_e$ and the regular regime.

    Args:
        discrete: A `SuslovTop`, difference "matrix" and constraint "skew" or "exponential".

    Raises:
        ValueError: Another system or discretization.

    Example:
        >>> top = nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]])
        >>> energies = critical_energies(nh.discretize(top, 1.0))
        >>> print(f"{energies.equatorial_saddle:.6f} {energies.saddle:.6f} {energies.center:.6f}")
        0.347449 0.930510 1.262473
        >>> energies.regular, energies.fold == energies.saddle, round(energies.line, 6)
        (True, True, 1.008824)

        A top on SO(5), whose first fold has no less energy than this:

        >>> top = nh.SuslovTop.arrowhead([1.0, 2.0, 3.0, 4.0, 5.0], [0.3, 0.2, 0.1, 0.2])
        >>> critical_energies(nh.discretize(top, 0.5)).fold
        12.0
    """
    where, remedy = "critical_energies(discrete=...)", "Pass `discretize(SuslovTop(J), time_step)`."
    form, step = as_discretization(where, discrete).system.normal_form, float(discrete.time_step)
    if form is None or form.is_sleigh:
        if getattr(form, "is_planar", False):
            remedy = "Its level curves are ellipses; `single_valued_region` gives the energy where branches merge."
        raise error(where, "be a discretized Suslov top", f"{type(discrete.system).__name__}", remedy)
    check_conserves_energy(where, discrete, "conserve the energy")
    if not form.is_planar:
        return _in_more_dimensions(form, step)
    land, unit = landscape(form), 2 / step**2
    off = _off_equator(land, unit)
    points = _on_equator(land, unit) if land.sharpness > 0 else []
    by_kind = {p.kind: p.energy for p in off}
    saddles = [p.energy for p in points if p.kind == "saddle"]
    if len(off) < 2 or off[0].energy - off[1].energy > _COINCIDENT * off[0].energy:
        points = points + off
    return CriticalEnergies(
        saddle=by_kind.get("saddle"),
        center=by_kind.get("maximum"),
        equatorial_saddle=max(saddles, default=None),
        fold=_fold(form, land, unit, by_kind.get("saddle")),
        line=highest_energy(discrete),
        regular=land.is_regular,
        points=(CriticalPoint(0.0, "minimum", False, True, np.zeros(2)), *sorted(points, key=lambda p: p.energy)),
    )


def _in_more_dimensions(form: NormalForm, step: float) -> CriticalEnergies:
    r"""Return what is known for n > 3, by the planes through a displacement."""
    b, c = form.principal[0], form.to_principal(np.asarray(form.coupling))
    least, next_least = np.partition(b, 1)[:2]
    sharpness, unit = float(c @ c / least / next_least), 1 / (2 * step * step)
    missing = max(3 * sharpness - 1, 0.0) ** 3 * (1 + sharpness) / (16 * sharpness) if sharpness > 0 else 0.0
    regular, unknown = 2 * sharpness < 1, dict.fromkeys(("saddle", "center", "equatorial_saddle"))
    fold = float((1 - missing) * least * unit) if regular else 0.0
    line = float((b * c) @ c / (c @ c) * unit) if form.is_coupled else None
    return CriticalEnergies(**unknown, fold=fold, line=line, regular=regular, points=())


def _fold(form: NormalForm, land: Landscape, unit: float, saddle: float | None) -> float:
    r"""Return $h_f$: the saddle where $D \ge 3|c|^2$, by theorem, otherwise found by a search."""
    if saddle is not None and 3 * land.sharpness <= 1:
        return saddle
    fold = unit * fold_energy(form.stiffness_matrix, np.asarray(form.coupling))
    if saddle is not None and land.is_regular and fold >= (1 - _AT_SADDLE) * saddle:
        return saddle
    return fold


def _off_equator(land: Landscape, unit: float) -> list[CriticalPoint]:
    r"""Return center and saddle; each exists if $\varrho = 1/(2\kappa)$ is less than one."""
    points = []
    for inverse, vector, kind in zip(land.inverses, land.vectors.T, ("maximum", "saddle"), strict=True):
        length = float(np.hypot(*vector))
        kappa = float(inverse) / length**2
        if kappa > 0.5:
            z = vector / length / np.sqrt(2 * kappa)
            along_c = land.sharpness == 0 or bool(abs(z[1]) <= 1e-12 * abs(z[0]))
            points.append(CriticalPoint(unit / (4 * float(inverse)), kind, False, along_c, land.axes @ z))
    return points


def _on_equator(land: Landscape, unit: float) -> list[CriticalPoint]:
    """Return half-turns: the one along c, of energy zero, and those of the cubic, u = (s, 1)/|(s, 1)|."""
    (p, q), (_, r) = land.inertia
    axes, sharpness = land.axes, land.sharpness
    points = [CriticalPoint(0.0, "minimum", True, True, axes[:, 0])]
    roots = np.roots([p, 3 * q, 2 * r - p, -q])
    for s in sorted(roots[np.abs(roots.imag) <= 1e-12 * np.maximum(1.0, np.abs(roots))].real.tolist()):
        square = 1 + s * s
        energy = unit * sharpness * float(p * s * s + 2 * q * s + r) / square**2
        curvature = 3 * p * s * s + 6 * q * s + 2 * r - p  # the slope of the cubic: positive where E is greatest
        highest, convex = curvature > 0, 2 * (1 - sharpness / square) > 1
        kind = "saddle" if highest == convex else ("maximum" if highest else "minimum")
        points.append(CriticalPoint(energy, kind, True, False, axes @ np.array([s, 1.0]) / np.sqrt(square)))
    return points


def over_directions(u: Float[np.ndarray, "K 2"], B: np.ndarray, c: np.ndarray) -> tuple[np.ndarray, ...]:
    r"""Return what energy and folds over unit vectors need.

    It is $b = u\cdot Bu$, $p = c\cdot Bu/D$, $s = (c\cdot u^\perp)/\sqrt D$, $\gamma = (c\cdot u)\,b/D$.
    """
    D, Bu = np.linalg.det(B), u @ B
    b = np.einsum("ki,ki->k", u, Bu)
    return b, Bu @ c / D, (u[:, 0] * c[1] - u[:, 1] * c[0]) / np.sqrt(D), (u @ c) * b / D


def fold_energy(B: Float[np.ndarray, "2 2"], c: Float[np.ndarray, "2"]) -> float:
    r"""Return $h^2/2$ times the least energy at which a ray from the identity meets a fold or its ridge.

    With $x = \cot(\theta/2)$ the first fold is the largest root of $x^3 - px^2 - (1 - 2s^2)x + 2\gamma - p$. The energy
    $b\,(x^2 + s^2)/(1 + x^2)^2$ is greatest on the ridge, $x^2 = 1 - 2s^2$, or at half-turns, where it only grows.

    Args:
        B: Inertia along the constraint, symmetric and positive definite.
        c: Coupling.
    """
    values, vectors = np.linalg.eigh(B)
    root = vectors / np.sqrt(values) @ vectors.T  # B^(-1/2)

    def least(angle: Float[np.ndarray, "K"]) -> Float[np.ndarray, "K"]:
        u = np.stack([np.cos(angle), np.sin(angle)], axis=-1) @ root
        b, p, s, gamma = over_directions(u / np.linalg.norm(u, axis=1)[:, None], B, c)
        rows = zip(-p, 2 * s**2 - 1, 2 * gamma - p, strict=True)
        fold = np.array([max(real_cubic_roots(1.0, *map(float, row))[1:]) for row in rows])
        x = np.maximum(fold, np.sqrt(np.maximum(1 - 2 * s**2, 0.0)))
        return b * (x * x + s**2) / (1 + x * x) ** 2

    # angles of B^(1/2) u, sorted: uniform in it and in u, dense around both saddles, which have the least b/kappa
    across = np.array([-c[1], c[0]])
    kappa = np.eye(2) - np.outer(across, across) / np.linalg.det(B)
    top = scipy.linalg.eigh(root @ kappa @ root)[1][:, -1]
    uniform = np.linspace(0.0, 2 * np.pi, _UNIFORM, endpoint=False)
    directions = np.linalg.solve(root, np.stack([np.cos(uniform), np.sin(uniform)]))
    near = np.geomspace(1e-7, 0.3, _NEAR_SADDLE)
    saddle = np.arctan2(top[1], top[0]) + np.concatenate([-near, [0.0], near])
    angles = np.concatenate([uniform, np.arctan2(directions[1], directions[0]), saddle, saddle + np.pi])
    angles = np.unique(angles % (2 * np.pi))

    samples = least(angles)
    low = np.flatnonzero((samples <= np.roll(samples, 1)) & (samples <= np.roll(samples, -1)))
    ends = np.stack([np.roll(angles, 1)[low], np.roll(angles, -1)[low]], axis=1)
    ends[ends[:, 0] > ends[:, 1], 0] -= 2 * np.pi
    search: Any = functools.partial(scipy.optimize.minimize_scalar, method="bounded", options={"xatol": 1e-12})
    minima = [search(lambda a: least(np.array([a]))[0], bounds=pair) for pair in ends]
    return min([float(samples.min()), *(float(minimum.fun) for minimum in minima)])
