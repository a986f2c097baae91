"""Scenarios from anywhere: bounded in size and depth, read from files that end."""

import os
import time
from pathlib import Path

import pytest
from commands import Command, assert_ends

from nonholo.cli.scenario.files import parse_toml

BOMBS = {
    "deep arrays": ("a = " + "[" * 200_000, "nested deeper than 32"),
    "arrays": ("a = " + "[" * 40 + "]" * 40, "nested deeper than 32"),
    "tables": ("[" + ".".join("a" * 50) + "]", "nested deeper than 32"),
    "integer": ("a = " + "9" * 1_000_000, "Exceeds the limit"),
    "size": ("# " + "x" * (1 << 22), "it has more than 4.19 MB"),
    "bytes": ("a = 1\ud800", "cannot be read as a text file"),
}


@pytest.mark.parametrize("command", ["simulate", "sweep"])
@pytest.mark.parametrize("name", BOMBS)
def test_bombs_are_refused(name: str, command: str, nonholo: Command) -> None:
    """What would fill memory or stack is reported as a problem of the scenario."""
    text, told = BOMBS[name]
    Path("bomb.toml").write_bytes(text.encode(errors="surrogatepass"))
    assert_ends(nonholo(command, "bomb.toml"), 2, told)


@pytest.mark.parametrize("name", ["/dev/zero", "pipe", ".", "x" * 5000])
def test_files_that_do_not_end_are_refused(name: str, nonholo: Command) -> None:
    """Devices, pipes and folders are refused at once, a name that is too long as well."""
    os.mkfifo("pipe")
    begun = time.monotonic()
    assert_ends(nonholo("simulate", name), 2, "too long" if len(name) > 99 else "a folder, a device or a pipe")
    assert time.monotonic() - begun < 5


def test_a_setting_may_be_a_bomb(nonholo: Command) -> None:
    """A value of the command line is no better than a file."""
    assert nonholo("simulate", "sleigh", "--set", "run.steps=" + "9" * 10_000).exit_code == 2


@pytest.mark.parametrize("count", ["1000000000000000", "10000000000"])
def test_grids_that_fill_the_memory_are_refused(count: str, nonholo: Command) -> None:
    """A range is not made before it is known to fit, and nothing is left."""
    text = '[body]\nkind = "sleigh"\nmass = 1.0\ninertia = 1.0\na = 0.5\n[start]\nrestricted_velocity = [0.3, -1.0]\n'
    text += '[run]\ntime_step = 0.1\nsteps = 20\n[design]\nkind = "grid"\n[design.values]\n'
    Path("grid.toml").write_text(text + f'"body.a" = {{from = 0.1, to = 1.0, count = {count}}}\n')
    assert_ends(nonholo("sweep", "grid.toml", "-o", "a.zarr"), 2, "fit into memory")
    assert not Path("a.zarr").exists()


def test_what_is_nested_a_little_is_read() -> None:
    """The limit is far from what scenarios need."""
    assert parse_toml("a = " + "[" * 20 + "]" * 20)
