"""Section 6: invariant curves of the top of three dimensions, their components, and the choice of a branch."""

import itertools

import numpy as np

import nonholo as nh
from nonholo_paper import _suslov_twin as data
from nonholo_paper import _twin as twin
from nonholo_paper._finding import Measured, finding
from nonholo_paper._twin import Matrix, Number, Vector, ctx
from nonholo_paper._verdict import Verdict
from nonholo_paper.formulas import suslov_integrals as formulas
from nonholo_paper.statements.section6_critical_values import GENERIC, critical_points

_FLAT = [[1.645907, -0.975937, -0.176582], [-0.975937, 0.591716, 0.106159], [-0.176582, 0.106159, 0.028912]]


@finding(
    "quatern_int",
    "equation",
    "Section 6, invariant curves of (quatern_int): degree",
    "“Thus, the invariant varieties are algebraic curves of order 8.”",
    verdict=Verdict.REMARK,
    corrected="So they are on the sphere and in the space of momenta. On the projective plane of displacements, "
    "which the sphere covers twice, they are quartics.",
    tolerance=1e-45,
)
def degree() -> Measured:
    """Restrict the quartic and its level to a projective line, and find the degree from finite differences."""
    missed, degrees = [], []
    for J, seed in itertools.product(data.bodies(), (1, 2)):
        a, b = twin.numbers(seed, 3), twin.numbers(seed + 9, 3)
        level = formulas.quartic(J, data.unit(twin.numbers(seed + 20, 3)))
        values = [_restricted(J, [x + t * y for x, y in zip(a, b, strict=True)], level) for t in range(8)]
        differences = [ctx.fsum(_binomial(k, i) * values[i] for i in range(k + 1)) for k in range(8)]
        missed += differences[5:]
        degrees.append(max(k for k in range(8) if abs(differences[k]) > 1e-9))
    facts = [k == 4 for k in degrees]
    return Measured(max(twin.worst(missed), data.lacking(*facts)), 8 - max(degrees), "8 bodies, two lines each")


def _restricted(J: Matrix, q: Vector, level: Number) -> Number:
    return formulas.quartic(J, q) - level * sum(x * x for x in q) ** 2


def _binomial(k: int, i: int) -> Number:
    return (-1) ** (k - i) * ctx.binomial(k, i)


@finding(
    "level-curves",
    "remark",
    "Section 6, invariant curves",
    r"Below $h^*$ the curve has two components, one around the origin; they meet at $h^*$; at $h^{**}$ the curve "
    r"shrinks to two opposite points, and there is none above.",
    tolerance=1e-45,
)
def level_curves() -> Measured:
    """Count components of the library's curves, and compare energies of random displacements with the largest."""
    facts = []
    for name in GENERIC:
        J, top = data.body(name), data.discrete(data.body(name))
        (low, _), (high, center) = critical_points(J)
        energies = [2 * float(x) for x in (0.3 * low, 0.999 * low, (low + high) / 2, 1.001 * high)]
        facts += [
            len(nh.invariant_curve(top, E, 60).components) == k for E, k in zip(energies, (2, 2, 2, 0), strict=True)
        ]
        facts += [data.energy(J, q) <= high for q in data.points()]
        inner = nh.invariant_curve(top, energies[0], 60).components[0]
        angle = np.unwrap(np.arctan2(inner[:, 2], inner[:, 1]))
        facts += [abs(np.ptp(angle) - 2 * np.pi) < 0.3, data.energy(J, center) > 0.99 * high]
    return Measured(data.lacking(*facts), note="three bodies, four energies; 12 displacements")


