"""What motions keep: volumes of momenta under steps, the density of the flow, linear integrals."""

from fractions import Fraction

import numpy as np
import pytest
from analysis.equations import momentum_rate
from bodies import ATTRACTING, mass_tensor
from comparisons import derivatives
from refusals import refusals

import nonholo as nh
from nonholo.analysis._equilibria import step_determinants
from nonholo.analysis._invariants import conserved_momenta
from nonholo.analysis.planar import planar_variety
from nonholo.discrete import momentum_slope
from nonholo.systems import AbstractLLSystem, AbstractSystem

PLANE = {name: ATTRACTING[name] for name in ("top 3", "top 3, tilted", "sleigh 2")}
SYSTEMS = PLANE | {name: ATTRACTING[name] for name in ("top 4", "sleigh 3", "turning sleigh 3")}
TOP = PLANE["top 3"]
STEP = 0.3


@pytest.mark.parametrize("name", SYSTEMS)
def test_jacobian_is_that_of_the_map(name: str) -> None:
    """The determinant of one step, and over four steps the sum of logarithms, are those of the momenta themselves."""
    discrete = nh.discretize(SYSTEMS[name], STEP)
    start = 0.4 * np.array([1.0, -0.7, 0.5])[: len(discrete.system.constraint_subspace)]
    orbit = nh.simulate(discrete, restricted_velocity=start, steps=4, reconstruct=False)
    result, r = nh.invariant_measure(discrete), orbit.restricted_momentum[0]
    for steps in (1, 4):

        def after(r: np.ndarray, steps: int = steps) -> np.ndarray:
            return nh.simulate(discrete, momentum=r, steps=steps, reconstruct=False).restricted_momentum[-1]

        volume = abs(np.linalg.det(derivatives(after, r)))
        assert abs(np.exp(result.log_volume(orbit)[steps]) - volume) <= 1e-8
    assert result.jacobian(orbit.displacement[0]) == pytest.approx(np.exp(result.log_volume(orbit)[1]), rel=1e-14)
    assert abs(result.log_volume(orbit)[-1]) > 1e-3


@pytest.mark.parametrize("name", PLANE)
def test_closed_forms_are_the_definition(name: str) -> None:
    """At 200 random displacements of up to 170 degrees the area factors give the ratio of slopes of the definition."""
    discrete, rng = nh.discretize(PLANE[name], STEP), np.random.default_rng(1)
    group, rows = discrete.system.group, discrete.system.constraint_subspace
    u = rng.normal(size=(200, 2))
    W = group.exp(u / np.linalg.norm(u, axis=1, keepdims=True) * rng.uniform(0.1, 2.9, size=(200, 1)) @ rows)
    variety = planar_variety(discrete.system)
    even, odd = variety.area_factor(variety.points(W))
    slopes = [np.linalg.det(momentum_slope(discrete, V)) for V in (W, group.inverse(W))]
    clear = np.abs(even + odd) > 1e-3 * np.abs(even + odd).max()  # at a fold both vanish
    assert clear.sum() > 190
    ratio = slopes[1][clear] / slopes[0][clear]
    assert np.abs(step_determinants(discrete, W[clear]) / ratio - 1).max() <= 1e-9


@pytest.mark.parametrize("group", [nh.SO(4), nh.SE(2)], ids=repr)
def test_a_free_body_keeps_volumes(group: nh.SO) -> None:
    """Without constraint the map of momenta is canonical: its determinant is 1, by the definition."""
    discrete = nh.discretize(nh.RigidBody(mass_tensor(group, np.random.default_rng(2)), group), STEP)
    W = group.exp(0.5 * np.random.default_rng(3).normal(size=(20, group.dim)))
    assert np.abs(step_determinants(discrete, W) - 1).max() <= 1e-13


@pytest.mark.parametrize("name", SYSTEMS)
def test_the_witness_is_the_jacobian_at_an_equilibrium(name: str) -> None:
    """There one step shrinks volumes by the witness, and expands them by its inverse at the opposite equilibrium."""
    discrete = nh.discretize(SYSTEMS[name], STEP)
    result = nh.invariant_measure(discrete, energy=0.4)
    assert not result.every_density
    assert 0 < abs(result.witness) < 1 - 1e-3
    for sign in (1, -1):
        start = nh.simulate(discrete, body_velocity=sign * result.velocity, steps=1)
        assert result.jacobian(start.displacement[0]) == pytest.approx(result.witness**sign, rel=1e-13)


