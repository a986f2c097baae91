"""Every formula of the paper with one sign or factor changed; each change must turn a finding red.

`python tests/paper/mutations.py` tries all of them and lists the survivors; the test suite tries a part.
"""

import ast
import contextlib
import functools
import importlib
import inspect
import pkgutil
import sys
import time
from collections.abc import Iterator
from types import CodeType, FunctionType, ModuleType
from typing import NamedTuple

from nonholo_paper import formulas
from nonholo_paper._finding import Finding, Measured
from nonholo_paper._registry import entries

FLIPPED = {ast.Add: ast.Sub, ast.Sub: ast.Add}
PRODUCTS = (ast.Mult, ast.Div, ast.MatMult)


class Mutant(NamedTuple):
    """A formula with one change: its module, its function, the change in words, the changed function."""

    module: ModuleType
    function: str
    change: str
    tree: ast.Module

    def __str__(self) -> str:
        return f"{self.place}: {self.change}"

    @property
    def place(self) -> str:
        """Return module and function."""
        return f"{self.module.__name__.rpartition('.')[2]}.{self.function}"


def modules() -> list[ModuleType]:
    """Return the modules of formulas."""
    names = sorted(info.name for info in pkgutil.iter_modules(formulas.__path__))
    return [importlib.import_module(f"{formulas.__name__}.{name}") for name in names]


def functions(module: ModuleType) -> list[str]:
    """Return the names of the formulas that a module defines."""
    own = [value for value in vars(module).values() if isinstance(value, FunctionType)]
    return [function.__name__ for function in own if function.__module__ == module.__name__]


def mutants(module: ModuleType, function: str) -> Iterator[Mutant]:
    """Yield a formula with one operator, sign, factor or exponent changed."""
    source = inspect.getsource(vars(module)[function])
    words: dict[str, int] = {}
    for number in range(len(_changes(ast.parse(source)))):
        tree = ast.parse(source)
        change = _apply(*_changes(tree)[number])
        words[change] = words.get(change, 0) + 1
        suffix = f" ({words[change]})" if words[change] > 1 else ""
        yield Mutant(module, function, change + suffix, ast.fix_missing_locations(tree))


def unchanged(module: ModuleType, function: str) -> Mutant:
    """Return a formula as it is, in the place of a mutant: it has to survive."""
    return Mutant(module, function, "nothing", ast.parse(inspect.getsource(vars(module)[function])))


def all_mutants() -> list[Mutant]:
    """Return the mutants of every formula."""
    return [mutant for module in modules() for name in functions(module) for mutant in mutants(module, name)]


def survives(mutant: Mutant, findings: list[Finding]) -> bool:
    """Tell whether none of the findings notices the change."""
    for finding in findings:
        baseline(finding)
    with _in_force(mutant):
        return not any(_notices(finding, mutant.function) for finding in findings)


@functools.cache
def users(module: ModuleType, function: str) -> list[Finding]:
    """Return the findings whose measure reaches a formula, the most direct ones first."""
    target = vars(module)[function].__code__
    ranked = [(depth, entry.finding) for entry in entries() if (depth := _depth(entry.finding, target)) is not None]
    return [finding for _, finding in sorted(ranked, key=lambda pair: pair[0])]


@functools.cache
def baseline(finding: Finding) -> Measured:
    """Return what a finding measures with the formulas as they are."""
    return finding.measure()


def _notices(finding: Finding, function: str) -> bool:
    """Tell whether a finding turns red; of a wrong formula, changed into another one, whether its defect changes."""
    try:
        measured = finding.measure()
    except Exception:
        return True
    if not finding.holds(measured):
        return True
    return function.startswith("printed_") and measured.printed != baseline(finding).printed


@contextlib.contextmanager
def _in_force(mutant: Mutant) -> Iterator[None]:
    before = dict(vars(mutant.module))
    exec(compile(mutant.tree, str(mutant), "exec"), vars(mutant.module))  # noqa: S102 (our own source)
    _forget()
    try:
        yield
    finally:
        vars(mutant.module).update(before)
        _forget()


