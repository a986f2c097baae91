"""Machine code of formulas, which stays on disk.

A file is named by a digest of all that its formulas depend on: a system's functions as JAX traces them, with every
number within, the texts of this room, versions and the processor. Functions whose derivatives a user has defined are
not seen through: nothing is kept of them. A file that is cut or changed is replaced.
"""

import contextlib
import functools
import hashlib
import json
import os
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
import llvmlite
from llvmlite import ir

from nonholo.base import traced
from nonholo.base.compiled.emission import load_object, object_of, this_processor
from nonholo.base.compiled.library import cache_folder, digest_of, digest_of_kernels
from nonholo.base.progress import compiling
from nonholo.base.types import Array
from nonholo.lagrange_dalembert import _equations as equations
from nonholo.lagrange_dalembert.compiled._scalars import DOUBLE, OPERATIONS, Scalar, Text, operations_between, reference
from nonholo.lagrange_dalembert.functions import SYSTEM

Write = Callable[[ir.Module], Any]
_MOST = 256  # files


def write_function(module: ir.Module, name: str, inputs: list[Scalar], results: list[Scalar]) -> None:
    """Write a C function that reads inputs from its first array and writes results to its second one."""
    function = ir.Function(module, ir.FunctionType(ir.VoidType(), [DOUBLE.as_pointer()] * 2), name)
    builder, (source, target) = ir.IRBuilder(function.append_basic_block()), map(reference, function.args)
    values, lines = dict[Scalar, str](), list[str]()

    def value(each: Scalar) -> str:
        if each.value is None:
            return values[each]
        return reference(ir.Constant(each.kind, int(each.value) if each.is_truth else float(each.value)))

    for i, each in enumerate(inputs):
        lines += [f"%in{i} = getelementptr double, {source}, i64 {i}", f"%x{i} = load double, double* %in{i}"]
        values[each] = f"double %x{i}"
    for i, each in enumerate(operations_between(results, inputs)):
        lines.append(f"%y{i} = {OPERATIONS[each.operation].emit(module, *map(value, each.arguments))}")
        values[each] = f"{each.kind} %y{i}"
    for i, each in enumerate(results):
        lines += [f"%out{i} = getelementptr double, {target}, i64 {i}", f"store {value(each)}, double* %out{i}"]
    Text(builder, ir.VoidType(), "\n".join([*lines, "ret void"]))


def code_of(family: Any, what: tuple[Any, ...], write: Write, search: int = 1) -> tuple[dict[str, int], Any]:
    """Return the addresses of the functions that `write` puts into a module, by name, and what it returns, for JSON.

    They come from disk once they have been made for the family of systems. Arithmetic is strict, as in all kernels.
    Where nothing is searched for, 0, code is made in an eighth of the time and runs half as fast.

    Raises:
        UntranslatableError: `write` cannot make formulas of it.
    """
    with compiling(SYSTEM, family, (family, what)):
        return machine_code(write, _file(family, what), search)


def machine_code(write: Write, file: Path | None = None, search: int = 1) -> tuple[dict[str, int], Any]:
    """Do the same with a file, or none."""
    head, binary = _read(file) or (None, b"")
    if head is None:
        module = ir.Module()
        facts = write(module)
        binary = object_of(str(module), search=search, passes=0)
        names = [each.name for each in module.functions if not each.is_declaration]
        head = {"names": names, "facts": facts, "digest": hashlib.sha256(binary).hexdigest()}
        _keep(file, json.dumps(head).encode() + b"\n" + binary)
    return dict(zip(head["names"], load_object(binary, *head["names"]), strict=True)), head["facts"]


def _read(file: Path | None) -> tuple[dict[str, Any], bytes] | None:
    with contextlib.suppress(OSError, ValueError, KeyError, TypeError):
        line, binary = (file.read_bytes() if file else b"").split(b"\n", 1)
        head = json.loads(line)
        if head["digest"] == hashlib.sha256(binary).hexdigest():
            return head, binary
    return None


def _keep(file: Path | None, content: bytes) -> None:
    """Write a file at once, where there is room for it; the oldest of many go."""
    if file is None:
        return
    part = file.with_suffix(f".{os.getpid()}-{threading.get_ident()}")
    with contextlib.suppress(OSError):
        file.parent.mkdir(parents=True, exist_ok=True)
        part.write_bytes(content)
        part.replace(file)
        for old in sorted(file.parent.glob("*.o"), key=lambda each: each.stat().st_mtime)[:-_MOST]:
            old.unlink()
    with contextlib.suppress(OSError):  # what a full disk leaves
        part.unlink(missing_ok=True)


def _file(family: Any, what: tuple[Any, ...]) -> Path | None:
    """Return the file of what is made of a family of systems; None if each process must make it, or without a home."""
    folder, digest = cache_folder() / "formulas", _digest(family)
    if digest is None or not folder.is_absolute():
        return None
    return folder / f"{hashlib.sha256(f'{digest} {what}'.encode()).hexdigest()}.o"


@functools.lru_cache(maxsize=64)
def _digest(family: Any) -> str | None:
    """Return a digest of all that formulas of a family depend on; None where that cannot be seen."""

    def moves(x: Array, v: Array, h: Array) -> Any:
        places, step = family.places, family.places.step(v, h)
        row = jnp.zeros(0) if family.table is None else family.table.row(equations.time_of(x) / h)
        slopes = *places.momenta(x, step, h, x, step), places.force(v, v, x, x)
        return jnp.concatenate([*map(jnp.ravel, (row, places.rate(x, v), equations.ahead(family, x, v, h), *slopes))])

    place, velocity = family.place_shape, family.shapes[1]
    shapes = tuple(jax.ShapeDtypeStruct(shape, float) for shape in (place, velocity, ()))
    functions = {name: getattr(family, name) for name in (*family.functions, "applied")} | dict(family.prescribed)
    digests = {name: getattr(each, "digest", None) for name, each in functions.items() if each is not None}
    digests["moves"] = traced.TracedFunction(moves, shapes).digest
    if None in digests.values():
        return None
    sort = type(family).__name__, family.rule, family.is_driven, family.has_parts, place, velocity
    texts = digest_of("lagrange_dalembert", "groups"), digest_of_kernels(), Path(str(traced.__file__)).read_bytes()
    about = sort, family.parameters.structure, digests, texts, jax.__version__, llvmlite.__version__, this_processor()
    return hashlib.sha256(repr(about).encode()).hexdigest()
