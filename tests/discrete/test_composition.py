"""Compositions of order 4, 6 and 8: weights, order, what they keep, what their orbits mean."""

import dataclasses
import math

import mpmath
import numpy as np
import pytest
from bodies import GENERAL
from comparisons import assert_near
from refusals import refusals

import nonholo as nh
from nonholo import kernels
from nonholo.discrete._scheme import WEIGHTS, weights
from nonholo.kernels import _composition
from nonholo.systems import AbstractSystem

TOP = nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]])
SLEIGH = nh.ChaplyginSleigh(1.0, 1.2, 0.5, 0.3)
VELOCITY = np.array([0.9, -0.4])
BODIES = {
    "top": (TOP, VELOCITY),
    "sleigh": (SLEIGH, VELOCITY),
    **{name: GENERAL[name] for name in ("suslov 4", "sleigh 3", "any d on SE(3)", "veselova 4")},
}
ORDERS = (4, 6, 8)


def run(name: str, order: int, steps: int, time: float, **options: object) -> nh.Orbit:
    """Run a body for a time."""
    system, velocity = BODIES[name]
    discrete = nh.discretize(system, time / steps, order=order)
    return nh.simulate(discrete, restricted_velocity=velocity, steps=steps, **options)


def exponential(weight: mpmath.mpf, degree: int) -> dict[tuple[int, ...], mpmath.mpf]:
    """Return exp(w Y_1 + w^3 Y_3 + w^5 Y_5 + w^7 Y_7) as a series in words of the symbols Y, up to a degree."""
    total = term = {(): mpmath.mpf(1)}
    for n in range(1, degree + 1):
        term = {
            (*word, i): c * weight**i / n for word, c in term.items() for i in (1, 3, 5, 7) if sum(word) + i <= degree
        }
        total = total | {word: total.get(word, 0) + c for word, c in term.items()}
    return total


def composed(order: int) -> dict[tuple[int, ...], mpmath.mpf]:
    """Return the series of the composition up to its order."""
    half = [mpmath.mpf(text) for text in WEIGHTS[order]]
    product = {(): mpmath.mpf(1)}
    for weight in (*half, 1 - 2 * sum(half), *half[::-1]):
        factor, earlier, product = exponential(weight, order), product, {}
        for left, a in earlier.items():
            for right, b in factor.items():
                if sum(left + right) <= order:
                    product[left + right] = product.get(left + right, 0) + a * b
    return product


@pytest.mark.parametrize("order", ORDERS)
def test_weights_satisfy_every_order_condition(order: int) -> None:
    """The composition of exp(w Y_1 + w^3 Y_3 + ...) is exp(Y_1) up to its order: 30 digits of every coefficient.

    A reversible step of order two is such an exponential, so no condition is left out.
    """
    with mpmath.workdps(45):
        for word, coefficient in composed(order).items():
            wanted = mpmath.mpf(1) / math.factorial(len(word)) if set(word) <= {1} else 0
            assert abs(coefficient - wanted) < mpmath.mpf(10) ** -30


@pytest.mark.parametrize("order", ORDERS)
def test_weights_are_symmetric_and_sum_to_one(order: int) -> None:
    """The weights are those of 5, 9, 15 stages, read the same in reverse, and sum to 1 within two roundings."""
    result = weights(order)
    assert len(result) == {4: 5, 6: 9, 8: 15}[order]
    assert np.array_equal(result, result[::-1])
    assert abs(math.fsum(result) - 1) <= 2 * np.finfo(float).eps


REFERENCE_TIME = 3.0
# steps for the time, so few that every error of order 8 is far above the 1e-13 of the reference
COUNTS = {4: (24, 36, 54), 6: (16, 24, 36), 8: (10, 14, 20)}


