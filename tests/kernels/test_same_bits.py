"""The same bits from the library and from numba, in the process that compiles and in later ones, in any threads."""

import ast
import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from scripts import printed

import nonholo
import nonholo as nh
from nonholo.kernels import _driver, _scalar
from nonholo.kernels.secular import run as secular_run

LIVE, REPLAY, FREE_TOP = (str(Path(__file__).with_name(f"{name}.py")) for name in ("live", "replay", "free_top"))
ROUNDED_BY_IEEE = {
    "math": {"copysign", "inf", "isfinite", "nan", "sqrt"},
    "np": {
        *("abs", "all", "array", "concatenate", "empty", "empty_like", "float64", "int64", "isfinite", "nan"),
        *("ndarray", "sqrt", "sum", "uint64", "zeros", "zeros_like"),
    },
}


@pytest.mark.profile("routes", instead="test_three_ways_have_the_same_bits")
def test_bits_of_a_fresh_cache(tmp_path: Path) -> None:
    """Live sleighs have the bits of the library where numba compiles and where it loads, in 1 and in 7 threads."""
    cache = {"NUMBA_CACHE_DIR": str(tmp_path)}
    library, compiled, loaded = (
        printed(LIVE, "bits", "members 0", NONHOLO_KERNELS=way, NUMBA_NUM_THREADS=n, OPENBLAS_NUM_THREADS=n, **cache)
        for way, n in (("library", "1"), ("numba", "1"), ("numba", "7"))
    )
    assert loaded == compiled == library


@pytest.mark.profile("long", instead="test_three_ways_have_the_same_bits")
def test_bits_of_the_library() -> None:
    """All live motions have the bits of numba in the library."""
    library, compiled = (printed(LIVE, "bits", NONHOLO_KERNELS=way) for way in ("library", "numba"))
    assert library == compiled


@pytest.mark.profile("long", instead="test_three_ways_have_the_same_bits")
def test_random_bodies_have_the_same_bits(tmp_path: Path) -> None:
    """What 600 bodies of 15 kinds ask of the library, in 1 and in 2 threads, numba answers with the same bits."""
    calls = str(tmp_path / "calls.pickle")
    printed(REPLAY, "record", calls, "600", NONHOLO_KERNELS="library")
    one, two, by_numba = (
        printed(REPLAY, "bits", calls, threads, NONHOLO_KERNELS=way)
        for threads, way in (("1", "library"), ("2", "library"), ("2", "numba"))
    )
    assert one[0] == two[0] == "library"
    assert by_numba[0] == "numba"
    assert len(one) > 1000
    assert len({call.split()[0] for call in one[1:]}) >= 15
    assert one[1:] == two[1:] == by_numba[1:]


def _compiles(mark: ast.expr) -> bool:
    text = ast.unparse(mark)
    return text in {"scalar", "inlined"} or text.startswith("njit")


def _compiled_functions(*rooms: str) -> dict[str, ast.FunctionDef]:
    """Return the functions that numba compiles in some rooms, by their places."""
    result = {}
    for room in rooms:
        files = list((Path(nonholo.__file__).parent / room).rglob("*.py"))
        assert files, room
        for file in files:
            for node in ast.walk(ast.parse(file.read_text())):
                if isinstance(node, ast.FunctionDef) and any(map(_compiles, node.decorator_list)):
                    result[f"{file}:{node.name}"] = node
    return result


@pytest.mark.profile("routes", instead="test_three_ways_have_the_same_bits")
def test_every_compiled_function_is_run() -> None:
    """The live motions call each function that numba compiles: a new one needs a motion that does."""
    functions = _compiled_functions("continuous", "kernels", "base")
    assert set(functions) - set(printed(LIVE, "calls", NUMBA_DISABLE_JIT="1")) == set()


def _inexact(node: ast.AST) -> bool:
    """Tell whether a piece of a function leaves its last bits to the compiler or to a library."""
    match node:
        case ast.Attribute(value=ast.Name(id="math" | "np" as module), attr=name):
            return name not in ROUNDED_BY_IEEE[module]
        case ast.BinOp(op=ast.MatMult()) | ast.keyword(arg="fastmath"):
            return True
        case ast.BinOp(op=ast.Pow(), right=exponent):
            return ast.unparse(exponent) != "2"
    return False


