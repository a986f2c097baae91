"""Section 6: the map of displacements of the top of three dimensions, in three steps."""

from nonholo_paper import _suslov_twin as data
from nonholo_paper import _twin as twin
from nonholo_paper._claims import statement
from nonholo_paper._finding import Measured
from nonholo_paper._twin import Matrix, Number, Vector, ctx
from nonholo_paper.formulas import suslov_momenta as formulas

NOTE = "all four values after three displacements, two bodies"


@statement
def system() -> Measured:
    """Evaluate the equations at all values of the map."""
    right, wrong = [], []
    for name, y in data.STEPS:
        J = data.body(name)
        target = data.turned(J, data.cayley(y))
        for after in data.successors(name, y):
            q, M = data.point_of(after), data.momentum(J, data.cayley(after))
            right += twin.differences([*formulas.restricted(J, q), formulas.last(J, q)], [*target[:2], M[2]])
            wrong += twin.differences(
                [*formulas.printed_restricted(J, q), formulas.printed_last(J, q)], [*target[:2], M[2]]
            )
    return Measured(twin.worst(right), twin.worst(wrong), NOTE)


@statement
def last_momentum() -> Measured:
    """Compare with (full); printed: components of the momentum that (sys) lacks."""
    right, lacking = [], []
    for J, q, W in data.samples():
        M = data.momentum(J, W)
        right += twin.differences([*formulas.restricted(J, q), formulas.last(J, q)], formulas.momentum(J, q))
        right.append(formulas.last(J, q) - M[2])
        lacking.append(len(M) - len(formulas.printed_restricted(J, q)))
    return Measured(twin.worst(right), max(lacking), "8 bodies, 12 displacements")


@statement
def complex_values() -> Measured:
    """Count the values and their distances; compare each level with the eigenvalues of its quadratic form."""
    facts = []
    for name, y in data.STEPS:
        J, result = data.body(name), data.successors(name, y)
        facts += [len(result) == 4]
        facts += [abs(a[0] - b[0]) + abs(a[1] - b[1]) > 1e-2 for k, a in enumerate(result) for b in result[:k]]
        target = data.turned(J, data.cayley(y))
        for i in (0, 1):
            low, middle, high = ctx.eigsy(_form(J, i), eigvals_only=True)
            facts += [low < target[i] < high, abs(target[i] - middle) > 1e-6]
    return Measured(data.lacking(*facts), note=NOTE)


def _form(J: Matrix, i: int) -> Matrix:
    """Return the matrix of a right side of (sys) as a quadratic form."""
    unit = ctx.eye(3).tolist()

    def value(q: Vector) -> Number:
        return formulas.restricted(J, q)[i]

    S = ctx.matrix(3)
    for a in range(3):
        for b in range(3):
            both = [x + y for x, y in zip(unit[a], unit[b], strict=True)]
            S[a, b] = (value(both) - value(unit[a]) - value(unit[b])) / 2
    return S


@statement
def small_value() -> Measured:
    """Count the values whose half-angle has a tangent below 0.1 after rotations with tangent 0.01."""
    facts = []
    for name in (*data.REGULAR, "aligned", "tilted rod"):
        result = data.successors(name, (0.008, -0.006))
        facts.append(sum(abs(y[0]) + abs(y[1]) < 0.1 for y in result) == 1)
    return Measured(data.lacking(*facts), note="four bodies")
