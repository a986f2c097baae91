"""Wheels: for each machine whose library is there one with its tag, its library, and nothing of the tests."""

import base64
import csv
import hashlib
import importlib
import importlib.metadata
import os
import re
import shutil
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path
from typing import Any

import pytest
from scripts import script

from nonholo.base.compiled import first_way, library

ROOT = Path(__file__).parents[1]
TAGS = {
    "linux-x86_64": "manylinux_2_17_x86_64", "linux-aarch64": "manylinux_2_17_aarch64",
    "darwin-arm64": "macosx_11_0_arm64", "windows-amd64": "win_amd64",
}  # fmt: skip
OF_C = {"free", "malloc", "memcpy", "memmove", "memset"}
"""What any C library has, in any version."""
LARGEST = 4_000_000  # bytes


def _undefined(file: Path) -> set[str]:
    """Return what a library of Linux asks of whoever loads it."""
    assert b"GLIBC" not in file.read_bytes()
    tool = shutil.which("nm") or pytest.skip("no nm here")
    report = subprocess.run([tool, "-D", "--undefined-only", file], capture_output=True, text=True, check=True)  # noqa: S603
    return {line.split()[-1] for line in report.stdout.splitlines()}


def _wheel(machine: str, folder: Path) -> Path:
    pytest.importorskip("hatchling")
    command = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(folder)]
    subprocess.run(command, cwd=ROOT, env={**os.environ, "NONHOLO_MACHINE": machine}, check=True)  # noqa: S603
    (file,) = folder.iterdir()
    return file


@pytest.mark.parametrize("machine", TAGS)
def test_wheel_of_a_machine(machine: str, tmp_path: Path) -> None:
    """It has the tag of its machine, that machine's library alone, the modules of pages, and true hashes."""
    name = library.name_of_library(machine)
    if machine != library.this_machine() and not library.place(name):
        pytest.skip(f"no library for {machine} here")
    if first_way() != "library":
        pytest.skip("kernels run by another way")
    file = _wheel(machine, tmp_path)
    assert file.name.endswith(f"-py3-none-{TAGS[machine]}.whl")
    assert file.stat().st_size < LARGEST
    with zipfile.ZipFile(file) as wheel:
        wheel.extractall(tmp_path)
        names = set(wheel.namelist())
        (record,) = (each for each in names if each.endswith(".dist-info/RECORD"))
        rows = {path: digest for path, digest, _ in csv.reader(wheel.read(record).decode().splitlines())}
        assert set(rows) == names
        for each in names - {record}:
            digest = base64.urlsafe_b64encode(hashlib.sha256(wheel.read(each)).digest()).rstrip(b"=").decode()
            assert rows[each] == f"sha256={digest}"
    assert {each.split("/")[0] for each in names} == {"nonholo", "nonholo_paper", record.split("/")[0]}
    compiled = {each.removeprefix("nonholo/kernels/") for each in names if "/kernels-" in each}
    runs = importlib.import_module("nonholo.kernels").FLAT_RUNS
    assert compiled == {name, *map(library.name_of_module, runs)}
    if machine.startswith("linux"):
        assert _undefined(tmp_path / "nonholo" / "kernels" / name) <= OF_C


def test_wheel_of_no_machine(tmp_path: Path) -> None:
    """Kernels run as Python from it, and it has nothing compiled."""
    file = _wheel("python", tmp_path)
    assert file.name.endswith("-py3-none-any.whl")
    assert not [name for name in zipfile.ZipFile(file).namelist() if "kernels-" in name]


PACKAGES = ("pyodide@0.25.1", "@emscripten-forge/numpy@2.1.1-py311hc8e14bb-0")
"""Python 3.11 and NumPy for a browser. npm has no SciPy for it: an empty module shows that nothing uses it."""
PURE = ("jaxtyping", "lazy_loader", "markdown_it", "mdurl", "pygments", "rich", "wadler_lindig")
PROGRAM = """
import numpy as np
import nonholo as nh
top = nh.SuslovTop(np.diag([1.0, 2.0, 3.0]) + 0.1)
start = {"restricted_velocity": (0.3, 0.4)}
orbit = nh.simulate(nh.discretize(top, 0.1), **start, steps=100)
flow = nh.flow(top, **start, times=np.linspace(0.0, 2.0, 5))
bits = orbit.configuration[-1].tobytes().hex() + flow.configuration[-1].tobytes().hex()
"""
IN_NODE = """
import { loadPyodide } from "./node_modules/pyodide/pyodide.mjs";
const python = await loadPyodide();
for (const name of ["numpy/lib/python3.11/site-packages", "packages", "wheel"]) {
  python.FS.mkdirTree("/" + name);
  python.FS.mount(python.FS.filesystems.NODEFS, { root: name }, "/" + name);
  python.runPython(`import sys; sys.path.insert(0, "/${name}")`);
}
python.runPython(process.argv[2]);
console.log(python.globals.get("bits"));
"""


@pytest.mark.profile("browser", instead="test_wheel_of_no_machine")
def test_a_browser_runs_it_with_the_same_bits(tmp_path: Path) -> None:
    """A map and a flow in Pyodide, under node."""
    node, npm = (shutil.which(tool) or pytest.skip(f"there is no {tool}") for tool in ("node", "npm"))
    subprocess.run([npm, "install", "--no-audit", "--no-fund", *PACKAGES], cwd=tmp_path, check=True)  # noqa: S603
    (numpy,) = tmp_path.glob("node_modules/@emscripten-forge/numpy/pkg/*.tar.gz")
    shutil.unpack_archive(numpy, tmp_path / "numpy", filter="data")
    packages = tmp_path / "packages"
    for name in PURE:
        shutil.copytree(Path(str(importlib.import_module(name).__file__)).parent, packages / name)
    (record,) = (file for file in importlib.metadata.files("jaxtyping") or () if file.name == "METADATA")
    shutil.copytree(Path(str(record.locate())).parent, packages / record.parent.name)
    (packages / "scipy.py").touch()
    shutil.unpack_archive(_wheel("python", tmp_path / "wheels"), tmp_path / "wheel", "zip")
    (tmp_path / "run.mjs").write_text(IN_NODE)
    result = subprocess.run([node, "run.mjs", PROGRAM], cwd=tmp_path, capture_output=True, text=True, check=True)  # noqa: S603
    here: dict[str, str] = {}
    exec(PROGRAM, here)  # noqa: S102
    assert result.stdout.split()[-1] == here["bits"]


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
    (tmp_path / "docs").mkdir()
    (tmp_path / "docs" / "index.md").write_text("nonholo-1.0-py3-none")
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
