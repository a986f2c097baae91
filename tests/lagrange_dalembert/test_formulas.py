"""Compiled formulas: each primitive, the doubts, and runs, all against JAX."""

import functools
import pickle
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from formulas import function_of
from jax import lax

import nonholo as nh
from nonholo.base.numerics import double_precision
from nonholo.base.traced import TracedFunction
from nonholo.lagrange_dalembert import LagrangeDAlembert
from nonholo.lagrange_dalembert.compiled import _run
from nonholo.lagrange_dalembert.compiled._scalars import LOGIC, OPERATIONS, Formulas, Scalar, UntranslatableError
from nonholo.lagrange_dalembert.compiled._translation import DIFFERENTIABLE
from nonholo.lagrange_dalembert.functions import ForceTable

EPS = np.finfo(float).eps
CYCLE = np.array([2, 0, 1])
FUNCTIONS: dict[str, Callable[..., Any]] = {
    "arithmetic": lambda x, y: x + y - x * y / (-x) + lax.rem(x, y) + jnp.square(x) + lax.rsqrt(jnp.abs(y)) + x % y,
    "powers": lambda x, y: x**3 + x**-2 + x**7 + x**0 + jnp.abs(x) ** y + jnp.cbrt(x) + jnp.sqrt(jnp.abs(y)),
    "angles": lambda x, y: jnp.arctan2(x, y) + jnp.tan(x) + jnp.arcsin(x / 9) + jnp.arccos(y / 9) + jnp.arctan(x),
    "hyperbolic": lambda x, y: jnp.sinh(x) + jnp.cosh(y) + jnp.tanh(x) + jnp.arcsinh(x) + jnp.arctanh(x / 9),
    "exponentials": lambda x, y: jnp.exp(x) + jnp.log(y * y) + jnp.expm1(x) + jnp.log1p(y * y) + jnp.arccosh(1 + y * y),
    "smooth steps": lambda x, y: jax.nn.sigmoid(x) + jax.nn.softplus(y) + lax.erf(x) + jax.nn.relu(x),
    "choices": lambda x, y: jnp.where((x > y) & ~(x < 0.3) | (y == x), x, y * 2) + jnp.where(x >= y, 3 * x, 1),
    "comparisons": lambda x, y: (x > 0).astype(float) * y + jnp.where(x != y, 1.0, 2.0) + jnp.where(x <= y, x, 1),
    "rounding": lambda x, y: jnp.round(3 * x) + jnp.floor(3 * y) + jnp.ceil(5 * y) + jnp.abs(x) + jnp.sign(x) * y,
    "bounds": lambda x, y: jnp.clip(x, -0.5, 0.5) + jnp.maximum(x, y) * jnp.minimum(x, 0.1),
    "reductions": lambda x, y: jnp.stack([jnp.sum(x), jnp.prod(x), jnp.max(y), jnp.min(x), jnp.linalg.norm(x)]),
    "sums on the way": lambda x, y: jnp.cumsum(x) + lax.cumsum(y, reverse=True),
    "products": lambda x, y: jnp.outer(x, y) @ y + jnp.einsum("i,j->ji", x, y) @ x + jnp.cross(x, y),
    "batches": lambda x, y: jax.vmap(lambda a: a * y @ x)(x),
    "indices": lambda x, y: x[CYCLE] * y[::-1] + x[-1] + x[np.array([0, 0, 1])] + jnp.roll(x, 1),
    "entries": lambda x, y: jnp.zeros((2, 3)).at[0, 1].set(x[2]).at[:, 2].set(y[:2]).at[1].add(x),
    "repeated entries": lambda x, y: x.at[np.array([1, 1, 0])].add(y),
    "windows": lambda x, y: lax.dynamic_slice(x, (2,), (2,))[0] * lax.dynamic_update_slice(x, y[:1], (1,)),
    "padding": lambda x, y: lax.pad(x, y[0], ((1, 2, 1),)),
    "matrices": lambda x, y: jnp.linalg.det(jnp.stack([x, y, x * y])) * jnp.trace(jnp.diag(x) + jnp.outer(y, x).T),
    "pieces": lambda x, y: jnp.concatenate([jnp.split(x, [1, 2])[1], y[1:] * x[:-1], jnp.eye(3)[0]]).reshape(3, 2),
    "calls": lambda x, y: jax.jit(lambda z: z * 2)(x) + jnp.sinc(y),
}
OTHERS: dict[str, Callable[..., Any]] = {
    "loop": lambda x, y: lax.fori_loop(0, 3, lambda _, z: z * y, x),
    "solver": lambda x, y: jnp.linalg.solve(jnp.eye(3) + jnp.outer(x, x), y),
    "index that is computed": lambda x, _: x[jnp.argmax(x)],
    "place that is computed": lambda x, y: x.at[jnp.argmax(x)].set(y[0]),
    "branch that is computed": lambda x, y: lax.cond(x[0] > 0, lambda z: z, lambda z: 2 * z, y),
    "32 bits": lambda x, y: x.astype(jnp.float32) * y.astype(jnp.float32),
}
DERIVATIVES: dict[str, Callable[..., Any]] = {
    "value": lambda f: f,
    "first": lambda f: jax.jacfwd(f, argnums=(0, 1)),
    "second": lambda f: jax.jacfwd(jax.grad(lambda x, y: jnp.sum(jnp.sin(f(x, y))))),
}


