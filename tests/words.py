"""`python tests/words.py`: the words of the house in code, tests and pages; the old dialect in pages and docstrings.

words.toml lists them. In the library messages count as docstrings do.
"""

import ast
import inspect
import re
import sys
import tomllib
from collections.abc import Iterator, Sequence
from pathlib import Path

from participles import nodes_of, participles

ROOT = Path(__file__).parents[1]
TABLE = tomllib.loads(Path(__file__).with_suffix(".toml").read_text("utf-8"))
FOLDERS = ("nonholo", "nonholo_paper", "docs", "tests", "benchmarks", "scenarios")
READ = (".py", ".pyi", ".md", ".toml", ".j2", ".cff", ".c", ".css")
NOT_READ = ("tests/words.toml", "tests/test_words.py")
# titles of works, past releases
QUOTED = {"docs/references.md": r"\*[^*\n]+\*", "CHANGELOG.md": r"(?s)\n## \[0\.[12]\..*"}
QUOTATION = r"“[^”]*”"
# by scripts
GENERATED = re.compile(r"api/.*|reference/(?!symbols).*|gallery/README\.md|(errata|paper|project/figures|tests)\.md")
NO_PROSE = {"references.md", "project/migration.md"}
MOST = 80_000


def files(root: Path) -> list[str]:
    """Return the files of a checkout whose words count."""
    paths = [path for folder in FOLDERS for path in (root / folder).rglob("*")] + list(root.glob("*"))
    names = {path.relative_to(root).as_posix() for path in paths if path.suffix in READ and path.is_file()}
    return sorted(name for name in names if not name.startswith(NOT_READ))


def stems(root: Path) -> list[str]:
    """Return the names of files, without endings, that have a word of the list in them: they are cited as they are."""
    names = {Path(name).stem for name in files(root)}
    return sorted(name for name in names if any(re.search(word, name, re.IGNORECASE) for word in TABLE["spelling"]))


def protected(name: str, text: str, cited: Sequence[str] = ()) -> list[tuple[int, int]]:
    """Return the stretches of a text that are left alone: quotations, names of files, what the list allows."""
    quoted = [QUOTATION, QUOTED.get(name, QUOTATION)]
    fixed = map(re.escape, (*cited, *TABLE["allowed"].get(name, ())))
    return [match.span() for pattern in (*quoted, *fixed) for match in re.finditer(pattern, text)]


def words(name: str, text: str, patterns: dict[str, str], cited: Sequence[str] = ()) -> Iterator[tuple[int, str]]:
    """Yield the places of words on the list, with what to write instead."""
    lowered = text.lower()  # matched much faster than text of both cases
    matches = [(m, instead) for pattern, instead in patterns.items() for m in re.finditer(pattern, lowered)]
    spans = protected(name, text, cited) if matches else []
    for match, instead in matches:
        if not any(start <= match.start() < end for start, end in spans):
            yield match.start(), f"'{' '.join(match[0].split())}': write {match.expand(instead)}"


def complaints(root: Path = ROOT) -> list[str]:
    """Return a line for each word on the list, with its place and what to write instead."""
    texts = {name: (root / name).read_text("utf-8") for name in files(root)}
    vocabulary = "\n".join(set(re.findall(r"\w+", "\n".join(texts.values()).lower())))
    spelling = {word: to for word, to in TABLE["spelling"].items() if re.search(word, vocabulary)}
    patterns, cited = spelling | TABLE["phrases"], stems(root)
    pages = {"README.md", "CONTRIBUTING.md", *(f"docs/{name}" for name in lengths(root) if name not in NO_PROSE)}
    checked = [(name, 1, text, patterns) for name, text in texts.items()]
    checked += [(name, 1, texts[name], TABLE["prose"]) for name in sorted(pages)]
    checked += [(name, *each, TABLE["prose"]) for name in texts if in_library(name) for each in strings(root / name)]
    return [
        f"{name}:{first + text.count(chr(10), 0, at)}: {complaint}"
        for name, first, text, wanted in checked
        for at, complaint in words(name, text, wanted, cited)
    ] + [
        f"{place}: {name!r} is a bare participle; name values by nouns, functions by verbs, or argue in participles.py"
        for place, name in participles(root / "nonholo")
    ]


def in_library(name: str) -> bool:
    """Return whether a file is code of the library with prose to check."""
    return name.startswith(("nonholo/", "nonholo_paper/")) and name.endswith((".py", ".pyi"))


def strings(file: Path) -> Iterator[tuple[int, str]]:
    """Yield the docstrings and messages of a file with their first lines."""
    for node in nodes_of(file):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and " " in node.value:
            yield node.lineno, inspect.cleandoc(node.value)


def lengths(root: Path = ROOT) -> dict[str, int]:
    """Return how many words each handwritten page of the docs has."""
    pages = {path.relative_to(root / "docs").as_posix(): path for path in sorted((root / "docs").rglob("*.md"))}
    return {name: len(path.read_text("utf-8").split()) for name, path in pages.items() if not GENERATED.match(name)}


def too_long(lengths: dict[str, int]) -> list[str]:
    """Return a complaint if the handwritten pages have more words than they may."""
    longest = ", ".join(sorted(lengths, key=lengths.__getitem__)[:-4:-1])
    message = f"{sum(lengths.values())} words in pages of docs, at most {MOST}: shorten one, the longest are {longest}"
    return [message] if sum(lengths.values()) > MOST else []


if __name__ == "__main__":
    pages = lengths()
    print("\n".join(lines := complaints() + too_long(pages)))  # noqa: T201
    print(f"{sum(pages.values())} words in the handwritten pages of docs, of at most {MOST}")  # noqa: T201
    sys.exit(bool(lines))
