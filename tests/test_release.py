"""A release: what is not known yet is listed and is in its way; package, recipe and citation say the same."""

import re
import tomllib
from pathlib import Path
from typing import Any

import pytest
from scripts import script

ROOT = Path(__file__).parents[1]
RELEASE: Any = script(".ci/release.py")
_FOLDERS = (".ci", ".github", "docs", "joss", "recipe")
_OF_CONDA = {"dask": "dask-core", "matplotlib": "matplotlib-base"}


def test_every_placeholder_is_listed() -> None:
    """A mark that stands in a file is in the list, with that file; each line of the list is true."""
    paths = [path for folder in _FOLDERS for path in (ROOT / folder).rglob("*.*")] + list(ROOT.glob("*.*"))
    texts = {path: path.read_text() for path in paths if path.suffix in {".cff", ".md", ".toml", ".yaml", ".yml"}}
    list_itself = ROOT / ".ci" / "placeholders.toml"
    marks = {(mark, path) for path, text in texts.items() for mark in re.findall(r"PLACEHOLDER-[A-Z]+", text)}
    listed = {(name, ROOT / file) for name, entry in RELEASE.PLACEHOLDERS.items() for file in entry["files"]}
    assert {(mark, path) for mark, path in marks if path != list_itself} == listed


def test_a_placeholder_is_in_the_way(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """One that is left is named with its line and meaning, two versions are named; without them nothing is."""
    (tmp_path / "recipe").mkdir()
    (tmp_path / "pyproject.toml").write_text('version = "1.0"\n')
    (tmp_path / "CITATION.cff").write_text("version: 1.0\ndoi: PLACEHOLDER-DOI\n")
    (tmp_path / "recipe" / "recipe.yaml").write_text('context:\n  version: "1.0"\n')
    (tmp_path / "CHANGELOG.md").write_text("## [1.0]\n")
    monkeypatch.setattr(RELEASE, "ROOT", tmp_path)
    monkeypatch.setattr(RELEASE, "PLACEHOLDERS", {"PLACEHOLDER-DOI": {"what": "the DOI", "files": ["CITATION.cff"]}})
    assert RELEASE.obstacles() == ["CITATION.cff:2: PLACEHOLDER-DOI, the DOI"]
    (tmp_path / "CITATION.cff").write_text("version: 1.0\n")
    assert RELEASE.obstacles() == []
    (tmp_path / "CHANGELOG.md").write_text("## [Unreleased]\n")
    assert "CHANGELOG.md: version Unreleased" in RELEASE.obstacles()


def test_the_recipe_is_that_of_the_project() -> None:
    """It has the version and the dependencies of pyproject.toml, under their names among conda's packages."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    named = [re.match(r"([\w-]+)(.*)", entry) for entry in project["dependencies"]]
    needs = {f"{_OF_CONDA.get(m[1], m[1])} {m[2]}" for m in named if m} | {f"python {project['requires-python']}"}
    recipe = (ROOT / "recipe" / "recipe.yaml").read_text()
    assert set(re.findall(r"- (.*)", recipe.split("  run:\n")[1].split("  run_constraints:")[0])) == needs
    versions = RELEASE.versions()
    assert versions["pyproject.toml"] == versions["recipe/recipe.yaml"] == versions["CITATION.cff"]
