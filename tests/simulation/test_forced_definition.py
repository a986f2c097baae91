"""Forces around steps by the definition: groups without a form, products, discrete functions of the user's own."""

import math
from collections.abc import Callable
from typing import Any

import jax.numpy as jnp
import mpmath
import numpy as np
import pytest
from bodies import OTHERS
from comparisons import assert_near
from simulation.forces import HEAVY, RUB, TOP, VESELOVA, drive, hill, start_of

import nonholo as nh
from nonholo.systems import AbstractSystem

H = 0.05


def _action(time_step: float) -> Callable[[Any], Any]:
    """Return the discrete Lagrangian of the top, written by hand."""

    def action(W: Any) -> Any:
        X = W - jnp.eye(3)
        return jnp.trace(X @ jnp.asarray(TOP.mass_tensor) @ X.T) / (2 * time_step)

    return action


def _level(W: Any) -> Any:
    """A constraint that holds for W and its inverse."""
    X = W - W.T
    return X[1, 0] * (1 + X[2, 0] ** 2)


CASES: dict[str, tuple[AbstractSystem, Callable[[float], dict[str, Any]]]] = {
    "Heisenberg": (OTHERS["Heisenberg"], lambda _: {}),
    "product": (OTHERS["product"], lambda _: {}),
    "own difference": (TOP, lambda h: {"difference": _action(h)}),
    "own constraint": (TOP, lambda _: {"constraint": _level}),
    "naive": (TOP, lambda _: {"constraint": "naive"}),
    "fixed in space": (VESELOVA, lambda _: {"difference": "logarithmic"}),
}


@pytest.mark.profile("routes", keep=["own constraint"])
@pytest.mark.parametrize("name", CASES)
def test_steps_are_of_order_two(name: str) -> None:
    """Momentum, pose and balance fall with the square of the step beside the flow; no force is the free map."""
    system, how = CASES[name]
    forced = nh.Forced(system, hill, (drive, nh.Friction(np.linspace(0.1, 0.2, system.group.dim))))
    start, missed = start_of(system), []
    flow = nh.flow(forced, **start, times=(0.0, 0.8))
    for h in (0.08, 0.04):
        orbit = nh.simulate(nh.discretize(forced, h, **how(h)), **start, steps=round(0.8 / h))
        ends = ((orbit.restricted_momentum, flow.restricted_momentum), (orbit.configuration, flow.configuration))
        balance = np.abs(orbit.energy - orbit.energy[0] - orbit.work).max()
        missed.append([*(np.abs(a[-1] - b[-1]).max() for a, b in ends), balance])
    np.testing.assert_allclose(np.log2(np.divide(*missed)), 2, atol=0.1)
    table = nh.Forced(system, force=np.zeros((20, system.group.dim)), scheme="variational")
    free, still = (nh.simulate(nh.discretize(each, H, **how(H)), **start, steps=20) for each in (system, table))
    assert_near(still, free, 1e-13, "momentum", "configuration", "multipliers")


def _heisenberg_step(forced: nh.Forced, state: tuple[Any, Any, Any], h: Any) -> tuple[Any, Any]:
    """Return momenta along the constraint and coordinates (x, y, z) of the pose after a step, from the definition.

    In the coordinates of exp the product is a + b + [a, b]/2 with [a, b] = (0, 0, a1 b2 - a2 b1).
    """
    time, r, place = state
    S, inertia = (mpmath.matrix(np.asarray(each)) for each in (forced.constraint_subspace, forced.inertia_operator))
    to_velocity = S.T * (S * inertia * S.T) ** -1

    def product(a: Any, b: Any) -> Any:
        return a + b + mpmath.matrix([0, 0, (a[0] * b[1] - a[1] * b[0]) / 2])

    def along(function: Any, change: Any) -> Any:
        return mpmath.matrix([mpmath.diff(lambda e, i=i: function(change(e * _UNITS[:, i])), 0) for i in range(3)])

    def action(w: Any) -> Any:
        return (w.T * inertia * w)[0] / (2 * h)

    def force(at: Any, when: Any, momentum: Any) -> Any:
        w = to_velocity * momentum
        pull = mpmath.matrix([mpmath.cos(3 * when + i) - w[i] * w[(i - 1) % 3] / 5 for i in range(3)])
        slope = along(lambda x: mpmath.sin(x[0]) + (x[2] - x[0] * x[1] / 2) ** 2, lambda x: product(at, x))
        return S * (pull - slope) * h / 2

    def gaps(*numbers: Any) -> list[Any]:
        half, y, after = (mpmath.matrix(numbers[i : i + 2]) for i in (0, 2, 4))
        w = S.T * y
        leaving, arriving = (along(action, change) for change in (lambda x: product(x, w), lambda x: product(w, x)))
        ahead = S * arriving
        lacks = (
            half - r - force(place, time, (r + half) / 2),
            S * leaving - half,
            after - ahead - force(product(place, w), time + h, (ahead + after) / 2),
        )
        return [number for each in lacks for number in each]

    root = mpmath.findroot(gaps, [*r, *(h * (to_velocity * r)[:2]), *r], tol=1e-40)
    return mpmath.matrix(root[4:]), product(place, S.T * mpmath.matrix(root[2:4]))


