"""How the tests run: caches of compilers, cores, profiles; names that doctests use."""

# ruff: noqa: E402
import gc
import sys
from collections.abc import Callable, Generator, Iterable, Iterator
from pathlib import Path

_TESTS = Path(__file__).parent / "tests"
sys.path.insert(0, str(_TESTS))  # before `pythonpath` is read
import compilers

compilers.use_caches()
compilers.use_one_thread()

import hypothesis
import numpy as np
import pytest
from profiles import COLLECTED, DEFAULT, MARKED, SOAKS, chosen_profiles, commits, profile_of, runs, some_cases

import nonholo as nh

collect_ignore_glob = ["tests/golden/*"]  # programs that write references, not tests

# drawn examples have no deadline: the first one compiles
hypothesis.settings.register_profile(DEFAULT, deadline=None, max_examples=25)
hypothesis.settings.register_profile("problems", deadline=None, max_examples=100)


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the choice of a profile."""
    about = f"which parts of the tests run, with commas: {', '.join(MARKED)}; or all"
    parser.addoption("--profile", type=chosen_profiles, default={DEFAULT}, help=about)
    parser.addoption(
        "--every",
        type=int,
        default=1,
        help="run every n-th case; the number of commits says with which one it begins",
    )


def pytest_configure(config: pytest.Config) -> None:
    """Register the mark, and what belongs to the profile."""
    config.addinivalue_line("markers", "profile(name, keep=(), cases=(), instead=None): a test of a profile")
    hypothesis.settings.load_profile("problems" if "problems" in config.getoption("--profile") else DEFAULT)
    compilers.compile_once()


def pytest_xdist_auto_num_workers(config: pytest.Config) -> int | None:
    """Run a single file in one process, so that it starts at once and a debugger works."""
    paths = [argument.split("::")[0] for argument in config.args]
    return 0 if len(paths) == 1 and paths[0].endswith(".py") else None


@pytest.hookimpl(wrapper=True)
def pytest_collect_file(file_path: Path) -> Generator[None, list[pytest.Collector], list[pytest.Collector]]:
    """Read each file of tests once: it has no doctests."""
    collected = yield
    return [node for node in collected if type(node) is pytest.Module or not file_path.is_relative_to(_TESTS)]


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Keep the tests of the chosen profile."""
    chosen = config.getoption("--profile")
    config.stash[COLLECTED] = list(items)
    ours = [item for item in items if runs(item, chosen)]
    if (every := config.getoption("--every")) > 1:
        ours = some_cases(ours, every, commits())
    if len(ours) < len(items):
        config.hook.pytest_deselected(items=list(set(items).difference(ours)))
        items[:] = ours
    for item in items:
        if profile_of(item) in SOAKS:
            item.add_marker(pytest.mark.timeout(0))  # half an hour is no hang there
    if hasattr(config, "workerinput"):
        items.sort(key=_turn({item.path: None for item in items}))


def pytest_collection_finish() -> None:
    """Leave what was collected out of the search for garbage, which took a fifth of the time."""
    gc.collect()
    gc.freeze()
    gc.set_threshold(20_000, 20, 20)


_WITHOUT_KERNELS = {"docs", "examples", "groups", "lagrange_dalembert", "nonholo", "paper", "plot", "testing"}


def _turn(files: Iterable[Path]) -> Callable[[pytest.Item], int]:
    """Deal files that need few kernels between the others: of two workers in kernels one waits while one compiles."""
    light = [file for file in files if _WITHOUT_KERNELS & set(file.parts[len(Path(__file__).parts) - 1 :][:2])]
    heavy = [file for file in files if file not in set(light)]
    turns = {file: 2 * place for place, file in enumerate(heavy)} | {file: 2 * j + 1 for j, file in enumerate(light)}
    return lambda item: turns[item.path]


@pytest.fixture(autouse=True)
def _doctest_names(doctest_namespace: dict[str, object]) -> None:
    doctest_namespace.update({"np": np, "nh": nh} | {name: getattr(nh, name) for name in dir(nh)})


@pytest.fixture(autouse=True, scope="module")
def _release_programs() -> Iterator[None]:
    yield
    compilers.release_programs()
