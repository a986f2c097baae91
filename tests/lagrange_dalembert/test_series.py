"""Taylor series of formulas: the coefficients of each operation, flows beside numbers of other sources, and kinks."""

import functools
import sys
from typing import Any

import jax.numpy as jnp
import mpmath
import numpy as np
import pytest
from comparisons import assert_near
from formulas import function_of
from llvmlite import ir

import nonholo as nh
from nonholo.base.compiled.emission import compile_text
from nonholo.kernels._scalar import expand_at
from nonholo.lagrange_dalembert.compiled import _expansion
from nonholo.lagrange_dalembert.compiled._expansion import Elimination, Expansion
from nonholo.lagrange_dalembert.compiled._flow import formulation
from nonholo.lagrange_dalembert.compiled._scalars import Formulas, Scalar, UntranslatableError

ORDER = 30
POINTS = {
    0.3: ("exp", "expm1", "asin", "acos", "atanh"),
    0.4: ("log1p", "sin", "cos", "tan", "sinh", "cosh", "tanh", "asinh", "erf"),
    0.6: ("atan",),
    1.3: ("sqrt", "cbrt"),
    1.7: ("log",),
    1.9: ("acosh",),
}
UNARY = {name: (getattr(mpmath, name), x) for x, names in POINTS.items() for name in names}
UNARY["neg"] = (lambda x: -x, 0.4)
BINARY: dict[str, Any] = {
    "add": lambda x, y: x + y,
    "sub": lambda x, y: x - y,
    "mul": lambda x, y: x * y,
    "div": lambda x, y: x / y,
    "pow": lambda x, y: x**y,
    "atan2": mpmath.atan2,
}


def _series(build: Any, start: list[float]) -> np.ndarray:
    """Return coefficients of x and z, x_i' = 1 and z' = the formula of x."""
    f, inputs = Formulas(), [Scalar("input") for _ in range(len(start) + 2)]
    rates = [f.constant(1.0)] * len(start) + [build(f, *inputs[:-2]), f.constant(0.0)]
    expansion = Expansion(f, inputs, rates)
    module, width = ir.Module(), 8
    expansion.write(module, "expansion", width)
    series, room, none = np.zeros((ORDER + 1, width)), np.zeros(expansion.room), np.zeros(1)
    series[0, : len(start)], series[0, len(inputs) - 1] = start, 1.0
    expand_at(compile_text(str(module), "expansion"), (none, room, series, none, none), ORDER)
    return series


def _check(series: np.ndarray, of: int, function: Any) -> None:
    with mpmath.workdps(60):
        wanted = mpmath.taylor(function, 0, ORDER - 1)
        wanted = np.array([float(c / (k + 1)) for k, c in enumerate(wanted)])
    assert np.abs(series[1:, of] - wanted).max() < 2e-13 * np.abs(wanted).max()
    assert np.all(np.abs(series[1:, of] - wanted) <= 1e-9 * np.abs(wanted) + 1e-17)


@pytest.mark.profile("routes", keep=["asinh", "log", "atan", "sin", "exp", "sqrt"])
@pytest.mark.parametrize("name", UNARY)
def test_coefficients_of_functions(name: str) -> None:
    """Order by order they are those of mpmath in 60 digits, also of a function of a function."""
    function, x = UNARY[name]
    _check(_series(lambda f, x: f(name, x), [x]), 1, lambda t: function(x + t))
    inner = _series(lambda f, x: f(name, f("mul", x, x)), [np.sqrt(x)])
    _check(inner, 1, lambda t: function((mpmath.mpf(float(np.sqrt(x))) + t) ** 2))


@pytest.mark.parametrize("name", BINARY)
def test_coefficients_of_operations_on_two_numbers(name: str) -> None:
    """With both moving, and with a constant on either side."""
    function, x, y, c = BINARY[name], 1.3, 0.7, 2.5
    _check(_series(lambda f, x, y: f(name, x, f("mul", y, y)), [x, y]), 2, lambda t: function(x + t, (y + t) ** 2))
    _check(_series(lambda f, x: f(name, x, f.constant(c)), [x]), 1, lambda t: function(x + t, mpmath.mpf(c)))
    _check(_series(lambda f, x: f(name, f.constant(c), x), [x]), 1, lambda t: function(mpmath.mpf(c), x + t))


def test_many_operations_are_a_table_with_the_same_bits(monkeypatch: pytest.MonkeyPatch) -> None:
    """Every operation at once, with constants on either side, beside code that has them one after another."""

    def build(f: Formulas, x: Scalar, y: Scalar) -> Scalar:
        moved = {name: f("add", x, f.constant(start - 0.5)) for name, (_, start) in UNARY.items()}
        terms = [f(name, f("mul", x, each)) for name, each in moved.items() if name != "acosh"]
        terms += [f(name, *pair) for name in BINARY for pair in [(x, y), (x, f.constant(2.5)), (f.constant(2.5), x)]]
        return functools.reduce(lambda total, each: f("add", total, f("sub", each, f("neg", total))), terms)

    straight = _series(build, [0.5, 0.7])
    monkeypatch.setattr(_expansion, "_MANY", 1)
    table = _series(build, [0.5, 0.7])
    assert np.all(np.isfinite(table))
    assert table.tobytes() == straight.tobytes()