def computed(function: Callable[..., Any], *arrays: np.ndarray) -> tuple[np.ndarray, float]:
    """Return the values of a function by its formulas, and their doubt."""
    program = _run.program(function, *(array.shape for array in arrays))
    numbers, results = np.concatenate([np.ravel(x) for x in arrays]), np.empty(len(program.results) + 1)
    function_of(program.inputs, [*program.results, program.doubt])(numbers.ctypes, results.ctypes)
    return results[:-1], results[-1]


def by_jax(function: Callable[..., Any], *arrays: np.ndarray) -> np.ndarray:
    """Return the values of a function by JAX."""
    with double_precision():
        return np.concatenate([np.ravel(x) for x in jax.tree.leaves(jax.jit(function)(*arrays))])


@pytest.mark.profile("routes", keep=["value-indices", "value-entries", "second-padding"])
@pytest.mark.parametrize("name", FUNCTIONS)
@pytest.mark.parametrize("order", DERIVATIVES)
def test_primitives(order: str, name: str) -> None:
    """Formulas of functions and of their derivatives have JAX's values; elementary functions differ by some ulp."""
    x, y = np.random.default_rng(len(name)).normal(size=(2, 3))
    function = DERIVATIVES[order](FUNCTIONS[name])
    values, doubt = computed(function, x, y)
    expected = by_jax(function, x, y)
    assert doubt == 0
    assert np.abs(values - expected).max() <= 100 * EPS * max(1.0, np.abs(expected).max())


def test_operations_that_are_not_asked_for_have_derivatives() -> None:
    """JAX makes gradients of functions with each operation whose derivative a Lagrangian is not asked for."""

    def others(x: Any, y: Any) -> Any:
        return (
            lax.clamp(-1.0, x, 1.0) + jnp.where(jnp.isfinite(x), y, 0) + lax.stop_gradient(y) * jnp.copy(x[y.argmax()])
        )

    vector, names = jax.ShapeDtypeStruct((3,), float), {"pjit", "expand_dims", *OPERATIONS}
    for function in (*FUNCTIONS.values(), others):
        gradient = jax.grad(lambda x, y, function=function: jnp.sum(jnp.sin(function(x, y))))
        names |= TracedFunction(function, (vector, vector)).primitives
        names |= TracedFunction(gradient, (vector, vector)).primitives
    assert names >= DIFFERENTIABLE


@pytest.mark.parametrize("name", OTHERS)
def test_what_has_no_formulas_is_refused(name: str) -> None:
    """Loops, linear solvers, slices and writing at computed places are left to JAX."""
    with pytest.raises(UntranslatableError):
        _run.program(OTHERS[name], (3,), (3,))


@pytest.mark.parametrize("at", range(3))
def test_computed_indices_choose_among_all_rows(at: int) -> None:
    """The first of the greatest numbers picks a row and a column; so do its derivatives."""
    x, y = np.roll([2.0, 2.0, -1.0], at), np.array([0.3, -0.7, 0.2])

    def chosen(x: Any, y: Any) -> Any:
        outer, k = jnp.outer(x, y), jnp.argmax(x)[None]
        return jnp.concatenate([outer[k][0] * x, outer[:, k][:, 0], outer[jnp.argmax(-y)[None], k]])

    for function in (chosen, jax.jacfwd(chosen, argnums=(0, 1))):
        values, doubt = computed(function, x, y)
        assert doubt == 0
        assert np.array_equal(values, by_jax(function, x, y))


