"""The profiles of the tests: what is long by nature runs under a name of its own, beside the default run.

`@pytest.mark.profile(NAME, keep=PATTERNS)` moves a test to a profile; cases whose id matches a pattern stay in the
default run; with `cases=PATTERNS` the others stay. Where none stays, `instead=TEST` names the one that guards the
property there. `pytest --profile NAME` runs a profile, `--profile all` everything. `python tests/profiles.py` prints
the commands whose rooms a change touches, for `.ci/run`.
"""

import argparse
import dataclasses
import fnmatch
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
DEFAULT = "default"
PYTHON = ".venv/bin/python"
COLLECTED: pytest.StashKey[list[pytest.Item]] = pytest.StashKey()


@dataclasses.dataclass(frozen=True)
class Profile:
    """A part of the tests with a command of its own.

    Attributes:
        about: What it holds, and why that is long.
        rooms: Folders below `nonholo/` and `tests/` whose change it guards, and "docs".
        command: What runs it; by default its marked tests.
    """

    about: str
    rooms: tuple[str, ...]
    command: str = ""


_MECHANICS = ("base", "kernels", "groups", "systems", "discrete", "continuous")
_RUNS = ("kernels", "orbit", "simulation", "io", "ensembles")
_QUESTIONS = ("analysis", "plot", "examples", "testing")
PROFILES = {
    "routes": Profile(
        "every body by every route: the definition in JAX, which compiles a program for each",
        (*_MECHANICS, "lagrange_dalembert", "orbit", "simulation", "analysis", "testing", "examples"),
    ),
    "faults": Profile(
        "processes and clusters that are killed, disks that are full, blocks that are damaged", (*_RUNS, "cli")
    ),
    "problems": Profile(
        "many random problems, long orbits, and four times the examples of tests that draw them",
        (*_MECHANICS, "lagrange_dalembert", "simulation", "analysis", "examples"),
    ),
    "paper": Profile(
        "changed formulas of the paper that findings must notice, and the pages of the docs, executed",
        ("paper", "plot", "analysis", "examples"),
    ),
    "shapes": Profile(
        "annotations of shapes and types, checked at run time by jaxtyping and beartype",
        (*_MECHANICS, "orbit", "simulation"),
        f"{PYTHON} -m pytest -q tests/groups tests/systems tests/discrete tests/simulation "
        "-k 'not refused and not warned_of' "
        "--jaxtyping-packages=nonholo.groups,nonholo.systems,nonholo.orbit,nonholo.discrete,nonholo.simulation,"
        "beartype.beartype",
    ),
    "bounds": Profile(
        "kernels with every index checked, which compiles them once more",
        ("kernels", "base", "continuous"),
        f"NUMBA_BOUNDSCHECK=1 {PYTHON} -m pytest -q tests/kernels tests/base tests/continuous "
        "tests/simulation/test_ensemble.py tests/simulation/test_flow_ensemble.py",
    ),
    "browser": Profile(
        "the live page in Chromium, its bundle, made anew by npm; films by ffmpeg", ("explorer", "kernels", "plot")
    ),
    "benchmarks": Profile(
        "every script of `benchmarks/` on small numbers, which compiles what it compares with",
        (*_MECHANICS[1:], *_RUNS[1:], *_QUESTIONS[:1], "lagrange_dalembert", "explorer", "benchmarks"),
    ),
    "site": Profile(
        "the pages and the docstrings of public names as a site: unknown names, broken links, requests to elsewhere",
        (*_MECHANICS[2:], *_RUNS[1:], *_QUESTIONS, "lagrange_dalembert", "base", "docs"),
    ),
    "long": Profile("the same problems in thousands, and a hundred bodies for 100,000 steps: half an hour", ()),
    "fuzz": Profile(
        "calls with values that nobody expects, damaged stores, kills at random times, random steps; prints figures",
        (),
        f"{PYTHON} tests/fuzz",
    ),
    "mutants": Profile(
        "hand-made errors in all rooms that the default run must notice", (), f"{PYTHON} tests/mutants.py"
    ),
}
SOAKS = {"long", "fuzz"}
"""Profiles that take half an hour each: before a release, or after a change of what they guard."""
EVERY = 8
"""A change runs every eighth case of its profiles, others at another number of commits."""

MARKED = [DEFAULT, *(name for name, profile in PROFILES.items() if not profile.command)]
DOCTESTS = dict.fromkeys(  # examples that compile for long
    (
        "nonholo.analysis._linearize.linearize",
        "nonholo.analysis.inverse._fit.fit",
        "nonholo.analysis.locomotion._connection.LocalConnection.body_velocity",
        "nonholo.analysis.locomotion._connection.LocalConnection.momentum_rate",
        "nonholo.analysis.locomotion._connection.ShapedBody",
        "nonholo.analysis.locomotion._connection.accessibility",
        "nonholo.analysis.locomotion._connection.local_connection",
        "nonholo.analysis.locomotion._phase.geometric_phase",
        "nonholo.analysis.steering._feedback.tracking_feedback",
        "nonholo.analysis.steering._steer.steer",
        "nonholo.discrete._discretize.consistency_defect",
        "nonholo.ensembles._family_task.FamilyTask",
        "nonholo.examples._cars.two_wheeled_robot",
        "nonholo.examples._points.particle",
        "nonholo.examples._rolling.ball_in_bowl",
        "nonholo.examples._rolling.tilting_disk",
        "nonholo.lagrange_dalembert._group_system.GroupLagrangeDAlembert",
        "nonholo.lagrange_dalembert._orbit.CoordinateOrbit",
        "nonholo.lagrange_dalembert._orbit.GroupOrbit",
        "nonholo.plot.geometry._curvature.curvature",
        "nonholo.simulation.traced.rollout",
    ),
    "routes",
)


