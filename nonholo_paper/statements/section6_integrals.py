"""Section 6: the integral of the discrete top."""

import itertools

import nonholo as nh
from nonholo.groups import SO
from nonholo_paper import _suslov_twin as data
from nonholo_paper import _twin as twin
from nonholo_paper._claims import statement
from nonholo_paper._finding import Measured
from nonholo_paper._twin import Matrix, Number, ctx
from nonholo_paper.formulas import suslov_integrals as formulas

NOTE = "8 bodies, balanced, tilted, with J1 = J2 among them; 12 displacements, half-turns among them"


@statement
def integral() -> Measured:
    """Compare its values before and after a step, real and complex, and along an orbit of the library."""
    right = [
        formulas.quadratic(J, data.turned(J, W)) - formulas.quadratic(J, data.momentum(J, W))
        for J, _, W in data.samples()
    ]
    for name, y in data.STEPS:
        J, level = data.body(name), formulas.quadratic(data.body(name), data.momentum(data.body(name), data.cayley(y)))
        momenta = [data.momentum(J, data.cayley(after)) for after in data.successors(name, y)]
        right += [formulas.quadratic(J, M) - level for M in momenta]
    J = data.body("generic")
    orbit = nh.simulate(data.discrete(J), displacement=data.array(data.rotation([0.8, 0.36, 0.48])), steps=50)
    values = formulas.quadratic(data.array(J), list(orbit.momentum.T))
    return Measured(twin.both(twin.worst(right), twin.worst(values - values[0])), note=NOTE + "; 12 values; 50 steps")


@statement
def quadratic() -> Measured:
    r"""Compare with $2\det(\mathbb{I}|_{\mathfrak{d}})$ times the energy of the velocity with these momenta."""
    right, library = [], []
    for J, _, W in data.samples():
        M, D = data.momentum(J, W), _determinant(J)
        value = formulas.quadratic(J, M)
        right.append(value - 4 * D * data.reduced_energy(J, M))
        top = nh.SuslovTop(data.array(J))
        library.append(2 * float(D) * top.constrained_energy(top.restrict(data.array(ctx.matrix(M)).ravel())) - value)
    return Measured(twin.both(twin.worst(right), twin.worst(library)), note=NOTE)


def _determinant(J: Matrix) -> Number:
    """Return the determinant of the inertia along the constraint."""
    return ctx.det((twin.trace(J) * ctx.eye(3) - J)[:2, :2])


@statement
def every_dimension() -> Measured:
    """Compare the form at momenta before and after turning them, and along orbits of the library."""
    right, library = [], []
    for n in (3, 4, 5, 6):
        J = data.random_body(n + 30, n)
        inverse = (J[: n - 1, : n - 1] + J[n - 1, n - 1] * ctx.eye(n - 1)) ** -1
        for seed, factor in itertools.product(range(2), (1, 3)):
            u = [factor * x for x in twin.numbers(10 * n + seed, n - 1)]
            W = twin.exp(data.wedge(u))
            before = (W * J - J * W.T)[: n - 1, n - 1]
            after = (W.T * (W * J - J * W.T) * W)[: n - 1, n - 1]
            right.append((after.T * inverse * after - before.T * inverse * before)[0])
    for n in (4, 5):
        top = nh.discretize(nh.SuslovTop(data.array(data.random_body(n + 30, n))), 1.0)
        small = data.wedge([x / 4 for x in twin.numbers(n, n - 1)])
        energy = nh.simulate(top, displacement=SO(n).exp(SO(n).vee(data.array(small))), steps=20).energy
        library += list(energy / energy[0] - 1)
    return Measured(twin.both(twin.worst(right), twin.worst(library)), note="n = 3 to 6; 20 steps for n = 4, 5")


@statement
def whole_energy() -> Measured:
    """Look for a step, with the small value of the map, that changes it by more than a thousandth."""
    changes = []
    for name, y in data.STEPS[:2]:
        J = data.body(name)
        inverse = (twin.trace(J) * ctx.eye(3) - J) ** -1
        momenta = [ctx.matrix(data.momentum(J, data.cayley(t))) for t in (y, data.successors(name, y)[0])]
        before, after = ((M.T * inverse * M)[0] for M in momenta)
        changes.append(abs(after / before - 1))
    return Measured(data.lacking(max(changes) > 1e-3), note="two steps of a generic top")
