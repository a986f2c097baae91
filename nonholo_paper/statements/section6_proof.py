"""Section 6: the proof of the theorem about the asymptotics of the discrete top."""

from nonholo_paper import _suslov_twin as data
from nonholo_paper import _twin as twin
from nonholo_paper._finding import Measured, finding
from nonholo_paper._twin import Matrix, Number, Vector, ctx
from nonholo_paper._verdict import Verdict
from nonholo_paper.formulas import suslov_integrals as formulas
from nonholo_paper.statements.section6_critical_values import critical_points, critical_roots

NOTE = "8 bodies, balanced, tilted, with J1 = J2 among them; 12 displacements, half-turns among them"


@finding(
    "M_1",
    "equation",
    "Section 6, equation (M_1)",
    r"“In view of relations (full) one has $\mathcal{M}_1 = (J_{13}q_1 + J_{23}q_2)[Q + ((J_{11} + J_{33})(J_{22} + "
    r"J_{33}) - J_{12}^2)q_0]$”",
    verdict=Verdict.MISPRINT,
    corrected="It is true of the combination of $M/2$.",
    errata=("S45",),
    tolerance=1e-45,
)
def first() -> Measured:
    """Compare with the combination of momenta of matrices."""
    return _combination(0)


@finding(
    "M_2",
    "equation",
    "Section 6, equation (M_2)",
    r"“In view of relations (full) one has ... $\mathcal{M}_2 = Qq_0 - (J_{13}q_1 + J_{23}q_2)^2$”",
    verdict=Verdict.MISPRINT,
    corrected="It is true of the combination of $M/2$.",
    errata=("S45",),
    tolerance=1e-45,
)
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
    return data.differences(after, before), after


def _side(J: Matrix, q: Vector) -> Number:
    return J[0, 2] * q[1] + J[1, 2] * q[2]


@finding(
    "S41",
    "equation",
    "Section 6, proof of theorem (discr_sus_dyn)",
    r"“in view of (diff_suslov), $\mathcal{M}_{2,k+1} = \mathcal{M}_{2,k} + (J_{13}q_1 + J_{23}q_2)^2$”",
    verdict=Verdict.MISPRINT,
    corrected="It adds $2(J_{13}q_1 + J_{23}q_2)^2$, for the combination of $M/2$; four times the square for that "
    "of $M$.",
    errata=("S41",),
    tolerance=1e-45,
)
def growth_of_second() -> Measured:
    """Compare with the combinations of momenta before and after."""
    right, wrong = [], []
    for J, q, W in data.samples():
        grown = _growth(J, W)[0][1]
        right.append(grown - formulas.growth_of_second(_side(J, q)))
        wrong.append(grown - formulas.printed_growth_of_second(_side(J, q)))
    return Measured(twin.worst(right), twin.worst(wrong), NOTE)


@finding(
    "S42",
    "equation",
    "Section 6, proof of theorem (discr_sus_dyn)",
    r"“$\mathcal{M}_{1,k+1} - \mathcal{M}_{1,k} = -(J_{13}q_1 + J_{23}q_2)Q$ and, therefore, $\mathcal{M}_{1,k+1} = "
    r"(J_{13}q_1 + J_{23}q_2)((J_{11} + J_{33})(J_{22} + J_{33}) - J_{12}^2)q_0$”",
    verdict=Verdict.MISPRINT,
    corrected="It adds $-2sQ$ to the combination of $M/2$, which becomes $s(Dq_0 - Q)$; for the sign $Dq_0 > |Q|$ "
    "is needed.",
    errata=("S42",),
    tolerance=1e-45,
)
def growth_of_first() -> Measured:
    """Compare with the combinations of momenta before and after."""
    right, wrong = [], []
    for J, q, W in data.samples():
        (grown, _), (after, _) = _growth(J, W)
        s, Q = _side(J, q), formulas.stability_form(J, q)
        right += [grown - formulas.growth_of_first(s, Q), after - formulas.next_first(J, q)]
        wrong += [grown - formulas.printed_growth_of_first(s, Q), after - formulas.printed_next_first(J, q)]
    return Measured(twin.worst(right), twin.worst(wrong), NOTE)


@finding(
    "S58",
    "remark",
    "Section 6, proof of theorem (discr_sus_dyn)",
    r"“the part $\mathcal{U}_0$ of the momentum surface $\mathcal{U}$ bounded by the condition $E = ( J_{11} + J_{33}) "
    r"M_1^2 + 2J_{12}M_1M_2 + (J_{22} + J_{33})M_2^2 \le h^*$”",
    verdict=Verdict.MISPRINT,
    corrected="$E \\le 4h^*$: $h^*$ is a value of the integral (quatern_int), of which $E$ is four times.",
    errata=("S58",),
    tolerance=1e-45,
)
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


@finding(
    "S43",
    "remark",
    "Section 6, proof of theorem (discr_sus_dyn)",
    r"“Using the properties $(J_{11} + J_{33})(J_{22} + J_{33}) - J_{12}^2 > 0$, $q_0 \ge 0$, one can show that in "
    r"the domain $\mathcal{U}_0$ the expression in square brackets in (M_1) is positive.”",
    verdict=Verdict.HYPOTHESIS,
    corrected=r"It is positive inside if $\mu_1 < D^2/(c\cdot Bc)$, where $\mu_1 = 4h^*$ of the reduced energy "
    r"$m\cdot B^{-1}m$, $m = M/2$; for this $D > 2|c|^2$ is sufficient.",
    errata=("S43",),
    tolerance=1e-45,
)
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
