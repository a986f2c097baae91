"""Section 6: invariant curves of the top of three dimensions, their components, and the choice of a branch."""

import itertools

import numpy as np

import nonholo as nh
from nonholo_paper import _suslov_twin as data
from nonholo_paper import _twin as twin
from nonholo_paper._claims import statement
from nonholo_paper._finding import Measured
from nonholo_paper._twin import Matrix, Number, Vector, ctx
from nonholo_paper.formulas import suslov_integrals as formulas
from nonholo_paper.statements.section6_critical_values import GENERIC, critical_points, critical_roots

_FLAT = [[1.645907, -0.975937, -0.176582], [-0.975937, 0.591716, 0.106159], [-0.176582, 0.106159, 0.028912]]


@statement
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


@statement
def level_curves() -> Measured:
    """Count components of the library's curves, compare energies with the largest; printed: how many too many."""
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
    counts = _components_of_a_long_body()
    facts.append(counts == [2, 3, 3, 2])
    return Measured(data.lacking(*facts), max(counts) - 2, "three bodies, four energies; 12 displacements; a long body")


def _components_of_a_long_body() -> list[int]:
    """Return the numbers of components below, twice above its third minimum, and above the saddles on the equator."""
    top = nh.discretize(nh.SuslovTop([[2.2, 0.0, 0.45], [0.0, 0.25, 0.0], [0.45, 0.0, 0.35]]), 1.0)
    points = nh.critical_energies(top).points
    third = max(p.energy for p in points if p.kind == "minimum")
    side, saddle = sorted({round(p.energy, 9) for p in points if p.kind == "saddle"})
    energies = (0.9 * third, 0.9 * third + 0.1 * side, 0.1 * third + 0.9 * side, (side + saddle) / 2)
    return [len(nh.invariant_curve(top, E, 200).components) for E in energies]


def _double_points(J: Matrix, angle: Number) -> list[tuple[Matrix, Matrix]]:
    """Return pairs n, n' whose displacements have one momentum."""
    pairs = []
    _, vectors = ctx.eig(J * ctx.diag([1, 1, -1]))
    unit = [ctx.matrix(data.unit([ctx.re(x) for x in vectors[:, k]])) for k in range(3)]
    for i, k in itertools.combinations(range(3), 2):
        _, axes = ctx.eigsy(unit[i] * unit[i].T - unit[k] * unit[k].T)
        u, w = axes[:, 0], axes[:, 2]
        for s in (1, -1):
            turned = s * ctx.sin(angle)
            pairs.append((ctx.cos(angle) * u + turned * w, turned * u + ctx.cos(angle) * w))
    return pairs


def _reflected(n: Matrix) -> Matrix:
    """Return the displacement of a unit vector, two reflections: by twice its angle with e3."""
    return (ctx.eye(3) - 2 * n * n.T) * ctx.diag([1, 1, -1])


def _outside(J: Matrix, n: Matrix) -> Number:
    """Return by how much the squared sine of half the angle of a displacement is beyond that of the largest energy."""
    return n[0] ** 2 + n[1] ** 2 - formulas.ridge(J, data.unit([n[0], n[1]]))


@statement
def meeting_ovals() -> Measured:
    """Compare momenta of pairs below h*; printed: how far, at least, one is inside and one outside of the ridge."""
    exact, apart, lowest = [], [], []
    for name in (*data.REGULAR, "balanced"):
        J, levels = data.body(name), []
        low = critical_roots(J)[0] / 4
        for pair in itertools.chain(*(_double_points(J, ctx.mpf(angle)) for angle in (0.01, 0.2, 0.5, 0.7))):
            momenta = [data.momentum(J, _reflected(n)) for n in pair]
            exact += twin.differences(*momenta)
            sides, level = [_outside(J, n) for n in pair], data.reduced_energy(J, momenta[0]) / low
            if level < 1 and sides[0] * sides[1] < 0:
                apart.append(float(min(map(abs, sides))))
                levels.append(level)
        lowest.append(min(levels) < (0.001 if name == "balanced" else 0.1) and max(levels) > 0.9)
    return Measured(max(twin.worst(exact), data.lacking(*lowest)), min(apart), "three bodies, 24 double points each")


@statement
def outer_oval() -> Measured:
    """Evaluate the energy at half-turns, and the distance of the curve from them; printed: from opposite ones."""
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
    result = (nh.branches(top, displacement=W) for component in curve.displacement for W in component)
    return tuple(int(values.is_real.sum()) for values in result)


@statement
def between() -> Measured:
    """Count real values of the library on two curves of two bodies: none occurs, and two or four."""
    counts = [_complex_after(name, share) for name in data.REGULAR for share in (0.3, 0.7)]
    facts = [0 in result and set(result) <= {0, 2, 4} and max(result) > 0 for result in counts]
    return Measured(data.lacking(*facts), note="two bodies, two energies")


@statement
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
    result = nh.displacements_over(flat, [-0.3268, 0.1668])
    return result.region.tolist().count("inner") if result.energy > nh.critical_energies(flat).fold else 0
