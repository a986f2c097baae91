"""Section 6: the quartic integral of the discrete top and its critical values."""

import nonholo as nh
from nonholo_paper import _suslov_twin as data
from nonholo_paper import _twin as twin
from nonholo_paper._claims import statement
from nonholo_paper._finding import Measured
from nonholo_paper._twin import Matrix, Number, Vector, ctx
from nonholo_paper.formulas import suslov_integrals as formulas

GENERIC = (*data.REGULAR, "flat")


@statement
def quartic() -> Measured:
    """Compare with the quadratic form at momenta of matrices."""
    right, wrong = [], []
    for J, q, W in data.samples():
        H, value = formulas.quartic(J, q), formulas.quadratic(J, data.momentum(J, W))
        right.append(value - formulas.quadratic_of_quartic(H))
        wrong.append(value - formulas.printed_quadratic_of_quartic(H))
    return Measured(twin.worst(right), twin.worst(wrong), "8 bodies, 12 displacements")


def _point(u: Vector, rho: Number) -> Vector:
    """Return the displacement with direction u = (z1, z2) and squared sine rho of the half-angle."""
    sine = ctx.sqrt(rho)
    return [ctx.sqrt(1 - rho), -sine * u[1], sine * u[0]]


def _slopes(J: Matrix, q: Vector) -> list[Number]:
    """Return the derivatives of the energy at a point along two tangents of the sphere."""
    tangents = (data.unit([0, -q[2], q[1]]), data.unit([-(q[1] ** 2) - q[2] ** 2, q[0] * q[1], q[0] * q[2]]))
    moved = []
    for t in tangents:

        def value(e: Number, t: Vector = t) -> Matrix:
            return ctx.matrix([data.energy(J, [ctx.cos(e) * a + ctx.sin(e) * b for a, b in zip(q, t, strict=True)])])

        moved.append(data.slope(value)[0])
    return moved


def critical_roots(J: Matrix) -> tuple[Number, Number]:
    """Return four times the critical values off the equator."""
    a, b, c = formulas.critical_equation(J)
    root = ctx.sqrt(b * b - 4 * a * c)
    return (-b - root) / (2 * a), (-b + root) / (2 * a)


def critical_points(J: Matrix) -> list[tuple[Number, Vector]]:
    """Return the two critical values off the equator, from low to high, with their points."""
    result = []
    for mu in critical_roots(J):
        u = data.unit(formulas.critical_direction(J, mu))
        result.append((mu / 4, _point(u, formulas.ridge(J, u))))
    return result


def _equatorial(J: Matrix) -> tuple[Number, Vector]:
    """Return the highest critical half-turn: the library's, refined, and its value."""
    reference = [p for p in nh.critical_energies(data.discrete(J)).points if p.on_equator]
    z = max(reference, key=lambda p: p.energy).half_turn_vector
    ratio = ctx.findroot(lambda t: formulas.equatorial_cubic(J, [t, 1]), z[0] / z[1], tol=1e-90, verify=False)
    u = data.unit([ratio, 1])
    return formulas.equatorial_value(J, u), _point(u, ctx.mpf(1))


@statement
def critical_values() -> Measured:
    """Differentiate the energy of matrices at the points; compare values with it and with the library; count them."""
    exact, library, counts = [], [], []
    for name in (*GENERIC, "tilted"):
        J = data.body(name)
        (low, saddle), (high, center), (side, half_turn) = *critical_points(J), _equatorial(J)
        for value, q in ((low, saddle), (high, center), (side, half_turn)):
            exact += [value - data.energy(J, q), *_slopes(J, q)]
        reference = nh.critical_energies(data.discrete(J))
        expected = [reference.saddle, reference.center, reference.equatorial_saddle]
        library += [2 * a - b for a, b in zip((low, high, side), expected, strict=True)]
        counts.append(sum(x > 1e-6 for x in (side, low - side, high - low)))
    library += [2 - _saddles_of_a_long_body()]
    return Measured(twin.both(twin.worst(exact), twin.worst(library)), max(counts) - 2, "four bodies; a long one")


