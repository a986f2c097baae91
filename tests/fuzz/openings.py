"""One trial of a store: it is damaged or edited, then opened, shown, resumed, extended or exported in a worker."""

import contextlib
import hashlib
import random
import shutil
import tempfile
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

from fuzz import shelf
from fuzz.damage import damage_file, edit_json
from fuzz.judge import Verdict, of_exception

import nonholo as nh
from nonholo.ensembles import sweep_to_csv

KINDS = {"damage": damage_file, "edit": edit_json}
FAMILIES = {"orbit": (shelf.ORBIT, shelf.RUN, shelf.UNFINISHED), "sweep": (shelf.SWEEP, shelf.SWEEP_UNFINISHED)}


class Trial(NamedTuple):
    """What is done to which store, by which draw, and how it is opened then; "none" leaves the store alone."""

    family: str
    store: str
    kind: str
    seed: int
    opening: str


def trials(family: str, kind: str, count: int, seed: int) -> list[Trial]:
    """Return the trials of this many damaged stores: each is opened in every way."""
    stores, openings = FAMILIES[family], _OPENINGS[family]
    drawn = [(stores[i % len(stores)], kind, seed + i) for i in range(count)]
    return [Trial(family, *each, opening) for each in drawn for opening in openings]


def _info(store: Path) -> dict[str, bytes]:
    """Show the store by the command; its text may differ, but must not control a terminal."""
    from typer.testing import CliRunner

    from nonholo.cli._app import app

    done = CliRunner().invoke(app, ["info", str(store)])
    if done.exception is not None and not isinstance(done.exception, SystemExit):
        raise done.exception
    return {"control": str("\x1b]" in done.output).encode()}


def _csv(write: Callable[[Any, Any], Any]) -> Callable[[Path], dict[str, bytes]]:
    def exported(store: Path) -> dict[str, bytes]:
        write(store, Path("exported.csv"))
        return {"table": Path("exported.csv").read_bytes()}

    return exported


_OPENINGS: dict[str, dict[str, Callable[[Path], dict[str, bytes]]]] = {
    "orbit": {
        "load": lambda store: shelf.numbers_of(nh.load_orbit(store)),
        "info": _info,
        "resume": lambda store: shelf.numbers_of(nh.resume(store)),
        "extend": lambda store: shelf.numbers_of(nh.extend(store, 90)),
        "export": _csv(nh.io.store_to_csv),
    },
    "sweep": {
        "load": lambda store: shelf.numbers_of(nh.load_sweep(store)),
        "info": _info,
        "resume": lambda store: shelf.numbers_of(nh.resume(store, task=shelf.task, scheduler="synchronous")),
        "export": _csv(sweep_to_csv),
    },
}


def prepared() -> Callable[[Trial], tuple[str, Verdict]]:
    """Return what does trials; it holds whole stores, and what opening them gives."""
    home = Path(tempfile.mkdtemp(prefix="fuzz-"))
    shelf.fill(home)
    expected: dict[tuple[str, str], dict[str, bytes] | Verdict] = {}

    def do(trial: Trial) -> tuple[str, Verdict]:
        key = trial.store, trial.opening
        if key not in expected:
            expected[key] = _tried(trial._replace(kind="none"), home)[1]
        said, result = _tried(trial, home)
        return said, result if isinstance(result, Verdict) else _compared(result, expected[key])

    return do


def _tried(trial: Trial, home: Path) -> tuple[str, dict[str, bytes] | Verdict]:
    with _beside_others(home, trial.store) as store:
        said = KINDS[trial.kind](store, random.Random(trial.seed)) if trial.kind != "none" else ""  # noqa: S311
        before = prints_of(_victim(store))
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                result: dict[str, bytes] | Verdict = _OPENINGS[trial.family][trial.opening](store)
        except Exception as failure:  # whatever comes is classified
            result = of_exception(failure, [])
        if Path("PWNED").exists():
            result = Verdict("ran", "code of the store's choice ran")
        elif before != prints_of(_victim(store)):
            result = Verdict("outside", "another store was changed")
        return said, result


def _victim(store: Path) -> Path:
    return store.parent / "victim.zarr"


def _compared(result: dict[str, bytes], expected: dict[str, bytes] | Verdict) -> Verdict:
    if isinstance(expected, Verdict):
        return Verdict("silent", "accepted, though the whole store is refused")
    other = {name for name in result.keys() | expected.keys() if result.get(name) != expected.get(name)}
    if result.get("table") and expected["table"].startswith(result["table"]):
        other -= {"table"}  # of a run that has lost a record it ends there, with a warning
    return Verdict("silent", f"other numbers: {', '.join(sorted(other))[:200]}") if other else Verdict("same")


@contextlib.contextmanager
def _beside_others(home: Path, name: str) -> Iterator[Path]:
    """Work in a folder with a copy of a store, and of another one beside it."""
    with tempfile.TemporaryDirectory(prefix="fuzz-") as folder, contextlib.chdir(folder):
        shutil.copytree(home / name, name)
        shutil.copytree(home / shelf.RUN, "victim.zarr")
        yield Path(folder) / name


def prints_of(folder: Path) -> dict[str, str]:
    """Return a hash of each file below a folder."""
    files = sorted(path for path in folder.rglob("*") if path.is_file())
    return {str(path): hashlib.sha256(path.read_bytes()).hexdigest() for path in files}