@pytest.fixture(scope="module")
def reference() -> dict[str, nh.Orbit]:
    """Return the states of the flows at the reference time: closed forms for n = 3 and the plane."""
    result = {}
    for name in ("top", "sleigh", "suslov 4", "sleigh 3"):
        system, velocity = BODIES[name]
        method = "closed_form" if name in ("top", "sleigh") else None
        tight = {"rtol": 1e-13, "atol": 1e-15}
        result[name] = nh.flow(
            system, restricted_velocity=velocity, times=[0.0, REFERENCE_TIME], method=method, **tight
        )
    return result


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("name", ["top", "sleigh", "suslov 4", "sleigh 3"])
def test_order_by_slope(name: str, order: int, reference: dict[str, nh.Orbit]) -> None:
    """The errors at a fixed time fall with the order as slope: within 0.1, order 8 within 0.2."""
    ends = [run(name, order, n, REFERENCE_TIME, save_every=n) for n in COUNTS[order]]
    for quantity in ("restricted_momentum", "configuration"):
        exact = getattr(reference[name], quantity)[-1]
        errors = [np.abs(getattr(end, quantity)[-1] - exact).max() for end in ends]
        slope = -np.polyfit(np.log(COUNTS[order]), np.log(errors), 1)[0]
        assert abs(slope - order) <= (0.2 if order == 8 else 0.1), quantity


def test_order_eight_follows_a_top_for_long() -> None:
    """At h = 0.05 the error of order 8 stays below 1e-9 up to time 100, in momenta and pose."""
    start = {"body_velocity": (0.4, 0.9, 0.0)}
    orbit = nh.simulate(nh.discretize(TOP, 0.05, order=8), steps=2000, **start)
    exact = nh.flow(TOP, times=orbit.time, method="closed_form", **start)
    assert_near(orbit, exact, 1e-09, "restricted_momentum", "configuration")


@pytest.mark.parametrize("name", BODIES)
def test_a_negative_step_is_the_inverse(name: str) -> None:
    """The step with time step -h takes momentum and pose back: W^-1 is the displacement at -h over r'.

    Rounding of two solves at momenta and poses of a few units.
    """
    orbit = run(name, 2, 1, 0.1)
    backward = dataclasses.replace(orbit.motion, time_step=-0.1)
    back = nh.simulate(backward, momentum=orbit.restricted_momentum[1], configuration=orbit.configuration[1], steps=1)
    assert np.abs(back.restricted_momentum[1] - orbit.restricted_momentum[0]).max() < 1e-14
    assert np.abs(back.configuration[1] - orbit.configuration[0]).max() < 1e-14


@pytest.mark.profile("routes", keep=["top", "sleigh", "suslov 4", "sleigh 3"])
@pytest.mark.parametrize("name", ["top", "sleigh", "suslov 4", "sleigh 3", "any d on SE(3)"])
def test_energy_is_kept(name: str) -> None:
    """Each substep keeps the energy, so the whole step does, at any step size: rounding of 1000 x 15 substeps."""
    orbit = run(name, 8, 1000, 300.0)
    assert np.ptp(orbit.energy) <= 1e-13 * orbit.energy[0]


@pytest.mark.profile("routes", cases=["any d*", "veselova 4"])
@pytest.mark.parametrize("name", BODIES)
def test_displacement_is_that_of_the_whole_step(name: str) -> None:
    """g_(k+1) = g_k W_k, also where states are thinned, and the poses stay in the group."""
    orbit = run(name, 4, 12, 1.2)
    g, W = orbit.configuration, orbit.displacement
    assert np.abs(g[1:] - g[:-1] @ W[:-1]).max() < 1e-14
    thin = run(name, 4, 12, 1.2, save_every=5)
    assert np.array_equal(thin.reduced_momentum, orbit.reduced_momentum[::5])
    assert np.abs(thin.displacement - W[::5]).max() < 1e-14
    assert orbit.system.group.residual(g).max() < 1e-14


@pytest.mark.profile("routes", cases=["any d*", "veselova 4"])
@pytest.mark.parametrize("name", BODIES)
def test_momentum_is_that_of_the_first_substep(name: str) -> None:
    """P_k lies over r_k and is the momentum of the chart's displacement at the time step of the first substep."""
    orbit = run(name, 6, 3, 0.6)
    first = dataclasses.replace(orbit.motion, time_step=weights(6)[0] * orbit.motion.time_step, order=2)
    alone = nh.simulate(first, momentum=orbit.restricted_momentum[1], configuration=orbit.configuration[1], steps=1)
    assert np.abs(orbit.momentum[1] - alone.momentum[0]).max() < 1e-14
    assert np.abs(orbit.chart[1] - alone.chart[0]).max() < 1e-14


