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


def test_errors_are_sentences(nonholo: Command) -> None:
    """A name, a folder or fractions that are missing or wrong leave with a sentence and code 2."""
    for arguments, said in {
        (): "--list",
        ("sleigh",): "-o FOLDER",
        ("slegh", "-o", "new"): "'sleigh'",
        ("sleigh", "-o", "new", "--split", "a/b"): "0.8/0.1/0.1",
        ("sleigh", "-o", ".cache/..", "--orbits", "2"): "must be new",
    }.items():
        Path(".cache").mkdir(exist_ok=True)
        Path("mine.txt").touch()
        done = nonholo("dataset", *arguments)
        assert done.exit_code == 2
        assert said in done.stderr
        assert "Traceback" not in done.stderr
