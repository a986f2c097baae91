"""`nonholo dataset`: what it lists, writes and refuses."""

import json
from collections.abc import Callable
from pathlib import Path

from typer.testing import Result

import nonholo as nh
from nonholo.ensembles import DEFINITIONS

Command = Callable[..., Result]


def test_every_data_set_is_listed(nonholo: Command) -> None:
    """The list has each name and what moves."""
    shown = nonholo("dataset", "--list").stdout
    assert all(name in shown for name in DEFINITIONS)


def test_it_writes_what_python_writes(nonholo: Command, tmp_path: Path) -> None:
    """The command and the function have the same numbers; the command of the record writes them again."""
    small = ("--orbits", "5", "--steps", "3", "--noise", "0.1", "--split", "0.6/0.2/0.2", "--rng", "2")
    done = nonholo("dataset", "sleigh", "-o", "command", *small, "-q")
    assert (done.exit_code, done.stdout.strip()) == (0, "command"), done.output
    nh.dataset("sleigh", "python", orbits=5, steps=3, noise=0.1, split=(0.6, 0.2, 0.2), rng=2)
    records = [json.loads((tmp_path / each / "metadata.json").read_text()) for each in ("command", "python")]
    assert records[0]["fields"] == records[1]["fields"]
    again = records[0]["command"].split()[1:]
    again[again.index("-o") + 1] = "again"
    assert nonholo(*again).exit_code == 0
    assert json.loads((tmp_path / "again" / "metadata.json").read_text())["fields"] == records[0]["fields"]


def test_a_function_in_a_file_is_a_data_set(nonholo: Command, tmp_path: Path) -> None:
    """The record names the file; its command writes the same numbers again."""
    lines = ("from types import SimpleNamespace", "import numpy as np", "import nonholo as nh")
    lines += ("def blades(speed=nh.Uniform(0.5, 1.0), a=nh.Uniform(0.1, 0.4)):",)
    lines += ("    start = {'configuration': np.eye(3), 'body_velocity': [0.2, speed, 0.0]}",)
    lines += ("    return SimpleNamespace(system=nh.ChaplyginSleigh(1.0, 1.0, a), **start)",)
    Path("own_blades.py").write_text("\n".join(lines))
    done = nonholo("dataset", "blades", "-o", "own", "--module", "own_blades.py", "--orbits", "4", "--steps", "3")
    assert done.exit_code == 0, done.output
    record = json.loads((tmp_path / "own" / "metadata.json").read_text())
    again = record["command"].split()[1:]
    again[again.index("-o") + 1] = "again"
    assert nonholo(*again).exit_code == 0
    assert json.loads((tmp_path / "again" / "metadata.json").read_text())["fields"] == record["fields"]


def test_errors_are_sentences(nonholo: Command) -> None:
    """A name, a folder or fractions that are missing or wrong leave with a sentence and code 2."""
    for arguments, said in {
        (): "--list",
        ("sleigh",): "-o FOLDER",
        ("slegh", "-o", "new"): "'sleigh'",
        ("sleigh", "-o", "new", "--split", "a/b"): "0.8/0.1/0.1",
        ("sleigh", "-o", "new", "--module", "none.py"): "path of a Python file",
        ("sleigh", "-o", ".cache/..", "--orbits", "2"): "must be new",
    }.items():
        Path(".cache").mkdir(exist_ok=True)
        Path("mine.txt").touch()
        done = nonholo("dataset", *arguments)
        assert done.exit_code == 2
        assert said in done.stderr
        assert "Traceback" not in done.stderr