@pytest.mark.profile("routes", keep=["left"])
@pytest.mark.parametrize("system", [TOP, GENERAL["veselova 3"][0]], ids=["left", "right"])
def test_compiled_runs_agree_with_the_definition(system: AbstractSystem) -> None:
    """The compiled composition and the one made of steps by their definition are equal to rounding."""
    discrete = nh.discretize(system, 0.2, order=4)
    compiled, defined = (
        nh.simulate(discrete, restricted_velocity=VELOCITY, steps=4, save_every=2, backend=backend)
        for backend in ("numba", "jax")
    )
    assert_near(compiled, defined, 1e-13, "time", "restricted_momentum", "configuration", "chart", "momentum")


@pytest.mark.profile("routes", instead="test_compiled_runs_agree_with_the_definition")
def test_the_logarithmic_difference_composes() -> None:
    """The step with l(log W / h) is reversible too: order 4 by slope, and g_(k+1) = g_k W_k."""
    exact = nh.flow(TOP, restricted_velocity=VELOCITY, times=[0.0, 1.0], method="closed_form")
    errors = []
    for n in (5, 10):
        discrete = nh.discretize(TOP, 1.0 / n, "logarithmic", order=4)
        orbit = nh.simulate(discrete, restricted_velocity=VELOCITY, steps=n)
        errors.append(np.abs(orbit.configuration[-1] - exact.configuration[-1]).max())
    assert abs(np.log2(errors[0] / errors[1]) - 4) <= 0.1
    assert np.abs(orbit.configuration[1:] - orbit.configuration[:-1] @ orbit.displacement[:-1]).max() < 1e-13


@pytest.mark.profile("problems", keep=["*-4"])
@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("name", ["top", "sleigh"])
def test_a_steady_motion_does_not_drift(name: str, order: int) -> None:
    """A million steps of a steady motion, of order 4 of a settled one too, keep momenta and energy to 1e-14."""
    system, velocity = BODIES[name]
    discrete, long = nh.discretize(system, 0.2, order=order), {"steps": 10**6, "save_every": 10**5}
    steady = nh.simulate(discrete, body_velocity=nh.equilibria(system).velocity, **long)
    assert np.abs(steady.restricted_momentum - steady.restricted_momentum[0]).max() <= 1e-14
    if order == 4:
        settled = nh.simulate(discrete, restricted_velocity=velocity, steps=5000, save_every=5000)
        orbit = nh.simulate(discrete, momentum=settled.restricted_momentum[-1], **long)
        assert np.abs(orbit.restricted_momentum - settled.restricted_momentum[-1]).max() <= 1e-14
        assert np.ptp(orbit.energy) <= 1e-14 * orbit.energy[0]


def test_multipliers_at_a_steady_motion() -> None:
    """Beside the attracting motion the momentum across it shrinks in a step by the product over the substeps.

    A deviation of 1e-7 measures it to 1e-6.
    """
    discrete = nh.discretize(TOP, 0.3, order=6)
    spectrum = nh.equilibria(discrete, energy=0.5)
    across = np.linalg.svd(spectrum.velocity[None, :2])[2][1]
    momentum = TOP.restrict(np.asarray(TOP.inertia_operator) @ spectrum.velocity) + 1e-7 * across
    orbit = nh.simulate(discrete, momentum=momentum, steps=1)
    deviation = orbit.body_velocity[:, :2] @ across
    assert deviation[1] / deviation[0] == pytest.approx(spectrum.multipliers[0], abs=1e-6)


def test_limits_of_a_composed_orbit() -> None:
    """An orbit of order 8 turns a sleigh as far as the flow does, to the accuracy of the step."""
    orbit = nh.simulate(nh.discretize(SLEIGH, 0.1, order=8), restricted_velocity=VELOCITY, steps=2)
    flow = nh.flow(SLEIGH, restricted_velocity=VELOCITY, times=[0.0, 1.0])
    assert nh.asymptotics(orbit).heading_turn == pytest.approx(nh.asymptotics(flow).heading_turn, abs=1e-9)


def test_a_run_ends_at_a_fold() -> None:
    """Where a substep has no principal root the run stops with the good steps, and the error names the step."""
    discrete = nh.discretize(TOP, 1.5, order=4)
    start = {"momentum": [1.93257157, -0.68979744], "steps": 500}
    orbit = nh.simulate(discrete, **start, throw=False)
    assert orbit.outcome == nh.Outcome.no_real_branch
    assert 0 < len(orbit) < 500
    assert np.isfinite(orbit.displacement).all()
    with pytest.raises(nh.OutcomeError, match=rf"Step {len(orbit)} of 500.*no_real_branch"):
        nh.simulate(discrete, **start)