@pytest.mark.parametrize("name", SYSTEMS)
def test_the_witness_of_the_flow_is_its_divergence(name: str) -> None:
    """It is the trace of the linearized field at the equilibrium, and the limit of log(witness)/h of the map."""
    system = SYSTEMS[name]
    result = nh.invariant_measure(system, 0.4)
    slopes = derivatives(momentum_rate(system), system.restrict(system.inertia_operator @ result.velocity))
    assert result.witness == pytest.approx(np.trace(slopes), abs=1e-9)
    assert result.witness < 0
    h = 1e-3
    of_map = nh.invariant_measure(nh.discretize(system, h), 0.4).witness
    assert np.log(of_map) / h == pytest.approx(result.witness, rel=1e-5)


@pytest.mark.parametrize("name", PLANE)
def test_density_of_the_flow(name: str) -> None:
    """The divergence of density times field vanishes at random momenta; that of the field alone does not."""
    rate, result, plain = momentum_rate(PLANE[name]), nh.invariant_measure(PLANE[name]), []
    for r in np.random.default_rng(4).normal(size=(20, 2)):
        terms = np.diag(derivatives(lambda p: rate(p) * result.density(p), r, 1e-5))
        assert abs(terms.sum()) <= 1e-8 * max(1.0, *np.abs(terms))  # of the difference quotients
        plain.append(abs(np.trace(derivatives(rate, r))))
    assert max(plain) > 0.1


def test_density_in_velocities() -> None:
    """For the axis e3 it is dw/|c . w_perp| times det B, the change from dr; infinite on the line of equilibria."""
    w = np.random.default_rng(5).normal(size=(10, 2))
    B, c = TOP.constrained_inertia, TOP.coupling
    expected = 1 / np.abs(c[1] * w[:, 0] - c[0] * w[:, 1]) / np.linalg.det(B)
    assert nh.invariant_measure(TOP).density(w @ B) == pytest.approx(expected, rel=1e-13)
    assert nh.invariant_measure(PLANE["sleigh 2"]).density([-0.3 * 2.0, 2.0]) == np.inf


def test_the_map_does_not_keep_the_density_of_the_flow() -> None:
    """The naive candidate: f(-z) p(z) / (f(z) p(-z)) would have to be 1. At a rational point it is 0.9997, exactly."""
    y = Fraction(1, 4), Fraction(-1, 8)
    B, c = ((Fraction(23, 10), Fraction(1, 5)), (Fraction(1, 5), Fraction(19, 10))), (Fraction(1, 2), Fraction(-3, 10))
    By = [b[0] * y[0] + b[1] * y[1] for b in B]
    D, square, along = B[0][0] * B[1][1] - B[0][1] ** 2, y[0] ** 2 + y[1] ** 2, c[0] * y[0] + c[1] * y[1]
    pull, turn = c[0] * By[0] + c[1] * By[1], c[1] * y[0] - c[0] * y[1]
    even = (D * (1 - square) + 2 * turn**2) / (1 + square)
    odd = 2 * along * (y[0] * By[0] + y[1] * By[1]) / (1 + square) - pull
    parity = (even - odd) * (D - pull) / ((even + odd) * (D + pull))
    assert parity == Fraction(234592267, 234659755)
    discrete = nh.discretize(TOP, STEP)
    W = TOP.group.cayley(2 * np.array([float(x) for x in y]) @ TOP.constraint_subspace)
    orbit = nh.simulate(discrete, displacement=W, steps=1)
    density, step = nh.invariant_measure(TOP).density(orbit.momentum), nh.invariant_measure(discrete).jacobian(W)
    assert density[1] * step / density[0] == pytest.approx(float(parity), rel=1e-13)