def _saddles_of_a_long_body() -> int:
    """Count the equatorial saddles that surround a third minimum."""
    top = nh.SuslovTop([[3.0, 0.02, 0.1], [0.02, 0.1, 0.01], [0.1, 0.01, 0.2]])
    points = [p for p in nh.critical_energies(nh.discretize(top, 1.0)).points if p.on_equator and p.energy > 0]
    return sum(p.kind == "saddle" for p in points) if "minimum" in {p.kind for p in points} else 0


@statement
def regular_regime() -> Measured:
    """Look for saddles and centers of regular bodies; printed: excess over 1 of the squared sine of a rod's saddle."""
    facts = []
    for seed in range(60):
        J = data.random_body(seed, 3)
        if formulas.determinant(J) > 2 * formulas.coupling_square(J):
            facts += [_squared_sine(J, mu) < 1 for mu in critical_roots(J)]
    rod = data.body("tilted rod")
    excess = _squared_sine(rod, critical_roots(rod)[0]) - 1
    facts += [len(facts) > 50, formulas.determinant(rod) > 0]
    tilted = data.body("tilted")
    facts += [_squared_sine(tilted, mu) < 1 for mu in critical_roots(tilted)]
    facts.append(formulas.determinant(tilted) < 2 * formulas.coupling_square(tilted))
    facts.append(nh.critical_energies(data.discrete(rod)).saddle is None)
    return Measured(data.lacking(*facts), float(excess), "the regular ones of 60 random bodies; a tilted rod")


def _squared_sine(J: Matrix, mu: Number) -> Number:
    return formulas.ridge(J, data.unit(formulas.critical_direction(J, mu)))


@statement
def tangent_cylinders() -> Measured:
    """Multiply the normal of the cylinder with tangents of the surface at the critical points."""
    missed = []
    for name in GENERIC:
        J = data.body(name)
        for _, q in critical_points(J):
            M = data.momentum(J, data.rotation(q))
            normal = [ctx.diff(lambda x, M=M, J=J: formulas.quadratic(J, [x, M[1]]), M[0])]
            normal.append(ctx.diff(lambda y, M=M, J=J: formulas.quadratic(J, [M[0], y]), M[1]))
            for t in ([0, -q[2], q[1]], [-(q[1] ** 2) - q[2] ** 2, q[0] * q[1], q[0] * q[2]]):
                along = data.slope(lambda e, q=q, t=t, J=J: _momentum(J, q, t, e))
                missed.append(normal[0] * along[0] + normal[1] * along[1])
    return Measured(twin.worst(missed), note="three bodies, two critical points each")


def _momentum(J: Matrix, q: Vector, tangent: Vector, e: Number) -> Matrix:
    return ctx.matrix(data.momentum(J, data.rotation(data.unit([a + e * b for a, b in zip(q, tangent, strict=True)]))))


@statement
def stationary_center() -> Measured:
    """Take a critical point of an aligned body that is repeated; count such points, of generic bodies too."""
    J, half = data.body("aligned"), ctx.sqrt(ctx.mpf(1) / 2)
    q = [half, ctx.mpf(0), half]
    W = data.rotation(q)
    moved = twin.differences(data.turned(J, W)[:2], data.momentum(J, W)[:2])
    right = [*moved, *_slopes(J, q)]
    facts = []
    for name in GENERIC:
        J = data.body(name)
        for _, point in critical_points(J):
            W = data.rotation(point)
            change = twin.differences(data.turned(J, W)[:2], data.momentum(J, W)[:2])
            facts.append(twin.worst(change) > 1e-6)
        center = data.array(data.rotation(critical_points(J)[1][1]))
        facts.append(not nh.branches(data.discrete(J), displacement=center).is_real.any())
    printed = float(twin.worst(right) < 1e-45)
    return Measured(max(twin.worst(right), data.lacking(*facts)), printed, "printed: stationary centers of one body")