@finding(
    "outer-oval",
    "remark",
    "Section 6, invariant curves: small values",
    r"“for small positive values of $h$ one branch is a small oval around the origin $(0,0)$ whereas the other "
    r"branch is an oval close to the equator $\{q_0=0\}$ of the sphere. It may or may not intersect the equator.”",
    verdict=Verdict.REMARK,
    corrected="For small $h$ it does: it is a small oval around the one half-turn with $J_{13}q_1 + J_{23}q_2 = "
    "0$, where the integral vanishes; elsewhere on the equator it does not.",
    tolerance=1e-45,
)
def outer_oval() -> Measured:
    """Evaluate the energy at half-turns, and how far the curve is from them; printed: from the opposite half-turn."""
    exact, facts, far = [], [], []
    for name in data.REGULAR:
        J = data.body(name)
        zero = data.unit([0, -J[1, 2], J[0, 2]])
        exact.append(data.energy(J, zero))
        opposite = [ctx.mpf(0), -zero[2], zero[1]]
        facts.append(data.energy(J, opposite) > 0.1)
        curve = nh.invariant_curve(data.discrete(J), 1e-6, 40).components[1]
        quaternions = curve[:, [0, 2, 1]] * [1, -1, 1]
        facts.append(np.abs(quaternions @ [float(x) for x in zero]).min() > 1 - 1e-5)
        far.append(1 - np.abs(quaternions @ [float(x) for x in opposite]).max())
    return Measured(max(twin.worst(exact), data.lacking(*facts)), min(far), "two bodies, h = 1e-6")


def _complex_after(name: str, share: float) -> tuple[int, ...]:
    """Return the numbers of real values after displacements of one energy between the critical ones."""
    top = data.discrete(data.body(name))
    (low, _), (high, _) = critical_points(data.body(name))
    curve = nh.invariant_curve(top, float(2 * low + 2 * share * (high - low)), 8)
    found = (nh.branches(top, displacement=W) for component in curve.displacement for W in component)
    return tuple(int(values.is_real.sum()) for values in found)


@finding(
    "between-the-separatrices",
    "remark",
    "Section 6, remark on the choice of a branch",
    r"Between the separatrices, $h^* < h < h^{**}$, all values after a real point may be complex.",
    tolerance=1e-45,
)
def between() -> Measured:
    """Count real values of the library on two curves of two bodies: none occurs, and two or four."""
    counts = [_complex_after(name, share) for name in data.REGULAR for share in (0.3, 0.7)]
    facts = [0 in found and set(found) <= {0, 2, 4} and max(found) > 0 for found in counts]
    return Measured(data.lacking(*facts), note="two bodies, two energies")


@finding(
    "S49",
    "remark",
    "Section 6, remark on the choice of a branch",
    r"“have to belong to the same connected component of the invariant curve. In other words, if the initial point "
    r"lies in the interior (exterior) part of $\mathcal{S}$, one has to choose a real solution of (sys) that has "
    r"the smallest (largest) norm”",
    verdict=Verdict.FALSE,
    corrected=r"For $D > 2|c|^2$ inside there is always a value, and only one below the first fold $h_f$, "
    r"$\frac{125}{128}h^* < h_f \le h^*$, which is $h^*$ if $D \ge 3|c|^2$; from $h_f$ on there may be three. Outside "
    r"there are one or three: the body with four real values has three outside, at $E < h^*$.",
    errata=("S49",),
    tolerance=1e-45,
)
def components() -> Measured:
    """Count values inside and outside the ridge of the energy; printed: values outside above one."""
    facts, outside = [], []
    for name, y in [*data.STEPS[::2], ("generic", (0.2, 0.1)), ("four branches", (0.1, -0.3))]:
        J = data.body(name)
        below = data.energy(J, data.point_of([ctx.mpf(v) for v in y])) < critical_points(J)[0][0]
        real = [v for v in data.successors(name, y) if ctx.im(v[0]) == 0 and ctx.im(v[1]) == 0]
        sides = [1 - data.point_of(v)[0] ** 2 < formulas.ridge(J, data.unit(v)) for v in real]
        facts += [below, sum(sides) == 1, len(sides) - sum(sides) in (1, 3)]
        outside.append(len(sides) - sum(sides))
    facts.append(_inside_a_flat_body() == 3)
    return Measured(data.lacking(*facts), max(outside) - 1, "four displacements of two bodies, one of a flat body")


def _inside_a_flat_body() -> int:
    """Count inner values, which lie below the saddle, of a momentum above the first fold of a body with D < 3|c|^2."""
    flat = nh.discretize(nh.SuslovTop(_FLAT), 1.0)
    found = nh.displacements_over(flat, [-0.3268, 0.1668])
    return found.region.tolist().count("inner") if found.energy > nh.critical_energies(flat).fold else 0
