"""Section 2, the equations in coordinates: principle, multipliers, energy, evaluated on a skate on an incline."""

from collections.abc import Callable

import numpy as np

from nonholo.groups import SO
from nonholo.systems import LLSystem
from nonholo_paper import _twin as twin
from nonholo_paper._claims import statement
from nonholo_paper._finding import Measured
from nonholo_paper._twin import Matrix, Number, ctx
from nonholo_paper.formulas import general

Path = Callable[[Number], Matrix]

_GRAVITY, _TURN, _HEADING = ctx.mpf("1.5"), ctx.mpf("0.75"), ctx.mpf("0.25")


def _skate(t: Number) -> Matrix:
    """Return (x, y, phi) of a skate on an incline that turns at a constant rate, a solution of its equations."""
    w, phi = _TURN, _HEADING + _TURN * t
    x = _GRAVITY * (ctx.sin(phi) ** 2) / (2 * w**2)
    y = _GRAVITY * (phi - ctx.sin(2 * phi) / 2) / (2 * w**2)
    return twin.column([x, y, phi])


def _skate_lagrangian(q: Matrix, v: Matrix) -> Number:
    return twin.dot(v, v) / 2 + _GRAVITY * q[0]


def _blade(q: Matrix) -> Matrix:
    return twin.column([-ctx.sin(q[2]), ctx.cos(q[2]), 0])


@statement
def ld_eqn() -> Measured:
    """Integrate the first variation along the motion of a skate on an incline, for two admissible variations."""
    totals = []
    for direction in (_along_blade, _about_blade):
        path = _shaped(direction)
        totals.append(ctx.quad(lambda t, path=path: _first_variation(path, t), [0, 1], method="gauss-legendre"))
    return Measured(twin.worst(totals), note="skate on an incline, 2 variations")


def _along_blade(t: Number) -> Matrix:
    phi = _skate(t)[2]
    return twin.column([ctx.cos(phi), ctx.sin(phi), 0])


def _about_blade(t: Number) -> Matrix:
    return twin.column([0, 0, ctx.exp(t)])


def _shaped(direction: Path) -> Path:
    """Return a variation in a direction that vanishes at times 0 and 1."""
    return lambda t: t * t * (1 - t) * direction(t)


def _first_variation(path: Path, t: Number) -> Number:
    q, v, d, moved = _skate(t), twin.rate(_skate, t), path(t), twin.rate(path, t)
    return twin.rate(lambda e: _skate_lagrangian(q + e * d, v + e * moved))


@statement
def constraint_forms() -> Measured:
    """Compare count and pairing of the subspace that the library computes of random forms."""
    generator, defects = np.random.default_rng(3), []
    for n, s in ((3, 1), (3, 2), (6, 1), (6, 4)):
        group = SO({3: 3, 6: 4}[n])
        forms = generator.standard_normal((s, n))
        system = LLSystem(group, inertia_operator=np.eye(n), annihilator=forms)
        rows = system.constraint_subspace
        defects += [abs(len(rows) - (n - s)), abs(forms @ rows.T).max(), abs(np.linalg.matrix_rank(rows) - (n - s))]
    return Measured(twin.both(0.0, max(defects)), note="4 random sets of forms, n = 3 and 6")


@statement
def multiplier_equations() -> Measured:
    """Evaluate both sides along the skate; the multiplier is what remains across the blade."""
    defects = []
    for t in (ctx.mpf(0), ctx.mpf("0.375"), ctx.pi, ctx.mpf(20)):
        q, v = _skate(t), twin.rate(_skate, t)
        slope = twin.column([_GRAVITY, 0, 0])
        left = general.euler_lagrange(twin.rate(lambda s: twin.rate(_skate, s), t), slope)
        form = _blade(q)
        defects += [left - general.reaction([twin.dot(left, form)], [form]), [twin.dot(form, v)]]
    return Measured(twin.worst(*defects), note="skate on an incline at 4 times")


def _curved_lagrangian(q: Matrix, v: Matrix) -> Number:
    """A Lagrangian that is neither quadratic nor even in v."""
    kinetic = (1 + q[0] ** 2) * v[0] ** 2 / 2 + v[1] ** 2 + ctx.exp(q[1]) * v[2] ** 2 / 2 + v[2] ** 4 / 4
    return kinetic + q[1] * v[0] - q[0] * q[2] * v[1] - ctx.cos(q[0] - q[2])


def _slope_v(q: Matrix, v: Matrix) -> Matrix:
    x, y, z = v
    return twin.column([(1 + q[0] ** 2) * x + q[1], 2 * y - q[0] * q[2], ctx.exp(q[1]) * z + z**3])


def _slope_q(q: Matrix, v: Matrix) -> Matrix:
    x, y, z = v
    pull = ctx.sin(q[0] - q[2])
    return twin.column([q[0] * x**2 - q[2] * y + pull, ctx.exp(q[1]) * z**2 / 2 + x, -q[0] * y - pull])


def _curved_energy(q: Matrix, v: Matrix) -> Number:
    return general.energy(_slope_v(q, v), v, _curved_lagrangian(q, v))


def _admissible(seed: int) -> tuple[Matrix, Matrix]:
    q, (x, y) = twin.column(twin.numbers(seed, 3, -2, 2)), twin.numbers(seed + 50, 2, -2, 2)
    return q, twin.column([x, y, q[1] * x])


def _acceleration(q: Matrix, v: Matrix) -> Matrix:
    """Solve (1.1) with the constraint v2 = q1 v0, differentiated once."""
    force = _slope_q(q, v) - twin.rate(lambda t: _slope_v(q + t * v, v))
    masses, form = [1 + q[0] ** 2, 2, ctx.exp(q[1]) + 3 * v[2] ** 2], [-q[1], 0, 1]
    bordered = ctx.diag([*masses, 0])
    for i in range(3):
        bordered[3, i], bordered[i, 3] = form[i], -form[i]
    return ctx.lu_solve(bordered, twin.column([*force, v[1] * v[0]]))[:3]


@statement
def energy_lemma() -> Measured:
    """Differentiate the energy along solutions for a Lagrangian that is neither quadratic nor even in the velocity."""
    rates = []
    for seed in range(6):
        q, v = _admissible(seed)
        a = _acceleration(q, v)
        rates.append(twin.rate(lambda t, q=q, v=v, a=a: _curved_energy(q + t * v, v + t * a)))
    return Measured(twin.worst(rates), note="6 random states with the constraint z' = y x'")


@statement
def energy_equation() -> Measured:
    """Compare with kinetic plus potential energy; terms of first degree in the velocity drop out."""
    defects = []
    for seed in range(6):
        q, v = _admissible(seed)
        quadratic = ((1 + q[0] ** 2) * v[0] ** 2 + 2 * v[1] ** 2 + ctx.exp(q[1]) * v[2] ** 2) / 2
        defects.append(_curved_energy(q, v) - quadratic - 3 * v[2] ** 4 / 4 - ctx.cos(q[0] - q[2]))
        slopes = [
            ctx.diff(lambda s, q=q, v=v, i=i: _curved_lagrangian(q, v + s * ctx.eye(3)[:, i]), 0) for i in range(3)
        ]
        defects += list(twin.column(slopes) - _slope_v(q, v))
    return Measured(twin.worst(defects), note="6 random states")