def _forget() -> None:
    """Empty the caches of this room, which may hold values of the other formulas."""
    for name, module in list(sys.modules.items()):
        if name.startswith("nonholo_paper.") and not name.rpartition(".")[2].startswith("_"):
            for value in list(vars(module).values()):
                if hasattr(value, "cache_clear"):
                    value.cache_clear()


def _changes(function: ast.Module) -> list[tuple[ast.AST, ast.AST]]:
    """Return what can be changed, each with the node that holds it."""
    pairs = [(child, node) for node in ast.walk(function) for child in ast.iter_child_nodes(node)]
    result = [(child, node) for child, node in pairs if _is_sign(child) or _is_factor(child, node)]
    return result or [(child, node) for child, node in pairs if _is_product(child)][:1]


def _is_sign(node: ast.AST) -> bool:
    if isinstance(node, ast.UnaryOp):
        return isinstance(node.op, ast.USub)
    return isinstance(node, ast.BinOp | ast.AugAssign) and type(node.op) in FLIPPED


def _is_factor(node: ast.AST, holder: ast.AST) -> bool:
    is_number = isinstance(node, ast.Constant) and isinstance(node.value, int | float)
    return is_number and isinstance(holder, ast.BinOp) and isinstance(holder.op, (*PRODUCTS, ast.Pow))


def _is_product(node: ast.AST) -> bool:
    return isinstance(node, ast.BinOp) and isinstance(node.op, PRODUCTS)


def _apply(node: ast.AST, holder: ast.AST) -> str:
    """Change a node and return the change in words."""
    place = holder if isinstance(node, ast.Constant) else node
    before = ast.unparse(place)
    if isinstance(node, ast.UnaryOp):
        node.op = ast.UAdd()
    elif isinstance(node, ast.Constant):
        node.value += 1
    elif _is_product(node):
        node.left = ast.UnaryOp(ast.USub(), node.left)
    else:
        node.op = FLIPPED[type(node.op)]()
    return f"{before} -> {ast.unparse(place)}"


def _depth(finding: Finding, target: CodeType) -> int | None:
    """Return how many calls lie between a finding and a function, by the names in their codes."""
    level, codes = [finding.measure], set()
    for depth in range(12):
        if any(function.__code__ is target for function in level):
            return depth
        codes |= {function.__code__ for function in level}
        called = [other for function in level for other in _called(function)]
        level = [function for function in called if function.__code__ not in codes]
    return None


@functools.cache
def _called(function: FunctionType) -> tuple[FunctionType, ...]:
    names = _names(function.__code__)
    reference = [function.__globals__[name] for name in names if name in function.__globals__]
    rooms = [value for value in reference if isinstance(value, ModuleType)]
    reference += [vars(module)[name] for module in rooms for name in names if name in vars(module)]
    plain = [inspect.unwrap(value) for value in reference if callable(value)]
    functions = [value for value in plain if isinstance(value, FunctionType)]
    return tuple(value for value in functions if value.__module__.startswith("nonholo_paper"))


def _names(code: CodeType) -> set[str]:
    nested = [constant for constant in code.co_consts if isinstance(constant, CodeType)]
    return set(code.co_names).union(*(_names(inner) for inner in nested))


def main(chosen: list[str]) -> int:
    """Try every mutant, of the modules named or of all; print formulas that no finding reaches, and the survivors."""
    begun, count, complaints = time.perf_counter(), 0, list[str]()
    for module in modules():
        if chosen and module.__name__.rpartition(".")[2] not in chosen:
            continue
        for name in functions(module):
            result = users(module, name)
            complaints += [] if result else [f"not reached: {module.__name__}.{name}"]
            complaints += [] if survives(unchanged(module, name), result) else [f"always red: {module.__name__}.{name}"]
            own = list(mutants(module, name))
            count += len(own)
            complaints += [f"survives: {mutant}" for mutant in own if survives(mutant, result)]
    lines = [*complaints, f"{count} mutants, {len(complaints)} complaints, {time.perf_counter() - begun:.0f} s"]
    sys.stdout.write("\n".join(lines) + "\n")
    return bool(complaints)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