def test_constants_have_the_values_of_the_code() -> None:
    """Each operation gives to constants what its instruction gives to numbers, to an ulp or two; quick code alike."""
    f, points = Formulas(), (0.3, 0.7, 0.2)
    binary = {"add", "sub", "mul", "div", "rem", "pow", "max", "min", "atan2", "lt", "le", "gt", "ge", "eq", "ne"}
    names = sorted(set(OPERATIONS) - LOGIC - {"float", "select", "acosh", "look"})
    inputs, constants = [Scalar("input") for _ in points], [f.constant(point) for point in points]

    def every(numbers: list[Scalar]) -> list[Scalar]:
        results = [f(name, *numbers[: 1 + (name in binary)]) for name in names]
        results.append(f("acosh", f("add", numbers[0], f.constant(1.0))))
        less, more = f("lt", *numbers[:2]), f("gt", *numbers[:2])
        chosen = [f("select", truth, *numbers[1:]) for truth in (less, more, f("and", less, more), f("not", more))]
        return [
            *(f("float", each) if each.is_truth else each for each in results),
            *chosen,
            *(f("float", f(name, less, more)) for name in ("or", "eq", "ne")),
        ]

    folded, (values, quick) = [each.value for each in every(constants)], np.empty((2, len(names) + 8))
    for search, row in ((1, values), (0, quick)):
        function_of(inputs, every(inputs), search)(np.array(points).ctypes, row.ctypes)
    assert None not in folded
    assert np.array_equal(values, quick)
    assert np.abs(np.array(folded) - values).max() <= 2 * EPS


@pytest.mark.parametrize("search", [0, 1])
def test_rows_of_tables_are_looked_up(search: int) -> None:
    """Formulas and JAX find the row of the nearest step, and zeros outside; so they do in a copy of a table."""
    table = pickle.loads(pickle.dumps(ForceTable.of(1.0 + np.arange(6.0).reshape(3, 2))))  # noqa: S301
    f, inputs, steps = Formulas(), [Scalar("input"), Scalar("input")], np.array([0.0, 1 - 1e-9, 2.0, 3.0, -1.0, 1e9])
    results = [f("look", *inputs, f.constant(float(column)), f.constant(2.0)) for column in range(2)]
    look, result = function_of(inputs, results, search), np.empty((len(steps) + 1, 2))
    for step, row in zip([*steps, np.nan], result, strict=True):
        look(np.array([table.address[0, 0], step]).ctypes, row.ctypes)
    np.testing.assert_array_equal(result, [[1, 2], [3, 4], [5, 6], *np.zeros((4, 2))])
    np.testing.assert_array_equal(table.acting(np.rint(steps).astype(int)), result[:-1])
    with jax.enable_x64(True):
        np.testing.assert_array_equal([table.row(jnp.asarray(step)) for step in steps], result[:-1])


def test_pickles_of_tables_hold_their_rows_once() -> None:
    """The rows that formulas look up are no part of a pickle: it has the same bytes before and after them."""
    table = ForceTable.of(np.ones((5, 3)))
    before = pickle.dumps(table)
    assert np.all(table.address > 0)
    assert pickle.dumps(table) == before


def test_tables_are_data_of_one_program() -> None:
    """A free particle moves by sums of rows, of tables of any length, by the program of the first; families differ."""
    rng, h, start, first = np.random.default_rng(0), 0.1, np.array([0.3, -0.2]), None
    for count in (0, 7, 1500):
        rows = rng.normal(size=(count, 2))
        system = nh.LagrangeDAlembert(lambda q, v: (v @ v + 0 * q @ q) / 2, None, dimension=2, force=rows)
        orbit = nh.simulate(nh.discretize(system, h), configuration=(0, 0), body_velocity=start, steps=count + 3)
        u = np.pad(rows, ((0, 4), (0, 0)))
        v = start + h * (np.cumsum(u, axis=0) - u / 2)
        np.testing.assert_allclose(orbit.body_velocity, v, 0, 1e-12)
        np.testing.assert_allclose(orbit.configuration[1:], h * np.cumsum(v, axis=0)[:-1], 0, 1e-11)
        first = first or system
        code = (_run.programs(each.form, (3,), 2) for each in (first, system))
        assert next(code) is next(code) is not None
        assert first.form == system.form
        assert (first.family == system.family) is (first is system)