def test_a_start_without_a_root_is_empty() -> None:
    """A start from which no whole step can be taken gives an orbit of no states, compiled and by the definition."""
    for backend in ("numba", "jax"):
        discrete = nh.discretize(TOP, 1.0, order=4)
        orbit = nh.simulate(discrete, body_velocity=(40.0, 0.0, 0.0), steps=3, throw=False, backend=backend)
        assert (len(orbit), orbit.outcome) == (0, nh.Outcome.no_real_branch)


@pytest.mark.profile("routes", keep=["top", "sleigh"])
@pytest.mark.parametrize("name", BODIES)
def test_reversal_defect_of_whole_steps(name: str) -> None:
    """`invariants` measures one whole step forward and back, at rounding level; a wrong weight would show."""
    assert nh.invariants(run(name, 8, 5, 1.0)).reversal_defect < 1e-14


def test_read_only_states_take_the_compiled_step(monkeypatch: pytest.MonkeyPatch) -> None:
    """States that may not be written, as those of an orbit, are copied: no kernel is compiled for them once more."""
    calls, each = [], _composition._each

    def noted(*arguments: object) -> object:
        calls.extend(x.flags.writeable for x in arguments if isinstance(x, np.ndarray))
        return each(*arguments)

    monkeypatch.setattr(_composition, "_each", noted)
    momenta, poses = np.zeros((1, 2)), np.array([[1.0, 0.0, 0.0, 0.0]])
    for array in (momenta, poses):
        array.setflags(write=False)
    body = kernels.ComposedBody(kernels.suslov_body(np.diag([1.0, 2.0]), np.array([0.3, 0.1])), 1.0 * weights(4))
    after, moved, codes = kernels.whole_steps(body, momenta, poses)
    assert np.array_equal(after, momenta)
    assert np.array_equal(moved, poses)
    assert not codes.any()
    assert all(calls)


ROWS = nh.LLSystem(nh.SO(3), TOP.mass_tensor, TOP.constraint_subspace)


# An unknown order, a Lagrangian with its own time step and a constraint that is not reversible are refused.
test_orders_that_cannot_be_had_are_refused = refusals(
    ({"order": 3}, r"order=...\)` must be one of 2, 4, 6, 8. Got 3"),
    ({"order": 4, "difference": lambda W: ((W - np.eye(3)) ** 2).sum()}, "order=.*be 2.*one time step built in"),
    ({"order": 4, "constraint": "naive"}, r"order=.*be 2.*may not hold for W\^-1"),
    ask=lambda arguments: nh.discretize(ROWS, 0.1, **arguments),
)


_TOP4, _ONE = nh.discretize(TOP, 0.1, order=4), "order 4, a composition"
# Questions about one step of order 2, other branches and starts from a displacement say what to do instead.
test_what_a_composition_cannot_do_is_refused = refusals(
    (lambda: run("top", 4, 2, 0.2).multipliers, r"Orbit.multipliers.*order 4, a composition of 5 steps.*order=2"),
    (lambda: nh.simulate(_TOP4, steps=1, restricted_velocity=VELOCITY, branch="nearest"), "branch=.*order 4"),
    (lambda: nh.simulate(_TOP4, steps=1, displacement=np.eye(3)), "displacement=.*order 4.*variety"),
    (lambda: nh.step(_TOP4, np.eye(3)[0]), f"{_ONE} of 5 steps. Pass the discretization of order 2"),
    (lambda: nh.discrete_legendre(_TOP4, np.eye(3)[0]), f"{_ONE} of 5 steps. Pass the discretization of order 2"),
    (lambda: nh.branches(_TOP4, momentum=[0.1, 0.2]), _ONE),
    (lambda: nh.critical_energies(_TOP4), _ONE),
    (lambda: nh.invariant_measure(_TOP4).jacobian(np.eye(3)), _ONE),
    (lambda: nh.single_valued_region(nh.discretize(SLEIGH, 0.1, order=4)), _ONE),
    (lambda: nh.testing.check_discretization(_TOP4), _ONE),
)
