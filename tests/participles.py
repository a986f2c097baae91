"""Functions, arguments and variables that are named by a bare participle: a part of `python tests/words.py`.

A value is named by a noun and a function by a verb. What stays is in `ARGUED`, with the reason.
"""

import ast
import functools
import re
from collections.abc import Iterator
from pathlib import Path

ARGUED = {
    "forced": "a system under forces, as in `nh.Forced`",
    "reduced": "the reduced momentum, of the theory",
    "restricted": "the restricted momentum, of the theory",
    "conserved": "conserved momenta, of the theory",
    "converged": "a public attribute of results, as in optimizers",
    "elapsed": "the elapsed time, since a start",
    "applied": "a matrix applied to vectors: their product",
    "shown": "what was got, shown in an error; all rooms ask for it",
    "prescribed": "a public argument of systems: prescribed motions",
    "posed": "a public option of motions: with poses",
    "decoded": "a public option of `to_dataset`",
    "compiled": "a public option of `check_group`",
}
MEMBERS = {
    *("added", "carried", "certified", "chosen", "displaced", "done", "drawn", "ended", "enlarged", "expected"),
    *("failed", "finished", "found", "isolated", "joined", "made", "missed", "moved", "passed", "turned"),
    "uncertified",
}
"""Public attributes and methods of systems, orbits, branches, logs of events, pictures and reports; keys of stores."""
MOST = 40
_IRREGULAR = re.compile(
    "begun|broken|brought|built|caught|chosen|done|drawn|felt|found|given|gone|grown|held|hidden|kept|known|lost|made|"
    "meant|met|said|seen|sent|shaken|shown|sought|spent|stood|stuck|swept|taken|taught|thought|thrown|told|torn|won|"
    "worn|written"
)
_REGULAR = re.compile("[a-z]{2,}ed")
_NOUNS = {"bleed", "bound", "breed", "feed", "need", "seed", "speed"}


def is_participle(name: str) -> bool:
    """Return whether a name is one bare participle, whatever underscores stand around it."""
    bare = name.strip("_")
    return bare not in _NOUNS and bool(_IRREGULAR.fullmatch(bare) or _REGULAR.fullmatch(bare))


@functools.cache
def nodes_of(file: Path) -> tuple[ast.AST, ...]:
    """Return all nodes of a module, which are the same for all who ask in one process."""
    return tuple(ast.walk(ast.parse(file.read_text())))


def every_name(file: Path) -> Iterator[tuple[ast.AST, str]]:
    """Yield the names that a module defines, of functions, arguments and variables, each with its definition."""
    for node in nodes_of(file):
        if isinstance(node, ast.FunctionDef):
            yield node, node.name
        elif isinstance(node, ast.arg):
            yield node, node.arg
        elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            yield node, node.id


def _members(owner: ast.ClassDef) -> Iterator[ast.AST]:
    """Yield what defines public members of a class."""
    for node in owner.body:
        target = node.target if isinstance(node, ast.AnnAssign) else node
        if getattr(target, "name", getattr(target, "id", None)) in MEMBERS:
            yield target


def participles(folder: Path) -> Iterator[tuple[str, str]]:
    """Yield each participle below a folder that nobody argues for, with its place."""
    for path in sorted(folder.rglob("*.py")):
        public = {id(part) for node in nodes_of(path) if isinstance(node, ast.ClassDef) for part in _members(node)}
        for node, name in every_name(path):
            if is_participle(name) and name.strip("_") not in ARGUED and id(node) not in public:
                yield f"{path.relative_to(folder.parent)}:{getattr(node, 'lineno', 0)}", name