def command(name: str) -> str:
    """Return the command that runs a profile."""
    return PROFILES[name].command or f"{PYTHON} -m pytest -q --profile {name}"


def commands(names: list[str], every: int = 1) -> list[str]:
    """Return the commands that run every n-th case of profiles; those that are marked run together."""
    marked = [name for name in names if name in MARKED]
    together = [f"{PYTHON} -m pytest -q --profile {','.join(marked)}"] if marked else []
    alone = [command(name) for name in names if name not in MARKED]
    return [f"{line} --every {every}" if every > 1 and "pytest" in line else line for line in together + alone]


def chosen_profiles(text: str) -> set[str]:
    """Return the profiles that an option names, with commas between them."""
    chosen = set(MARKED) if text == "all" else set(text.split(","))
    if not chosen <= set(MARKED):
        raise argparse.ArgumentTypeError(f"must be of {', '.join(MARKED)}, or all. Got {text}")
    return chosen


def profile_of(item: pytest.Item) -> str:
    """Return the profile of a test: the default one, or that of its mark unless its case is kept."""
    mark = item.get_closest_marker("profile")
    if mark is None:
        return DOCTESTS.get(item.name, DEFAULT)
    case = item.callspec.id if hasattr(item, "callspec") else ""

    def matches(patterns: list[str]) -> bool:
        return any(fnmatch.fnmatchcase(case, pattern) for pattern in patterns)

    stays = not matches(mark.kwargs["cases"]) if "cases" in mark.kwargs else matches(mark.kwargs.get("keep", []))
    return DEFAULT if stays else mark.args[0]


def some_cases(items: list[pytest.Item], every: int, first: int) -> list[pytest.Item]:
    """Return every n-th case, from a first one on, and one at least."""
    return items[first % min(every, len(items) or 1) :: every]


def commits() -> int:
    """Return the number of commits, 0 where it is unknown: it says which cases a change runs."""
    return int(_git("rev-list", "--count", "HEAD") or 0)


def runs(item: pytest.Item, chosen: set[str]) -> bool:
    """Tell whether a test is of the chosen profiles; those that draw their cases are also of "problems", with more."""
    drawn = getattr(getattr(item, "obj", None), "is_hypothesis_test", False)
    return profile_of(item) in chosen or ("problems" in chosen and drawn)


def changed_files(base: str | None = None) -> list[str] | None:
    """Return the files that differ from the last tag or merge base; None when that is unknown."""
    reference = base or _git("describe", "--tags", "--abbrev=0") or _git("merge-base", "HEAD", "@{upstream}")
    if not reference or _git("rev-parse", reference + "^{commit}") == _git("rev-parse", "HEAD"):
        return None
    return _git("diff", "--name-only", reference).splitlines()


def _git(*arguments: str) -> str:
    done = subprocess.run(["git", *arguments], cwd=ROOT, capture_output=True, text=True, check=False)  # noqa: S603, S607
    return done.stdout.strip() if done.returncode == 0 else ""


def touched(files: list[str] | None) -> list[str]:
    """Return the profiles whose rooms files lie in; all but the fuzzers and the mutants when in doubt."""
    every = [name for name, profile in PROFILES.items() if profile.rooms]
    rooms = {room_of(file) for file in files or []}
    if files is None or None in rooms:
        return every
    return [name for name in every if rooms & set(PROFILES[name].rooms)]


def room_of(file: str) -> str | None:
    """Return the room of a file, "" where only the default run is concerned, None where that is in doubt."""
    parts = Path(file.replace("nonholo_paper/", "nonholo/paper/", 1)).parts
    if parts[0] in ("nonholo", "tests") and len(parts) > 1:
        return parts[1].removesuffix(".py") if len(parts) > 2 or parts[1].startswith("_") else None
    if parts[0] in ("benchmarks", "scenarios"):
        return "benchmarks" if parts[0] == "benchmarks" else ""
    return "docs" if parts[0] == "docs" or file.endswith(".md") else None


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description="Print the commands of the profiles that a change concerns.")
    parser.add_argument("--all", action="store_true", help="every case of all profiles but those of half an hour")
    parser.add_argument("--soak", action="store_true", help="of all profiles")
    parser.add_argument("--base", help="the commit to compare with; by default the last tag or the merge base")
    given = parser.parse_args()
    wide = [name for name in PROFILES if given.soak or name not in SOAKS]
    complete = given.all or given.soak
    for line in commands(wide if complete else touched(changed_files(given.base)), 1 if complete else EVERY):
        print(line)  # noqa: T201
