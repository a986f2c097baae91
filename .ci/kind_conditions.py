"""Conditions on a kind of motion: attributes and functions that answer a bool and are asked in more than two rooms.

`python .ci/kind_conditions.py` prints their names, with how often each is asked and in how many rooms, and the sum.
An attribute of the same name that answers something else (`poses`, `exists`) counts too.
"""

import ast
import collections
import sys
from pathlib import Path

LIBRARY = Path(__file__).parents[1] / "nonholo"


def _trees() -> list[tuple[str, ast.Module]]:
    files = sorted(LIBRARY.rglob("*.py"))
    return [(file.relative_to(LIBRARY).parts[0], ast.parse(file.read_text())) for file in files]


def _answers_bool(node: ast.AST) -> str | None:
    """Return the name of what is annotated to be a bool."""
    if isinstance(node, ast.FunctionDef) and node.returns is not None:
        return node.name if "bool" in ast.unparse(node.returns).split(" | ") else None
    if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
        return node.target.id if ast.unparse(node.annotation) in ("bool", "ClassVar[bool]", "bool | None") else None
    return None


def conditions() -> dict[str, tuple[int, int]]:
    """Return how often each is asked, and in how many rooms, of those that are asked in more than two."""
    trees = _trees()
    names = {name for _, tree in trees for node in ast.walk(tree) if (name := _answers_bool(node)) is not None}
    questions = collections.defaultdict(list)
    for room, tree in trees:
        for node in ast.walk(tree):
            name = node.attr if isinstance(node, ast.Attribute) else None
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
                name = node.func.id
            if name in names:
                questions[name].append(room)
    return {name: (len(rooms), len(set(rooms))) for name, rooms in questions.items() if len(set(rooms)) > 2}


if __name__ == "__main__":
    FOUND = sorted(conditions().items(), key=lambda row: -row[1][0])
    LINES = [f"{name}: {count} in {rooms} rooms" for name, (count, rooms) in FOUND]
    sys.stdout.write("\n".join([*LINES, f"{sum(count for _, (count, _) in FOUND)} in total", ""]))
