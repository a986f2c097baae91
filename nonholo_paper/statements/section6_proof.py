"""Section 6: the proof of the theorem about the asymptotics of the discrete top."""

from nonholo_paper import _suslov_twin as data
from nonholo_paper import _twin as twin
from nonholo_paper._claims import statement
from nonholo_paper._finding import Measured
from nonholo_paper._twin import Matrix, Number, Vector, ctx
from nonholo_paper.formulas import suslov_integrals as formulas
from nonholo_paper.formulas import suslov_momenta
from nonholo_paper.statements.section6_critical_values import critical_points, critical_roots

NOTE = "8 bodies, balanced, tilted, with J1 = J2 among them; 12 displacements, half-turns among them"


@statement
def first() -> Measured:
    """Compare with the combination of momenta of matrices."""
    return _combination(0)


@statement
def second() -> Measured:
    """Compare with the combination of momenta of matrices."""
    return _combination(1)


def _combination(which: int) -> Measured:
    right, wrong = [], []
    for J, q, W in data.samples():
        M = data.momentum(J, W)
        value = formulas.second_of_point(J, q) if which else formulas.first_of_point(J, q)
        right.append(formulas.combinations(J, formulas.scaled(M))[which] - value)
        wrong.append(formulas.combinations(J, M)[which] - value)
    return Measured(twin.worst(right), twin.worst(wrong), NOTE)


def _growth(J: Matrix, W: Matrix) -> tuple[Vector, Vector]:
    """Return what a step adds to the combinations of half the momenta, and their new values."""
    before = formulas.combinations(J, formulas.scaled(data.momentum(J, W)))
    after = formulas.combinations(J, formulas.scaled(data.turned(J, W)))
    return twin.differences(after, before), after


@statement
def growth_of_second() -> Measured:
    """Compare with the combinations of momenta before and after."""
    right, wrong = [], []
    for J, q, W in data.samples():
        grown = _growth(J, W)[0][1]
        right.append(grown - formulas.growth_of_second(suslov_momenta.slope(J, q)))
        wrong.append(grown - formulas.printed_growth_of_second(suslov_momenta.slope(J, q)))
    return Measured(twin.worst(right), twin.worst(wrong), NOTE)


@statement
def growth_of_first() -> Measured:
    """Compare with the combinations of momenta before and after."""
    right, wrong = [], []
    for J, q, W in data.samples():
        (grown, _), (after, _) = _growth(J, W)
        s, Q = suslov_momenta.slope(J, q), formulas.stability_form(J, q)
        right += [grown - formulas.growth_of_first(s, Q), after - formulas.next_first(J, q)]
        wrong += [grown - formulas.printed_growth_of_first(s, Q), after - formulas.printed_next_first(J, q)]
    return Measured(twin.worst(right), twin.worst(wrong), NOTE)


@statement
def bound_of_the_domain() -> Measured:
    """Evaluate both integrals at the saddles, where (quatern_int) is h*; printed: by how much E is beyond."""
    right, wrong = [], []
    for name in (*data.REGULAR, "flat"):
        J = data.body(name)
        (_, q), _ = critical_points(J)
        E, h = formulas.quadratic(J, data.momentum(J, data.rotation(q))), formulas.quartic(J, q)
        right.append(E - formulas.quadratic_of_quartic(h))
        wrong.append(float(E / formulas.printed_quadratic_of_quartic(h) - 1))
    return Measured(twin.worst(right), min(wrong), "saddles of three bodies")


@statement
def positive_bracket() -> Measured:
    """Evaluate it inside for regular bodies; printed: its negative share of D at a point inside of a tilted body."""
    facts, lowest = [], []
    for seed in range(10):
        J = data.random_body(seed, 3)
        if formulas.determinant(J) > 2 * formulas.coupling_square(J):
            mu = critical_roots(J)[0]
            facts.append(mu < formulas.determinant(J) ** 2 / formulas.coupling_form(J))
            lowest += [formulas.bracket(J, q) for q in _inside(J, mu / 4)]
    J = data.body("tilted")
    mu, D = critical_roots(J)[0], formulas.determinant(J)
    u = data.unit(formulas.critical_direction(J, mu))
    rho = formulas.ridge(J, u) * ctx.mpf("0.97")
    q = min((_on_ray(rho, u, sign) for sign in (1, -1)), key=lambda q: formulas.bracket(J, q))
    facts += [len(lowest) > 10, rho < 1, D > 0, min(ctx.eigsy(J, eigvals_only=True)) > 0]
    facts += [data.energy(J, q) < mu / 4, mu > D**2 / formulas.coupling_form(J)]
    defect = max(data.lacking(*facts), *(float(max(-value, 0)) for value in lowest))
    return Measured(defect, float(-formulas.bracket(J, q) / D), "the regular ones of 10 random bodies; a tilted body")


def _on_ray(rho: Number, u: Vector, sign: int) -> Vector:
    return [ctx.sqrt(1 - rho), -sign * ctx.sqrt(rho) * u[1], sign * ctx.sqrt(rho) * u[0]]


def _inside(J: Matrix, level: Number) -> list[Vector]:
    """Return displacements inside the ridge whose energy is below a level."""
    directions = [[ctx.cos(angle), ctx.sin(angle)] for angle in ctx.linspace(0, 2 * ctx.pi, 6)]
    rays = [(formulas.ridge(J, u) * share, u) for u in directions for share in (ctx.mpf("0.3"), ctx.mpf("0.95"))]
    points = [_on_ray(rho, u, 1) for rho, u in rays]
    return [q for q in points if data.energy(J, q) < level]