@pytest.mark.parametrize("name", ["abs", "max", "floor", "lt"])
def test_kinks_have_no_series(name: str) -> None:
    """Choices, comparisons and roundings are refused."""
    with pytest.raises(UntranslatableError):
        _series(lambda f, *x: f(name, *x[: 1 if name in ("abs", "floor") else 2]), [0.5, 0.2])


@pytest.mark.parametrize(("n", "s"), [(1, 0), (3, 2), (6, 4)])
def test_elimination_solves_bordered_equations(n: int, s: int) -> None:
    """Against NumPy, on random ones with zeros."""
    rng, f = np.random.default_rng(n), Formulas()
    root, rows = rng.normal(size=(n, n)), rng.normal(size=(s, n)) * (rng.uniform(size=(s, n)) < 0.7)
    rows[:, :s] += np.eye(s)
    K = np.block([[root @ root.T + np.eye(n), rows.T], [rows, np.zeros((s, s))]])
    numbers = [[f.constant(0.0) if x == 0 else Scalar("input") for x in row] for row in K]
    numbers = [[numbers[max(i, j)][min(i, j)] for j in range(n + s)] for i in range(n + s)]
    b, values = [Scalar("input") for _ in K], rng.normal(size=n + s)
    inputs = [(numbers[i][j], K[i, j]) for i in range(n + s) for j in range(i + 1) if numbers[i][j].value is None]
    code = function_of([*(each for each, _ in inputs), *b], Elimination(f, numbers).solution(b))
    arguments, x = np.array([*(value for _, value in inputs), *values]), np.empty(n + s)
    code(arguments.ctypes.data, x.ctypes.data)
    assert np.abs(x - np.linalg.solve(K, values)).max() < 1e-12


def test_a_pendulum_is_an_elliptic_function() -> None:
    """Over many swings, at the least tolerance, with the angle from mpmath."""
    pendulum = nh.LagrangeDAlembert(lambda q, v: v @ v / 2 + jnp.cos(q[0]), None, dimension=1)
    times = np.linspace(0.0, 40.0, 9)
    orbit = nh.flow(pendulum, configuration=[0.0], body_velocity=[1.6], times=times, rtol=1e-14)
    with mpmath.workdps(30):
        k = mpmath.mpf(1.6) / 2
        angle = [float(2 * mpmath.asin(k * mpmath.ellipfun("sn", mpmath.mpf(float(t)), k=k))) for t in times]
    assert np.abs(orbit.configuration[:, 0] - angle).max() < 3e-14
    assert np.ptp(orbit.energy) < 2e-15


def test_a_flow_with_kinks_is_solved_otherwise() -> None:
    """A force with an absolute value: the same orbit, known between its times, and its events."""
    bouncing = nh.LagrangeDAlembert(lambda q, v: v @ v / 2 - jnp.sum(jnp.abs(q)), None, dimension=1)
    event = nh.Event(lambda states: states.configuration[:, 0], direction=-1)
    orbit = nh.flow(bouncing, configuration=[0.5], body_velocity=[0.0], times=[0.0, 0.4, 0.8, 1.2], events=[event])
    assert "diffrax" in sys.modules
    assert np.abs(orbit.events[0].time - 1.0).max() < 1e-9
    assert np.abs(orbit.at([0.7, 0.2]).configuration[:, 0] - [0.255, 0.48]).max() < 1e-10


def test_parameters_are_numbers_of_the_series() -> None:
    """Numbers and arrays, compiled once for all values; each flow is that of the same numbers as constants."""
    swinging = nh.LagrangeDAlembert(
        lambda q, v, p: p["mass"] * (v @ v) / 2 + p["weights"][1] * jnp.cos(q[0]),
        None,
        dimension=1,
        parameters={"mass": 1.0, "weights": [3.0, 1.0]},
    )
    run: dict[str, Any] = {"configuration": [0.1], "body_velocity": [1.2], "times": np.linspace(0.0, 10.0, 7)}
    nh.flow(swinging, **run)
    compiled_before = formulation.cache_info().misses
    for mass, weight in ((2.0, 1.0), (0.5, 3.0)):
        orbit = nh.flow(swinging.with_parameters(mass=mass, weights=[7.0, weight]), **run)
        assert formulation.cache_info().misses == compiled_before
        constant = nh.LagrangeDAlembert(
            lambda q, v, m=mass, w=weight: m * (v @ v) / 2 + w * jnp.cos(q[0]), None, dimension=1
        )
        wanted = nh.flow(constant, **run)
        compiled_before = formulation.cache_info().misses
        assert_near(orbit, wanted, 1e-13, "configuration", "body_velocity", "momentum", "energy")
