"""`python tests/participles.py [FOLDER ...]`: functions, arguments and variables that are named by a bare participle.

A value is named by a noun and a function by a verb. What stays is in `ARGUED`, with the reason.
"""

import ast
import re
import sys
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parents[1]
ARGUED = {
    "forced": "a system under forces, as in `nh.Forced`",
    "reduced": "the reduced momentum, of the theory",
    "restricted": "the restricted momentum, of the theory",
    "conserved": "conserved momenta, of the theory",
    "converged": "a public attribute of results, as in optimizers",
    "elapsed": "the elapsed time, since a start",
    "LocusSection.isolated": "isolated points of a curve; public",
    **dict.fromkeys(
        ("BladeTrack.enlarged", "BranchesPicture.found", "EnergyError.expected", "SweepMap.drawn", "SweepMap.ended"),
        "a public attribute of a picture",
    ),
    **dict.fromkeys(("Report.failed", "Report.passed", "Result.passed"), "a public attribute, as in test runners"),
    "Steering.missed": "a public attribute: by what the goal is missed",
    "check_group.compiled": "a public argument",
}
MOST = 40
_IRREGULAR = re.compile(
    "begun|broken|brought|built|caught|chosen|done|drawn|felt|found|given|gone|grown|held|hidden|kept|known|lost|made|"
    "meant|met|said|seen|sent|shaken|shown|sought|spent|stood|stuck|swept|taken|taught|thought|thrown|told|torn|won|"
    "worn|written"
)
_REGULAR = re.compile("[a-z]{2,}ed")
_NOUNS = {"bleed", "bound", "breed", "feed", "need", "seed", "speed"}


def is_participle(name: str) -> bool:
    """Tell whether a name is one bare participle, whatever underscores stand around it."""
    bare = name.strip("_")
    return bare not in _NOUNS and bool(_IRREGULAR.fullmatch(bare) or _REGULAR.fullmatch(bare))


def names(tree: ast.AST, owner: str = "") -> Iterator[tuple[int, str]]:
    """Yield the names that a module defines, each with its line: functions, variables; arguments, what a class has.

    The latter have the name of their owner before them.
    """
    for node in ast.iter_child_nodes(tree):
        inside = owner
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            inside = f"{node.name}."
            if isinstance(node, ast.FunctionDef):
                yield node.lineno, f"{owner if isinstance(tree, ast.ClassDef) else ''}{node.name}"
        elif isinstance(node, ast.arg):
            yield node.lineno, owner + node.arg
        elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            yield node.lineno, (owner if isinstance(tree, ast.AnnAssign) else "") + node.id
        yield from names(node, inside)


def participles(folder: Path) -> Iterator[tuple[str, str]]:
    """Yield each participle below a folder that nobody argues for, with its place."""
    for path in sorted(folder.rglob("*.py")):
        for line, name in names(ast.parse(path.read_text())):
            bare = name.rpartition(".")[2]
            if is_participle(bare) and not {name, bare.strip("_")} & ARGUED.keys():
                yield f"{path}:{line}", bare


if __name__ == "__main__":
    lines = [" ".join(each) for folder in sys.argv[1:] or [ROOT / "nonholo"] for each in participles(Path(folder))]
    print("\n".join(lines))  # noqa: T201
    sys.exit(bool(lines))
