"""Section 6: the displacements that the constraint admits, in any dimension."""

import nonholo as nh
from nonholo.groups import SO
from nonholo_paper import _suslov_twin as data
from nonholo_paper import _twin as twin
from nonholo_paper._claims import statement
from nonholo_paper._finding import Measured
from nonholo_paper._twin import Matrix, Number, Vector, ctx
from nonholo_paper.formulas import suslov_continuous
from nonholo_paper.formulas import suslov_displacements as formulas

DIMENSIONS = (3, 4, 6)
NOTE = "n = 3, 4, 6; random angles, 0, almost pi, pi, more than a full turn"


def _arguments() -> list[tuple[Number, Vector]]:
    """Return angles with unit vectors of several dimensions."""
    angles = [ctx.mpf("0.7"), ctx.mpf(0), ctx.pi - ctx.mpf("1e-20"), +ctx.pi, ctx.mpf(-2), ctx.mpf(9)]
    return [(angle, data.unit(twin.numbers(n + k, n - 1))) for n in DIMENSIONS for k, angle in enumerate(angles)]


def _rotation(angle: Number, u: Vector) -> Matrix:
    return twin.exp(data.wedge([angle * x for x in u]))


def _reflection(seed: int, n: int, dimension: int) -> Matrix:
    """Return a rotation with the symmetries (sp): diag(1, .., 1, -1) times a reflection in a random subspace."""
    columns = ctx.matrix(n, dimension)
    for k, x in enumerate(twin.numbers(seed, n * dimension)):
        columns[k % n, k // n] = x
    projector = columns * (columns.T * columns) ** -1 * columns.T
    return ctx.diag([1] * (n - 1) + [-1]) * (ctx.eye(n) - 2 * projector)


@statement
def symmetries() -> Measured:
    """Evaluate the differences on exponentials; on rotations of dimension 3 they are not zero identically."""
    missed = [x for angle, u in _arguments() for x in formulas.asymmetries(_rotation(angle, u))]
    general = data.attitude(2, 3)
    both = [general[1, 0] - general[0, 1], general[0, 2] + general[2, 0], general[1, 2] + general[2, 1]]
    missed += twin.differences(formulas.asymmetries(general), both)
    return Measured(twin.worst(missed), note=NOTE)


@statement
def structure() -> Measured:
    """Evaluate the trace on exponentials, rebuild them from (sp) and the trace, and take reflections that fail."""
    right = [formulas.reflected_trace(_rotation(angle, u)) for angle, u in _arguments()]
    wrong, reference = [], []
    for n in (3, 4, 5, 6):
        line, space = _reflection(n, n, 1), _reflection(n, n, 3)
        right += [*formulas.asymmetries(line), *formulas.asymmetries(space), formulas.reflected_trace(line)]
        right += list(line - _from_symmetries(line))
        wrong.append(formulas.reflected_trace(space))
        reference += [bool(nh.in_exp_d(data.array(line))), not nh.in_exp_d(data.array(space))]
    wrong.append(formulas.reflected_trace(ctx.diag([-1, -1, 1])))
    return Measured(
        max(twin.worst(right), data.lacking(*reference)), twin.worst(wrong), "reflections in 1 and 3 dimensions"
    )


def _from_symmetries(W: Matrix) -> Matrix:
    """Return the exponential whose vectors z0 and z are those of W."""
    last = W.rows - 1
    z0 = ctx.sqrt((1 + W[last, last]) / 2)
    sine = ctx.sqrt((1 - W[last, last]) / 2)
    angle = 2 * ctx.atan2(sine, z0)
    return _rotation(angle, [W[i, last] / (2 * z0 * sine) for i in range(last)])


@statement
def projective_space() -> Measured:
    """Read the products of coordinates off a rotation: they fix the point up to its sign; count the group."""
    missed = []
    for angle, u in _arguments():
        z0, z = formulas.half_angles(angle, u)
        W, last = _rotation(angle, u), len(u)
        missed += [W - formulas.displacement(z0, z), W - formulas.displacement(-z0, [-x for x in z])]
        missed.append([(1 + W[last, last]) / 2 - z0**2] + [W[i, last] / 2 - z0 * x for i, x in enumerate(z)])
        missed.append([((i == j) - W[i, j]) / 2 - z[i] * z[j] for i in range(last) for j in range(last)])
    small_elements_of_a_lattice, signs = [(i, j) for i in (-1, 0, 1) for j in (-1, 0, 1)], [1, -1]
    printed = len(small_elements_of_a_lattice) - len(signs)
    return Measured(twin.worst(*missed), printed, NOTE + "; printed: elements of the group that are too many, at least")


@statement
def index_of_time() -> Measured:
    """Take a step of the map that is not an equilibrium: the next components differ, those of the inverse do not."""
    name, y = data.STEPS[0]
    z = data.point_of(data.successors(name, y)[0])
    moved = twin.worst(twin.differences(z, data.point_of([ctx.mpf(v) for v in y])))
    return Measured(data.lacking(moved > 1e-6), note="one step of a generic top")


@statement
def parametrization() -> Measured:
    """Compare with the matrix exponential, and the library's exponential with both."""
    exact, library = [], []
    for angle, u in _arguments():
        W, n = formulas.displacement(*formulas.half_angles(angle, u)), len(u) + 1
        exact.append(W - _rotation(angle, u))
        generator = twin.vee(SO(n), data.wedge([angle * x for x in u]))
        library += list((SO(n).exp(data.array(ctx.matrix(generator)).ravel()) - data.array(W)).ravel())
    return Measured(twin.both(twin.worst(*exact), twin.worst(library)), note=NOTE)


@statement
def half_angles() -> Measured:
    """Compare with the half of the rotation: the rotation by half of the angle takes e_n to (z, z0)."""
    missed = []
    for angle, u in _arguments():
        z0, z = formulas.half_angles(angle, u)
        image = _rotation(angle / 2, u)[:, len(u)]
        missed += twin.differences([*z, z0], image)
    return Measured(twin.worst(missed), note=NOTE)


@statement
def columns() -> Measured:
    """Compare with the matrix exponential applied to the vectors."""
    missed = []
    for angle, u in _arguments():
        W, n = _rotation(angle, u), len(u) + 1
        along, last = ctx.matrix([*u, 0]), ctx.eye(n)[:, n - 1]
        missed += [W * along - formulas.image_along(angle, along, last)]
        missed += [W[:, n - 1] - formulas.image_of_last(angle, along, last)]
        missed += [W[:, j] - formulas.image_across(angle, along, last, j) for j in range(n - 1)]
    return Measured(twin.worst(*missed), note=NOTE)


@statement
def half_angle_signs() -> Measured:
    """Compare sines and cosines; the two rotations are compared as matrix exponentials."""
    right, wrong = [], []
    for angle, u in _arguments():
        definition = [ctx.sin(angle / 2), ctx.cos(angle / 2)]
        right += twin.differences(definition, formulas.other_half_angle(angle))
        wrong.append(definition[0] - formulas.printed_other_sine(angle))
        right += list(_rotation(angle, u) - _rotation(2 * ctx.pi - angle, [-x for x in u]))
    return Measured(twin.worst(right), twin.worst(wrong), NOTE)


@statement
def linearized() -> Measured:
    """Differentiate the conditions along one-parameter groups of all rotations."""
    missed = []
    for n in DIMENSIONS:
        X = twin.hat(SO(n), twin.numbers(n + 1, SO(n).dim))
        slope = data.slope(lambda e, X=X: ctx.matrix(formulas.asymmetries(twin.exp(e * X))))
        allowed = [2 * X[i, j] for i in range(n - 1) for j in range(i)] + [0] * (n - 1)
        missed += twin.differences(slope, allowed)
    return Measured(twin.worst(missed), note="n = 3, 4, 6, random generators")


@statement
def trace_form() -> Measured:
    """Compare with the traces, on admissible steps also with zero, and with the library; count the conditions."""
    right, library, wrong, counts = [], [], [], []
    for n in (3, 4, 5):
        pairs = [(i, j) for i in range(n - 1) for j in range(i + 1, n - 1)]
        R = data.attitude(n, n)
        right += [
            len(pairs) - suslov_continuous.multiplier_count(n),
            SO(n).dim - (n - 1) - suslov_continuous.multiplier_count(n),
        ]
        counts.append(abs(len(pairs) - formulas.printed_constraint_count(n)))
        for W in (twin.exp(data.wedge(twin.numbers(n, n - 1, -2, 2))), data.attitude(n + 3, n)):
            values = [formulas.trace_constraint(R, R * W, i, j) for i, j in pairs]
            right += [v - _trace(R, R * W, i, j) for v, (i, j) in zip(values, pairs, strict=True)]
            library += list(nh.trace_constraints(data.array(R), data.array(R * W)) - [float(v) for v in values])
        step = twin.exp(data.wedge(twin.numbers(n, n - 1, -2, 2)))
        right += [formulas.trace_constraint(R, R * step, i, j) for i, j in pairs]
        wrong += [formulas.printed_trace_constraint(R, R * step, j) for j in range(n - 1)]
    return Measured(twin.both(twin.worst(right), twin.worst(library)), twin.worst(wrong) + sum(counts), "n = 3, 4, 5")


def _trace(R: Matrix, after: Matrix, i: int, j: int) -> Number:
    """Return the trace of the corrected constraint."""
    plane = ctx.zeros(R.rows)
    plane[i, j], plane[j, i] = 1, -1
    return twin.trace(after * plane * R.T)