_UNITS = mpmath.eye(3)


def test_steps_on_the_heisenberg_group_solve_their_equations() -> None:
    """Three steps under a potential and a force agree with the roots of the definition in 30 digits."""
    system = OTHERS["Heisenberg"]
    forced = nh.Forced(
        system,
        lambda g: math.sin(g[0, 1]) + (g[0, 2] - g[0, 1] * g[1, 2]) ** 2,
        lambda t, _g, w: np.cos(3 * t + np.arange(3)) - w * np.roll(w, 1) / 5,
    )
    start = {"restricted_velocity": [0.5, -0.3], "configuration": system.group.exp(np.array([0.2, -0.1, 0.4]))}
    orbit = nh.simulate(nh.discretize(forced, 0.25), **start, steps=3)
    with mpmath.workdps(30):
        r, place = mpmath.matrix(orbit.restricted_momentum[0]), mpmath.matrix([0.2, -0.1, 0.4])
        for k in range(3):
            r, place = _heisenberg_step(forced, (k * mpmath.mpf(0.25), r, place), mpmath.mpf(0.25))
            g = system.group.exp(np.array(place.tolist(), dtype=float)[:, 0])
            assert np.abs(orbit.configuration[k + 1] - g).max() < 1e-12
            assert np.abs(orbit.restricted_momentum[k + 1] - np.array(r.tolist(), dtype=float)[:, 0]).max() < 1e-12


@pytest.mark.parametrize("system", [TOP, VESELOVA], ids=["top", "veselova"])
def test_the_definition_has_the_kicks_of_the_kernels(system: AbstractSystem) -> None:
    """By the definition kicks give the orbit of the compiled step, with its multipliers, its parts and its refusals."""
    rows = np.random.default_rng(4).normal(size=(12, 3))
    discrete = nh.discretize(nh.Forced(system, HEAVY, (RUB, rows), "variational"), 0.1)
    kernel, defined = (nh.simulate(discrete, **start_of(system), steps=12, backend=each) for each in ("auto", "jax"))
    assert_near(defined, kernel, 1e-13, "momentum", "configuration", "multipliers", "energy", "work")
    shares = np.array([0.3, 1.0])
    parts = [each.motion.after_parts(each[4:6], shares) for each in (defined, kernel)]
    assert_near(parts[0], parts[1], 1e-13, "restricted_momentum", "configuration")
    rows[6, 0] = 1e3
    ended = nh.simulate(discrete, **start_of(system), steps=12, backend="jax", throw=False)
    again = nh.simulate(nh.discretize(discrete.system, 0.1), **start_of(system), steps=12, throw=False)
    assert (ended.outcome, len(ended)) == (again.outcome, len(again))


def test_two_tops_on_a_spring_keep_their_energy() -> None:
    """A product of rotation groups is a group with a form: under "energy" T + U is exact, also of order 4."""
    group = nh.MatrixGroup(nh.ProductGroup(nh.SO(3), nh.SO(3)).basis, form=np.eye(6))
    J = np.zeros((6, 6))
    J[:3, :3], J[3:, 3:] = TOP.mass_tensor, np.diag([1.0, 2.0, 3.0])
    pair = nh.LLSystem(group, J, annihilator=[[0, 0, 1.0, 0, 0, 0.3]])
    spring = nh.Forced(pair, lambda g: 2.0 * float(np.sum((g[:3, 0] - g[3:, 4]) ** 2)))
    for order in (2, 4):
        orbit = nh.simulate(nh.discretize(spring, 0.1, order=order), restricted_velocity=np.ones(5) / 2, steps=20)
        change = np.abs(np.diff(spring.potential_energy(orbit.configuration))).max()
        assert np.ptp(orbit.energy) < 1e-13 * orbit.energy[0] < 1e-13 * 100 * change
