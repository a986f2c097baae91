"""Nothing is lost between the profiles: each has its command, keeps representatives, and stands on its page."""

import argparse
import os
from collections import defaultdict
from fnmatch import fnmatchcase
from pathlib import Path

import profiles
import pytest
from profiles import COLLECTED, DEFAULT, DOCTESTS, PROFILES, ROOT, command, profile_of, some_cases, touched
from scripts import script


@pytest.fixture(name="cases")
def _cases(request: pytest.FixtureRequest) -> dict[str, list[pytest.Item]]:
    """All collected tests of profiles, by name."""
    result = defaultdict(list)
    for item in request.config.stash[COLLECTED]:
        if item.get_closest_marker("profile"):
            result[item.nodeid.split("[")[0]].append(item)
    return result


def test_every_profile_has_its_command() -> None:
    """CONTRIBUTING gives the command of each profile."""
    text = (ROOT / "CONTRIBUTING.md").read_text()
    assert not [name for name in PROFILES if command(name) not in text]


def test_every_room_is_guarded() -> None:
    """The rooms of the profiles exist, and each room of the library belongs to one at least."""
    rooms = {path.name.removesuffix(".py") for path in (ROOT / "nonholo").iterdir() if path.name[:2] != "__"}
    rooms |= {"paper", "docs", "benchmarks"}
    listed = {room for profile in PROFILES.values() for room in profile.rooms}
    assert listed <= rooms
    assert rooms - listed <= {"py.typed"}


def test_marks_mean_something(cases: dict[str, list[pytest.Item]]) -> None:
    """Marks name a profile; each pattern is that of a case, and one at least goes to the profile."""
    for name, items in cases.items():
        mark = items[0].get_closest_marker("profile")
        assert mark.args[0] in PROFILES, name
        ids = [item.callspec.id for item in items if hasattr(item, "callspec")]
        patterns = mark.kwargs.get("keep", mark.kwargs.get("cases", []))
        assert not [p for p in patterns if not any(fnmatchcase(case, p) for case in ids)], name
        assert any(profile_of(item) == mark.args[0] for item in items), name


def test_every_property_stays_in_the_default_run(
    request: pytest.FixtureRequest, cases: dict[str, list[pytest.Item]]
) -> None:
    """A test with no case there names the one that stands for it, which has one."""
    default = {item.name.split("[")[0] for item in request.config.stash[COLLECTED] if profile_of(item) == DEFAULT}
    complete = _complete(request)
    for name, items in cases.items():
        if complete and DEFAULT not in map(profile_of, items):
            assert items[0].get_closest_marker("profile").kwargs["instead"] in default, name


def test_examples_of_profiles_exist(request: pytest.FixtureRequest) -> None:
    """Each docstring that a profile names has examples: a name that is left from a move guards nothing."""
    if not _complete(request):
        pytest.skip("some tests were not collected")
    assert set(DOCTESTS) <= {item.name for item in request.config.stash[COLLECTED]}


def test_the_page_is_current(request: pytest.FixtureRequest) -> None:
    """docs/tests.md gives the counts of the tests that there are."""
    if not _complete(request):
        pytest.skip("some tests were not collected")
    page = script("docs/make_tests_page.py").page(request.config.stash[COLLECTED])
    hint = "run `.venv/bin/python docs/make_tests_page.py`"
    assert (ROOT / "docs" / "tests.md").read_text() == page, hint


def _complete(request: pytest.FixtureRequest) -> bool:
    files = {Path(item.nodeid.split("::")[0]) for item in request.config.stash[COLLECTED]}
    return {path.relative_to(ROOT) for path in (ROOT / "tests").rglob("test_*.py")} <= files


@pytest.mark.parametrize(
    ("files", "expected"),
    [
        ([], set()),
        (["benchmarks/gpu.py", "scenarios/sleigh.toml"], {"benchmarks"}),
        (["docs/house.md", "README.md", "benchmarks/gpu.py"], {"site", "benchmarks"}),
        (["nonholo/cli/commands/stores.py"], {"faults"}),
        (["tests/plot/test_loci.py", "docs/paper.md"], {"paper", "site", "browser"}),
        (["nonholo/kernels/_sleigh.py"], {"routes", "faults", "problems", "shapes", "bounds", "browser", "benchmarks"}),
        (["nonholo/base/checks.py"], {"routes", "problems", "shapes", "bounds", "site"}),
        (["pyproject.toml"], set(PROFILES) - {"fuzz", "long", "mutants"}),
        (["tests/bodies.py"], set(PROFILES) - {"fuzz", "long", "mutants"}),
        (None, set(PROFILES) - {"fuzz", "long", "mutants"}),
    ],
)
def test_touched_profiles(files: list[str] | None, expected: set[str]) -> None:
    """A change of one room runs the profiles that guard it, one of what all share runs all of them."""
    assert set(touched(files)) == expected


@pytest.mark.parametrize("every", [1, 2, 3, 7])
def test_changes_in_a_row_run_every_case(request: pytest.FixtureRequest, every: int) -> None:
    """N numbers of commits in a row run every case between them, once, and each of them some case."""
    items = request.config.stash[COLLECTED]
    parts = [some_cases(items, every, 1234 + part) for part in range(every)]
    assert sorted(item.nodeid for part in parts for item in part) == sorted(item.nodeid for item in items)
    assert len(some_cases(items[:2], every, 1234)) >= 1
    assert some_cases([], every, 1234) == []


def test_marked_profiles_run_together() -> None:
    """One run collects the tests of several profiles; those with a command of their own follow."""
    first, second = profiles.commands(["routes", "shapes", "paper"])
    assert first.endswith("pytest -q --profile routes,paper")
    assert second == command("shapes")
    assert profiles.commands([]) == []


def test_unknown_profiles_are_refused() -> None:
    """The message names those that there are."""
    assert profiles.chosen_profiles("faults,default") == {"faults", DEFAULT}
    with pytest.raises(argparse.ArgumentTypeError, match=r"must be of default, routes.*or all\. Got fault"):
        profiles.chosen_profiles("fault")


def test_the_base_of_a_change_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """Files differ from a named commit; where none is known all profiles run."""
    if not profiles._git("rev-parse", "HEAD~1"):
        pytest.skip("a checkout without history")
    assert profiles.changed_files("HEAD~1")
    monkeypatch.setattr(profiles, "_git", lambda *_: "")
    assert profiles.changed_files() is None


def test_a_callee_changes_the_cache(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Numba's folder has another name after any file of the kernels has changed."""
    import compilers

    kernel = tmp_path / "nonholo" / "kernels" / "_small.py"
    kernel.parent.mkdir(parents=True)
    monkeypatch.setattr(compilers, "ROOT", tmp_path)
    names = []
    for text in ("a", "b"):
        kernel.write_text(text)
        monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
        compilers.use_caches()
        names.append(os.environ["NUMBA_CACHE_DIR"])
    assert names[0] != names[1]