@pytest.mark.parametrize("body", [nh.SuslovTop(np.diag([1.0, 2.0, 3.0])), nh.ChaplyginSleigh(1.0, 1.0, 0.0, 0.2)])
def test_balanced_bodies_keep_every_density(body: AbstractLLSystem) -> None:
    """Their momenta stay: each step is the identity, with determinant 1, and the density 1 is offered."""
    discrete = nh.discretize(body, STEP)
    orbit = nh.simulate(discrete, restricted_velocity=(0.5, 0.7), steps=5)
    for motion in (body, discrete):
        result = nh.invariant_measure(motion)
        assert (result.every_density, result.witness, result.velocity) == (True, None, None)
        assert np.array_equal(result.density(orbit.momentum), np.ones(6))
    assert np.abs(np.ptp(orbit.restricted_momentum, axis=0)).max() <= 1e-15
    assert np.abs(nh.invariant_measure(discrete).log_volume(orbit)).max() <= 1e-15


_J = np.array([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]])
_UNEQUAL, _ROUND = np.diag([1.0, 2.0, 3.0]), np.diag([1.0, 1.0, 3.0])
_BODY_IN_SPACE = nh.MultidimensionalSleigh(1.2, [0.3, -0.2, 0.4], _J).homogeneous_mass_tensor
_E6 = np.eye(6)

# (number of conserved body components, of conserved spatial components)
LEFT = {
    "top": (nh.SuslovTop(_J), 0, 0),
    "balanced top": (nh.SuslovTop(_UNEQUAL), 2, 0),
    "balanced top of revolution": (nh.SuslovTop(_ROUND), 2, 3),  # no reaction at all
    "tilted balanced top": (nh.SuslovTop.from_inertia(_UNEQUAL, (0, 1, 0)), 2, 0),
    "balanced top in four dimensions": (nh.SuslovTop(np.diag([1.0, 2.0, 3.0, 4.0])), 3, 0),
    "sleigh": (nh.ChaplyginSleigh(1.0, 1.0, 0.5, 0.2), 0, 0),
    "balanced sleigh": (nh.ChaplyginSleigh(1.0, 1.0, 0.0, 0.5), 2, 0),
    "sleigh in space, center of mass beside": (nh.MultidimensionalSleigh(1.0, [0.0, 0.3, 0.2], _J), 1, 0),
    "free top": (nh.RigidBody(_UNEQUAL), 0, 3),
    "free top of revolution": (nh.RigidBody(_ROUND), 1, 3),
    "free sphere": (nh.RigidBody(np.eye(3)), 3, 3),
    "one plane of rotation": (nh.LLSystem(nh.SO(3), _J, [[1.0, 0.0, 0.0]]), 1, 0),
    "a body that may not turn": (nh.LLSystem(nh.SE(3), _BODY_IN_SPACE, _E6[3:]), 3, 6),
    "a body that may not spin": (nh.LLSystem(nh.SE(3), _BODY_IN_SPACE, _E6[1:]), 0, 3),  # translations: an ideal in d
}
RIGHT = {
    "Veselova top": (nh.VeselovaTop(_UNEQUAL), 0, 2),
    "Veselova sphere": (nh.VeselovaTop(np.eye(3)), 3, 3),
    "Veselova top in four dimensions": (nh.VeselovaTop(np.diag([1.0, 2.0, 3.0, 4.0])), 0, 3),
    "free body with rows in space": (nh.LRSystem(nh.SO(3), _UNEQUAL, np.eye(3)), 0, 3),
    "plane body": (nh.LRSystem(nh.SE(2), _J, np.eye(3)[:2]), 0, 2),
    "body in space": (nh.LRSystem(nh.SE(3), _BODY_IN_SPACE, _E6[:4]), 0, 4),
}


@pytest.mark.parametrize("name", LEFT | RIGHT)
def test_conserved_components(name: str) -> None:
    """The counts are the known ones; listed components do not change at 60 random states, all others do at some.

    Components along a constraint in space are among the spatial ones; in the body momenta are known along it alone.
    """
    system, body, spatial = (LEFT | RIGHT)[name]
    result, rows = conserved_momenta(system), system.constraint_subspace
    assert (len(result.body), len(result.spatial)) == (body, spatial)
    in_body, in_space = np.stack([_rates(system, seed) for seed in range(60)], axis=1)
    reference = np.eye(system.group.dim) if system.is_spatial else np.linalg.pinv(rows) @ rows
    _check(system, result.body, in_body @ reference, 0 if system.is_spatial else len(system.annihilator))
    _check(system, result.spatial, in_space, 0)
    if system.is_spatial:
        assert np.linalg.matrix_rank(np.concatenate([result.spatial, rows]), tol=1e-9) == len(result.spatial)


