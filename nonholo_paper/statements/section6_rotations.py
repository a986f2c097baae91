"""Section 6: the displacements of the top of three dimensions as rotations about an axis."""

import itertools

import numpy as np

import nonholo as nh
from nonholo.groups import SO
from nonholo_paper import _suslov_twin as data
from nonholo_paper import _twin as twin
from nonholo_paper._claims import statement
from nonholo_paper._finding import Measured
from nonholo_paper._twin import Matrix, Vector, ctx
from nonholo_paper.formulas import suslov_displacements as formulas

NOTE = "12 displacements: random, tiny, none, half-turns, almost half-turns"


def _turn(angle: Vector, axis: Vector) -> Matrix:
    """Return the rotation by an angle about a vector, to the left."""
    length = ctx.sqrt(ctx.fsum(x * x for x in axis))
    return twin.exp(twin.hat(SO(3), [angle * x / length for x in axis])) if length else ctx.eye(3)


def _quaternions() -> list[Vector]:
    """Return unit vectors of four dimensions, with q0 = 0, q3 = 0 and with a tiny vector part among them."""
    generic = [data.unit(twin.numbers(seed, 4)) for seed in range(6)]
    nasty = [[0, 0.6, 0, 0.8], [0.6, 0.8, 0, 0], [1, 1e-20, -1e-20, 2e-20], [1e-20, 1, 2, 3]]
    return generic + [data.unit(q) for q in nasty]


def _angle(q: Vector) -> Vector:
    return 2 * ctx.atan2(ctx.sqrt(ctx.fsum(x * x for x in q[1:])), q[0])


@statement
def axis() -> Measured:
    """Compare with rotations by the angle with half-angle cosine z0 about both vectors."""
    right, wrong = [], []
    for z0, z1, z2 in data.points():
        z, angle = [z1, z2], 2 * ctx.atan2(ctx.hypot(z1, z2), z0)
        W = formulas.displacement(z0, z)
        right.append(W - _turn(angle, formulas.rotation_axis(z)))
        wrong.append(W - _turn(angle, formulas.printed_rotation_axis(z)))
    return Measured(twin.worst(*right), twin.worst(*wrong), NOTE)


@statement
def rodrigues() -> Measured:
    """Compare with rotations about both vectors, and the library's pose of a quaternion with the matrix."""
    right, wrong = [], []
    for q in _quaternions():
        W = formulas.rodrigues(*q)
        right.append(W - _turn(_angle(q), formulas.rodrigues_vector(*q[1:])))
        wrong.append(W - _turn(_angle(q), formulas.printed_rodrigues_vector(*q[1:])))
    return Measured(twin.worst(*right), twin.worst(*wrong), "10 quaternions, with q0 = 0, q3 = 0, tiny angle")


@statement
def symmetric_entries() -> Measured:
    """Compare the difference of the entries with the product, and take a half-turn with q3 not zero."""
    right = []
    for q in _quaternions():
        W = _turn(_angle(q), [q[1], q[2], -q[3]])
        right.append(W[0, 1] - W[1, 0] - formulas.asymmetry_of_rodrigues(q[0], q[3]))
    half_turn = data.unit([0, 0.6, 0, 0.8])
    W = formulas.rodrigues(*half_turn)
    right.append(W[0, 1] - W[1, 0])
    return Measured(twin.worst(right), twin.worst([half_turn[3]]), "10 quaternions; a half-turn")


@statement
def admissible() -> Measured:
    """Compare with rotations about (q1, q2, 0), with (Rod), with (sp1), and with the library's exponential."""
    exact, library = [], []
    for q, W in data.turns():
        exact += [W - formulas.admissible(*q), W - formulas.rodrigues(q[0], q[1], q[2], 0)]
        z = [q[2], -q[1]]
        exact += [
            W - formulas.displacement(q[0], z),
            twin.differences(formulas.quaternion(z), q[1:]),
        ]
        library.append(float(not nh.in_exp_d(data.array(formulas.admissible(*q)), tolerance=1e-14)))
    return Measured(twin.both(twin.worst(*exact), twin.worst(library)), note=NOTE)


@statement
def positions() -> Measured:
    """Compare with the definition of the displacement, step by step, and with an orbit of the library."""
    R = [data.attitude(seed, 3) for seed in range(5)]
    steps = [before.T * after for before, after in itertools.pairwise(R)]
    exact = [R[k] - formulas.position(R[0], steps[:k]) for k in range(len(R))]
    printed = sum(twin.worst(R[k] - formulas.printed_position(steps[:k])) for k in range(1, len(R)))
    orbit = nh.simulate(data.discrete(data.body("generic")), momentum=[0.3, -0.4], steps=4)
    moved = [ctx.matrix(W.tolist()) for W in orbit.displacement[:4]]
    last = formulas.position(ctx.eye(3), moved)
    library = np.abs(orbit.configuration[4] - data.array(last)).max()
    tilted = data.lacking(abs(formulas.reflected_trace(last)) > 1e-3 or abs(last[0, 1] - last[1, 0]) > 1e-3)
    return Measured(
        max(twin.both(twin.worst(*exact), library), tilted), printed, "5 random positions; 4 steps of a top"
    )


@statement
def inverses() -> Measured:
    """Multiply the two matrices (PE)."""
    products = [formulas.admissible(*q) * formulas.admissible(q[0], -q[1], -q[2]) for q in data.points()]
    return Measured(twin.worst(*(product - ctx.eye(3) for product in products)), note=NOTE)
