"""Errors made by hand, each in a copy of the repository; each must turn a test red.

`python tests/mutants.py [NAME ...] [--list]` tries those of tests/mutants.toml, or the rooms and errors that are named.
"""

import concurrent.futures
import dataclasses
import os
import queue
import re
import shutil
import subprocess
import sys
import tempfile
import time
import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[1]
_PYTEST = ("-m", "pytest", "-q", "-x", "--tb=short", "-n", "0")
# numba's cache does not notice callees in other files, nor the options of callers
_COMPILED = ("nonholo/kernels/", "nonholo/base/numerics/", "nonholo/base/compiled/")
_JAX = ROOT / "build" / "tests" / "jax"  # whose entries are named by what they were compiled from
_LIMIT = 600  # seconds
_FIRST = re.compile(r"^(?:FAILED|ERROR) (.+?)(?: - .*)?$", re.MULTILINE)


@dataclasses.dataclass(frozen=True)
class Mutant:
    """An error: what stands in a file exactly once, what stands there instead, and the tests that notice it."""

    name: str
    file: str
    old: str
    new: str
    why: str
    tests: tuple[str, ...]
    profile: str = "default"

    @property
    def room(self) -> str:
        """Return the first part of the name."""
        return self.name.partition(".")[0]

    def occurrences(self, root: Path = ROOT) -> int:
        """Return how often the text that is replaced stands in its file."""
        return (root / self.file).read_text().count(self.old)


def mutants() -> list[Mutant]:
    """Return the errors of the table, room by room."""
    rooms = tomllib.loads(Path(__file__).with_suffix(".toml").read_text()).items()
    rows = {f"{room}.{name}": row for room, named in rooms for name, row in named.items()}
    return [Mutant(name, **row | {"tests": tuple(row["tests"])}) for name, row in rows.items()]


def tried(mutant: Mutant, copy: Path, compiled: Path) -> tuple[bool, str]:
    """Apply an error in the copy, run its tests there and take it back; return whether and by what it was caught."""
    if mutant.occurrences(copy) != 1:
        return False, f"DOES NOT APPLY: {mutant.occurrences(copy)} places in {mutant.file}"
    path = copy / mutant.file
    text, before = path.read_text(), path.stat()
    with tempfile.TemporaryDirectory() as fresh:
        numba = Path(fresh) if mutant.file.startswith(_COMPILED) else compiled
        try:
            path.write_text(text.replace(mutant.old, mutant.new))
            code, output = _run(copy, numba, *_PYTEST, f"--profile={mutant.profile}", *mutant.tests)
        finally:
            path.write_text(text)
            os.utime(path, ns=(before.st_atime_ns, before.st_mtime_ns))  # what was compiled from it is still good
    if (first := _FIRST.search(output)) and (code == 1 or (code == 2 and mutant.file in output)):
        return True, f"caught {'by' if code == 1 else 'in collecting'} {first[1]}"
    return False, "SURVIVED" if code == 0 else f"SURVIVED, pytest ended with {code}: {output.splitlines()[-1:]}"


def _run(copy: Path, numba: Path, *arguments: str) -> tuple[int | None, str]:
    """Run Python on the package of the copy; return its exit status, None after the limit, and what it wrote."""
    own = {"PYTHONPATH": copy, "NUMBA_CACHE_DIR": numba, "JAX_COMPILATION_CACHE_DIR": _JAX, "PYTEST_ADDOPTS": ""}
    environment, command = os.environ | {name: str(value) for name, value in own.items()}, [sys.executable, *arguments]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, "text": True}
    try:
        done = subprocess.run(command, cwd=copy, env=environment, timeout=_LIMIT, **pipes)  # noqa: S603
    except subprocess.TimeoutExpired:
        return None, f"no end in {_LIMIT} s"
    return done.returncode, done.stdout


def _copied(copy: Path, numba: Path) -> None:
    """Copy what git tracks, or would, as it is in the working tree; prove that the copy has a package of its own."""
    command = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
    listed = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout  # noqa: S603
    for name in filter(lambda name: (ROOT / name).is_file(), listed.split("\0")):
        (copy / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(ROOT / name, copy / name)
    result = _run(copy, numba, "-c", "import nonholo; print(nonholo.__file__)")
    if result != (0, f"{copy / 'nonholo' / '__init__.py'}\n"):
        raise RuntimeError(f"Not the package of the copy: {result}")


def main(arguments: list[str]) -> int:
    """Try or list the errors that are named, by room or in full, or all; return 1 if one was not caught."""
    names, table = set(arguments) - {"--list"}, mutants()
    if unknown := names - {name for mutant in table for name in (mutant.name, mutant.room)}:
        sys.exit(f"No error is called {', '.join(sorted(unknown))}.")
    chosen = [mutant for mutant in table if not names or names & {mutant.name, mutant.room}]
    if "--list" in arguments:
        sys.stdout.writelines(f"{mutant.name}: {mutant.why}, {mutant.file}\n" for mutant in chosen)
        return 0
    with tempfile.TemporaryDirectory() as folder:
        caught = _all_tried(chosen, Path(folder).resolve())
    sys.stdout.write(f"{caught} of {len(chosen)} caught\n")
    return int(caught < len(chosen))


def _all_tried(chosen: list[Mutant], folder: Path) -> int:
    """Try errors on all cores, each core in a copy of its own; return how many were caught."""
    copies: queue.SimpleQueue[Path] = queue.SimpleQueue()
    for core in range(os.cpu_count() or 1):
        _copied(folder / f"{core}", folder / "numba")
        copies.put(folder / f"{core}")

    def report(mutant: Mutant) -> bool:
        begun, copy = time.perf_counter(), copies.get()
        caught, words = tried(mutant, copy, folder / "numba")
        copies.put(copy)
        sys.stdout.write(f"{mutant.name}: {words}, {time.perf_counter() - begun:.0f} s\n")
        sys.stdout.flush()
        return caught

    with concurrent.futures.ThreadPoolExecutor(copies.qsize()) as pool:
        return sum(pool.map(report, chosen))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