def _check(system: AbstractSystem, rows: np.ndarray, rates: np.ndarray, without: int) -> None:
    """Rates are central differences at velocities of order one: rounding eps/step and truncation step^2 leave 1e-9."""
    scale = np.abs(system.inertia_operator).max()
    assert np.abs(rows @ rates.T).max(initial=0.0) < 1e-8 * scale
    assert np.linalg.matrix_rank(rates, tol=1e-6 * scale) == system.group.dim - without - len(rows)


def _rates(system: AbstractSystem, seed: int) -> np.ndarray:
    """Rates of body and spatial momentum along the vector field, by central differences."""
    rng, group, k, step = np.random.default_rng(seed), system.group, system.rank, 1e-5
    state = np.concatenate([rng.normal(size=k), group.random(rng).ravel()])

    def momenta(state: np.ndarray) -> np.ndarray:
        g = state[k:].reshape(group.identity.shape)
        back = np.linalg.inv(group.adjoint(g))
        velocity = system.restricted_velocity(state[:k], g) @ system.constraint_subspace
        p = system.inertia_operator @ (back @ velocity if system.is_spatial else velocity)
        return np.stack([p, back.T @ p])

    rate = nh.vector_field(system)(0.0, state)
    return (momenta(state + step * rate) - momenta(state - step * rate)) / (2 * step)


@pytest.mark.parametrize(
    "name", ["balanced top", "tilted balanced top", "balanced top of revolution", "balanced sleigh"]
)
def test_discrete_map_keeps_the_body_components(name: str) -> None:
    """Momenta along d stay for 200 large steps, to rounding; of a top of revolution all in space, without reactions."""
    system = LEFT[name][0]
    orbit = nh.simulate(nh.discretize(system, 0.4), restricted_velocity=(0.7, -0.4), steps=200)
    components = orbit.momentum @ conserved_momenta(system).body.T
    assert np.abs(components - components[0]).max() < 200 * np.finfo(np.float64).eps * np.abs(orbit.momentum).max()
    drift = np.abs(orbit.spatial_momentum - orbit.spatial_momentum[0]).max()
    assert drift < 1e-12 if name == "balanced top of revolution" else drift > 0.1


_MAP = nh.discretize(TOP, STEP)
_SPEED = {"restricted_velocity": (0.1, 0.1)}
_NO_SYSTEM = r"conserved_momenta\(system=\.\.\.\)` must be a system on a group. Got"
# Other systems, densities that nobody knows, and flows where a step is meant are named.
test_what_is_not_known_is_refused = refusals(
    (lambda: nh.invariant_measure(RIGHT["Veselova top"][0]), r"must be a top or a sleigh\. Got VeselovaTop"),
    (lambda: nh.invariant_measure(_MAP).density([1.0, 1.0]), "not unique and in no known closed form"),
    (lambda: nh.invariant_measure(SYSTEMS["top 4"]).density([1.0, 1.0, 1.0]), "Got 3 admissible directions"),
    (lambda: nh.invariant_measure(TOP).jacobian(np.eye(3)), "be a discretized system"),
    (
        lambda: nh.invariant_measure(_MAP).log_volume(nh.flow(TOP, **_SPEED, times=[0.0, 1.0])),
        "be an orbit of the measure's motion",
    ),
    (
        lambda: nh.invariant_measure(_MAP).log_volume(nh.simulate(_MAP, **_SPEED, steps=4, save_every=2)),
        r"hold every step\. Got 3 states with others",
    ),
    (lambda: conserved_momenta(3), _NO_SYSTEM),
    (lambda: conserved_momenta(nh.examples.particle().system), _NO_SYSTEM),
)