def test_zeros_are_doubted_where_a_factor_may_not_be_finite() -> None:
    """0 log x is 0 without its logarithm only where x > 0; 0 sin x is 0 everywhere."""
    points = np.array([1.0, -1.0, 0.0])
    logarithms = [computed(lambda x: 0.0 * jnp.log(x), point[None]) for point in points]
    assert [value[0] for value, _ in logarithms] == [0.0, 0.0, 0.0]
    assert [doubt == 0 for _, doubt in logarithms] == [True, False, False]
    assert [computed(lambda x: 0.0 / x, point[None])[1] == 0 for point in points] == [True, True, False]
    assert _run.program(lambda x: 0.0 * jnp.sin(x), (1,)).doubt.value == 0.0


def test_a_number_is_computed_once() -> None:
    """What is written twice, and in derivatives again, has one operation."""
    program = _run.program(lambda x: (jnp.sin(x) * jnp.sin(x), jax.grad(jnp.cos)(x) + jnp.sin(x)), ())
    square, difference = program.results
    assert square.arguments[0] is square.arguments[1] is difference.arguments[1]


def random_system(seed: int) -> LagrangeDAlembert:
    """Return a system with a mass matrix, forms and a potential of no symmetry; odd ones are driven."""
    rng = np.random.default_rng(seed)
    n, s = int(rng.integers(2, 6)), 1 + seed % 2
    s = min(s, n - 1)
    B, C, D = rng.normal(size=(n, n)), rng.normal(size=(s, n)), rng.normal(size=(s, n, n))

    def lagrangian(q: Any, v: Any) -> Any:
        w = B @ v * (1 + jnp.sin(q) ** 2)
        return w @ w / 2 + v @ v / 2 - jnp.sum(jnp.cos(B @ q)) - q @ q / 2

    def forms(q: Any) -> Any:
        return C + jnp.sin(D @ q) / 2

    def force(time: Any, q: Any, v: Any) -> Any:
        return jnp.cos(time) * q - 0.1 * v

    driven: dict[str, Any] = {"force": force, "prescribed": {0: lambda time: jnp.sin(time)}} if seed % 2 else {}
    free = forms if not driven or s < n - 1 else None
    return LagrangeDAlembert(lagrangian, free, dimension=n, rule=("midpoint", "trapezoidal")[seed // 2 % 2], **driven)


def started(system: LagrangeDAlembert, seed: int) -> dict[str, np.ndarray]:
    """Return a start of a random system."""
    rng = np.random.default_rng(seed)
    q, p = rng.normal(size=(2, system.dimension))
    q[: len(system.prescribed)] = 0.0
    return {"configuration": q, "momentum": p}


ROUTES, LONG = (
    pytest.mark.profile(each, instead="test_the_equations_hold_with_their_sign") for each in ("routes", "long")
)


@pytest.mark.parametrize("time_step", [0.01, 0.3])
@pytest.mark.parametrize("seed", [pytest.param(seed, marks=ROUTES if seed < 3 else LONG) for seed in range(8)])
def test_runs_are_those_of_jax(seed: int, time_step: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """Orbits differ by rounding; large steps, of which some are not trusted, end alike."""
    system = random_system(seed)
    start = started(system, seed)
    steps = 100 if time_step < 0.1 else 30  # large steps of random systems are chaotic
    run = functools.partial(nh.simulate, nh.discretize(system, time_step), **start, steps=steps, throw=False)
    compiled = run()
    assert _run.programs(system, (system.dimension + system.is_driven,), system.dimension) is not None
    monkeypatch.setattr(_run, "programs", lambda *_, **__: None)
    monkeypatch.setattr(_run, "values", lambda *_, **__: None)
    orbit = run()
    assert compiled.outcome == orbit.outcome or (time_step > 0.1 and compiled.outcome and orbit.outcome)
    assert len(compiled) == len(orbit)
    for name in ("configuration", "body_velocity", "momentum", "multipliers", "energy"):
        ours, theirs = getattr(compiled, name), getattr(orbit, name)
        growth = 1e-12 if time_step < 0.1 else 1e-9  # rounding errors grow with the motion
        assert np.abs(ours - theirs).max(initial=0.0) <= growth * np.abs(theirs).max(initial=1.0), name
