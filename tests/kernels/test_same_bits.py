"""The same bits from the library and from numba, in the process that compiles and in later ones, in any threads."""

import ast
import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

import nonholo
from nonholo.kernels import _scalar

LIVE, REPLAY = (Path(__file__).parent / name for name in ("live.py", "replay.py"))
ROUNDED_BY_IEEE = {
    "math": {"copysign", "inf", "isfinite", "nan", "sqrt"},
    "np": {
        *("abs", "all", "array", "concatenate", "empty", "empty_like", "float64", "int64", "isfinite", "nan"),
        *("ndarray", "sqrt", "sum", "uint64", "zeros", "zeros_like"),
    },
}


def _printed(*arguments: str, program: Path = LIVE, **variables: str) -> Any:
    command = [sys.executable, str(program), *arguments]
    environment = {**os.environ, **variables}
    done = subprocess.run(command, env=environment, stdout=subprocess.PIPE, check=True)  # noqa: S603
    return json.loads(done.stdout or "null")


@pytest.mark.profile("routes", instead="test_three_ways_have_the_same_bits")
def test_bits_of_a_fresh_cache(tmp_path: Path) -> None:
    """Live sleighs have the bits of the library where numba compiles and where it loads, in 1 and in 7 threads."""
    library, compiled, loaded = (
        _printed(
            "bits",
            "sleighs",
            NONHOLO_KERNELS=way,
            NUMBA_CACHE_DIR=str(tmp_path),
            NUMBA_NUM_THREADS=n,
            OPENBLAS_NUM_THREADS=n,
        )
        for way, n in (("library", "1"), ("numba", "1"), ("numba", "7"))
    )
    assert loaded == compiled == library


@pytest.mark.profile("long", instead="test_three_ways_have_the_same_bits")
def test_bits_of_the_library() -> None:
    """All live motions have the bits of numba in the library."""
    library, compiled = (_printed("bits", NONHOLO_KERNELS=way) for way in ("library", "numba"))
    assert library == compiled


@pytest.mark.profile("long", instead="test_three_ways_have_the_same_bits")
def test_random_bodies_have_the_same_bits(tmp_path: Path) -> None:
    """What 600 bodies of 15 kinds ask of the library, in 1 and in 2 threads, numba answers with the same bits."""
    calls = str(tmp_path / "calls.pickle")
    _printed("record", calls, "600", program=REPLAY, NONHOLO_KERNELS="library")
    one, two, by_numba = (
        _printed("bits", calls, threads, program=REPLAY, NONHOLO_KERNELS=way)
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
    found = {}
    for room in rooms:
        files = list((Path(nonholo.__file__).parent / room).rglob("*.py"))
        assert files, room
        for file in files:
            for node in ast.walk(ast.parse(file.read_text())):
                if isinstance(node, ast.FunctionDef) and any(map(_compiles, node.decorator_list)):
                    found[f"{file}:{node.name}"] = node
    return found


@pytest.mark.profile("routes", instead="test_three_ways_have_the_same_bits")
def test_every_compiled_function_is_run() -> None:
    """The live motions call each function that numba compiles: a new one needs a motion that does."""
    functions = _compiled_functions("continuous", "kernels", "base")
    assert set(functions) - set(_printed("calls", NUMBA_DISABLE_JIT="1")) == set()


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
