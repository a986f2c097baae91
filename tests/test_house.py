"""docs/house.md is true, the words of the house are kept, the zoo is what it says, names are promises."""

import ast
import inspect
import re
import tomllib
from pathlib import Path

import numpy as np
import pytest
import words
from participles import ARGUED, MEMBERS, MOST, every_name, nodes_of
from problems import PROBLEMS, Problem

import nonholo as nh

ROOT = Path(__file__).parents[1]
PAGE = (ROOT / "docs" / "house.md").read_text()
LIBRARY = ROOT / "nonholo"
FOLDERS = [path.parent for path in LIBRARY.rglob("__init__.py")]
FILES = sorted(LIBRARY.rglob("*.py"))
_FAMILIES = ("Top", "Sleigh", "RigidBody", "LLSystem", "LRSystem")
_BOXES, _ROOMS, _LINES = 16, 17, 40


def _boxes(folder: Path) -> list[Path]:
    files = [path for path in folder.glob("*.py") if path.name != "__init__.py"]
    return files + [path for path in folder.iterdir() if (path / "__init__.py").exists()]


def _code_lines(function: ast.FunctionDef, text: list[str]) -> int:
    body = function.body[1:] if ast.get_docstring(function) else function.body
    head = range(function.lineno, function.body[0].lineno)
    numbers = {*head, *(n for node in body for n in range(node.lineno, (node.end_lineno or 0) + 1))}
    return sum(bool(text[n - 1].strip()) and not text[n - 1].strip().startswith("#") for n in numbers)


def test_the_floors_are_those_that_are_checked() -> None:
    """The picture of the rooms is the contract of import-linter, and every room stands in the table."""
    contracts = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["importlinter"]["contracts"]
    (layers,) = (contract["layers"] for contract in contracts if contract.get("containers") == ["nonholo"])
    picture = re.search(r"## The rooms.*?```\n(.*?)```", PAGE, re.DOTALL)
    assert picture is not None
    assert [line.split() for line in picture[1].splitlines()] == [re.split(r"[ |]+", floor) for floor in layers]
    rooms = {path.name for path in _boxes(LIBRARY)}
    listed = [line.split("|")[1] for line in PAGE.splitlines() if line.startswith("| `")]
    assert rooms == set(re.findall(r"`(\w+)`", " ".join(listed)))


@pytest.mark.parametrize("place", sorted(set(re.findall(r"`((?:[a-z_]+/)+(?:\w+\.\w+)?)`", PAGE))))
def test_what_it_names_is_there(place: str) -> None:
    """A file or a folder that the page names exists, in the library or in the repository."""
    assert any((folder / place).exists() for folder in (ROOT, LIBRARY, LIBRARY / "simulation", LIBRARY / "discrete"))


def test_what_it_counts() -> None:
    """No crowded folder, no long function, no question about the class of a system."""
    crowded = [str(folder) for folder in FOLDERS if len(_boxes(folder)) > (_ROOMS if folder == LIBRARY else _BOXES)]
    long, questions = [], []
    for file in FILES:
        text = file.read_text().splitlines()
        for node in nodes_of(file):
            if isinstance(node, ast.FunctionDef) and _code_lines(node, text) > _LINES:
                long.append(f"{file}:{node.name}")
            if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "isinstance":
                kind = ast.unparse(node.args[1])
                questions += [f"{file}:{node.lineno}"] * any(kind.endswith(name) for name in _FAMILIES)
    assert (crowded, long, questions) == ([], [], [])
    assert f"at most {_BOXES} files and folders" in PAGE
    assert f"the house itself has {_ROOMS} rooms" in PAGE
    assert f"at most {_LINES} lines of code" in PAGE


def test_no_word_of_the_list_is_written() -> None:
    """No file of the repository has a word of `words.toml`, and no name is one bare participle."""
    assert words.complaints() == []


def test_values_have_nouns_and_functions_verbs() -> None:
    """Participles that are argued for are few, and used; docstrings begin with a noun or a verb."""
    assert len(ARGUED) + len(MEMBERS) <= MOST
    used = {name.strip("_") for file in FILES for _, name in every_name(file)}
    assert {*ARGUED, *MEMBERS} <= used
    begins = re.compile(r'^\s*r?"""(What|That|Those|Whoever) ', re.MULTILINE)
    assert [str(file) for file in FILES if begins.search(file.read_text())] == []


@pytest.mark.parametrize("body", ["SuslovBody|suslov_body", "SleighBody"], ids=["top", "sleigh"])
def test_a_closed_form_stands_in_three_files(body: str) -> None:
    """The rooms that run it name a body in the places that the page lists: kernel, export and entry."""
    files = [file for room in ("kernels", "discrete", "simulation") for file in (LIBRARY / room).rglob("*.py")]
    named = {str(file.relative_to(LIBRARY)) for file in files if re.search(body, file.read_text())}
    listed = {"kernels/__init__.py", "discrete/routes/_normal_forms.py"}
    assert all(f"`{place}`" in PAGE for place in listed)
    assert listed <= named
    assert [str(Path(place).parent) for place in named - listed] == ["kernels"]


@pytest.mark.parametrize("problem", PROBLEMS, ids=lambda p: p.name)
def test_tags_are_true(problem: Problem) -> None:
    """Balanced problems have no coupling, flat ones a singular mass tensor, irregular ones D <= 2 |c|^2."""
    system = problem.system.canonical
    coupling = system.coupling if isinstance(system, nh.SuslovTop) else system.a
    assert ("balanced" in problem.tags) == (not np.any(coupling))
    if isinstance(system, nh.SuslovTop):
        assert ("flat" in problem.tags) == (abs(np.linalg.det(system.mass_tensor)) < 1e-12)
        regular = np.linalg.det(system.constrained_inertia) > 2 * coupling @ coupling
        assert ("irregular" in problem.tags) == (not regular)


def test_no_module_shadows_a_public_name() -> None:
    """A room or module directly under the package with a public function's name would replace it on import."""
    modules = {path.stem for path in LIBRARY.iterdir()}
    functions = {name for name in dir(nh) if not inspect.ismodule(getattr(nh, name))}
    assert not modules & functions


@pytest.mark.parametrize("name", dir(nh))
def test_every_public_name_has_an_example(name: str) -> None:
    """Each public name resolves and its docstring holds a doctest."""
    thing = getattr(nh, name)
    if not inspect.ismodule(thing):
        assert ">>>" in (thing.__doc__ or ""), name


def test_unknown_names_are_refused() -> None:
    """A misspelt name is an AttributeError as in any module."""
    with pytest.raises(AttributeError, match="no attribute 'symulate'"):
        _ = nh.symulate