def test_compiled_functions_round_as_ieee_says() -> None:
    """They add, multiply, divide and take square roots, in a fixed order: no powers, angles, products by BLAS.

    Outside kernels one may: the pose of a top in closed form takes an exponential of the library.
    """
    functions = _compiled_functions("kernels", "base")
    assert len(functions) > 100
    assert _scalar.COMPILED == {"error_model": "numpy"}
    loose = {place: [ast.unparse(n) for n in ast.walk(f) if _inexact(n)] for place, f in functions.items()}
    assert {place: pieces for place, pieces in loose.items() if pieces} == {}


@pytest.mark.profile("routes", keep=["interpreted"])
@pytest.mark.parametrize("disabled", ["1", "0"], ids=["interpreted", "compiled"])
def test_a_family_is_added_by_its_kernel_and_one_entry(disabled: str, tmp_path: Path) -> None:
    """Runs, compositions, ensembles, also of members with masses of their own, and stores are those of the general top.

    A kernel of its own is run by all of them. Each of its numbers is that of the library to rounding.
    """
    both = printed(FREE_TOP, NUMBA_CACHE_DIR=str(tmp_path), NUMBA_DISABLE_JIT=disabled)
    arguments, added = both["given"], both["added"]
    assert (arguments["body"], added["body"]) == ("SuslovBody", "FreeTopBody")
    assert added["is_scalar"]
    assert added["outcomes"] == arguments["outcomes"] == [0, 0, 1]
    assert added["reversal_defect"] < 1e-14
    for name in ("pose", "composed", "stored", "own"):
        assert np.allclose(added[name], arguments[name], rtol=0, atol=1e-14), name
    assert np.allclose(added["members"], arguments["members"], rtol=0, atol=1e-14, equal_nan=True)
    assert added["pose"] == added["stored"]
    assert added["own"][0] == added["members"][0] == added["pose"][-1]


SLEIGH = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1)
EIGENVECTOR = nh.discretize(nh.SuslovTop([[1.0, 0.0, 0.4], [0.0, 1.5, 0.0], [0.4, 0.0, 0.8]]), 0.1)


@pytest.mark.parametrize(("discrete", "across"), [(SLEIGH, 0), (EIGENVECTOR, 1)], ids=["sleigh", "top"])
def test_the_transverse_momentum_decays_to_zero_without_denormals(discrete: nh.Discretization, across: int) -> None:
    """The transverse momentum falls geometrically to 1e-150 of the other and is zero from then on, never denormal."""
    orbit = nh.simulate(discrete, restricted_velocity=(0.3, -0.9), steps=40_000)
    size = np.abs(orbit.reduced_momentum[:, across]) / np.abs(orbit.reduced_momentum[:, 1 - across])
    late = np.nonzero(size < 1e-100)[0][0]
    end = np.nonzero(size == 0)[0][0]
    rates = size[late + 1 : end] / size[late : end - 1]
    assert np.abs(rates / rates[0] - 1).max() < 1e-12
    assert size[end - 1] * rates[0] < 1e-150 <= size[end - 1]
    assert not size[end:].any()


@pytest.mark.parametrize("discrete", [SLEIGH, EIGENVECTOR], ids=["sleigh", "top"])
def test_a_repelling_equilibrium_is_left_from_however_near(discrete: nh.Discretization) -> None:
    """A transverse momentum of 1e-200 beside a repelling equilibrium grows until the motion is over."""
    canonical = discrete.system.canonical
    attracting = canonical.restrict(canonical.inertia_operator @ canonical.equilibria().attracting)
    start = -attracting / np.linalg.norm(attracting)
    start[np.argmin(np.abs(start))] = 1e-200
    orbit = nh.simulate(discrete, momentum=np.linalg.solve(discrete.system.frame_map, start), steps=60_000)
    assert orbit.reduced_momentum[-1] @ attracting > 0
    assert nh.invariants(orbit).energy_drift <= 1e-13


Sum = Callable[[float, float, float, float], tuple[float, float]]


@pytest.mark.parametrize("add", [_driver.kahan_sum, secular_run._kahan_sum], ids=["two momenta", "many momenta"])
def test_rounding_does_not_gather(add: Sum) -> None:
    """After a hundred thousand terms a compensated sum is off by one rounding at most."""
    terms = np.random.default_rng(0).uniform(0.0, 0.1, 100_000).tolist()
    total, lost = 1.0, 0.0
    for term in terms:
        total, lost = add(total, lost, term, 0.0)
    exact = math.fsum([1.0, *terms])
    assert abs(total - exact) <= math.ulp(exact)
