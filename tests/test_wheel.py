"""Wheels: for each machine whose library is there one with its tag, its library, and nothing of the tests."""

import base64
import csv
import hashlib
import importlib
import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from nonholo.base.compiled import first_way, library

ROOT = Path(__file__).parents[1]
TAGS = {
    "linux-x86_64": "manylinux_2_17_x86_64",
    "linux-aarch64": "manylinux_2_17_aarch64",
    "darwin-arm64": "macosx_11_0_arm64",
    "windows-amd64": "win_amd64",
}
OF_C = {"free", "malloc", "memcpy", "memmove", "memset"}
"""What any C library has, in any version."""
LARGEST = 4_000_000  # bytes


def _undefined(file: Path) -> set[str]:
    """Return what a library of Linux asks of whoever loads it."""
    assert b"GLIBC" not in file.read_bytes()
    tool = shutil.which("nm") or pytest.skip("no nm here")
    told = subprocess.run([tool, "-D", "--undefined-only", file], capture_output=True, text=True, check=True)  # noqa: S603
    return {line.split()[-1] for line in told.stdout.splitlines()}


@pytest.mark.parametrize("machine", TAGS)
def test_wheel_of_a_machine(machine: str, tmp_path: Path) -> None:
    """It has the tag of its machine, that machine's library alone, the modules of pages, and true hashes."""
    name = library.name_of_library(machine)
    if machine != library.this_machine() and not library.place(name):
        pytest.skip(f"no library for {machine} here")
    if first_way() != "library":
        pytest.skip("kernels run by another way")
    pytest.importorskip("hatchling")
    command = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(tmp_path)]
    subprocess.run(command, cwd=ROOT, env={**os.environ, "NONHOLO_MACHINE": machine}, check=True)  # noqa: S603
    (file,) = tmp_path.iterdir()
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
