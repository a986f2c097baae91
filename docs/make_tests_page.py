"""Write docs/tests.md: what is tested where, and by which profile."""

import sys
from collections import Counter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT / "tests"))
from profiles import DEFAULT, MARKED, PROFILES, command, profile_of  # noqa: E402


class Collected:
    """A plugin that keeps what pytest has collected."""

    items: list[pytest.Item]

    def pytest_collection_finish(self, session: pytest.Session) -> None:
        """Keep the tests."""
        self.items = session.items


def room_of(item: pytest.Item) -> str:
    """Return the room of a test or doctest."""
    parts = Path(item.nodeid.split("::")[0]).parts
    return parts[1] if len(parts) > 2 else "the whole"


def page(items: list[pytest.Item]) -> str:
    """Return the text of the page for all tests."""
    counts: Counter[tuple[str, str]] = Counter()
    for item in items:
        doctest = item.nodeid.startswith("nonholo")
        counts[room_of(item), "doctests" if doctest else profile_of(item)] += 1
    columns = ["doctests", *MARKED]
    rooms = sorted({room for room, _ in counts})
    rows = [[room, *(counts[room, column] or "" for column in columns)] for room in rooms]
    rows.append(["**all**", *(sum(counts[room, column] for room in rooms) for column in columns)])
    table = _table(["room", *columns], rows)
    profiles = _table(["profile", "what", "command"], [[n, p.about, f"`{command(n)}`"] for n, p in PROFILES.items()])
    return _TEXT.format(table=table, profiles=profiles, elsewhere=_elsewhere(items))


def _elsewhere(items: list[pytest.Item]) -> str:
    """List the tests of which no case is in the default run, with what stands for them there."""
    by_name: dict[str, list[pytest.Item]] = {}
    for item in items:
        by_name.setdefault(item.nodeid.split("[")[0], []).append(item)
    rows = []
    for name, cases in by_name.items():
        if DEFAULT not in map(profile_of, cases):
            mark = cases[0].get_closest_marker("profile")
            rows.append([f"`{name}`", profile_of(cases[0]), mark.kwargs["instead"] if mark else "other examples"])
    return _table(["test", "profile", "in the default run"], rows)


def _table(head: list[str], rows: list[list]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(map(str, line)) + " |" for line in lines)


_TEXT = """\
<!-- written by docs/make_tests_page.py -->
# Tests

`.venv/bin/python -m pytest -q` is the default run: every property at least once, on the cores there are, each file in
one process. What is long by nature belongs to a profile. A test is moved there by
`@pytest.mark.profile(NAME, keep=PATTERNS)`; cases whose id matches a pattern stay (with `cases=`, go).
`--profile routes,faults` runs two of them, `--profile all` every marked test; `.ci/run` the default run, and
of the profiles whose rooms a change touches every eighth case of each test, others with each commit;
`.ci/run --all` every case of all but the soaks `long` and `fuzz`. Tests that draw their
cases run in "problems" too, with four times the examples.

{profiles}

Compiled code is kept in `build/tests`: numba's under a hash of the kernels' text, because its own index does not see a
change of a callee; JAX's programs by their text. A second run takes them from there.

## How many, where

{table}

## Tests with no case in the default run

{elsewhere}
"""


if __name__ == "__main__":
    collected = Collected()
    arguments = ["--collect-only", "-qq", "--profile=all", "--numprocesses=0", f"--rootdir={ROOT}"]
    if pytest.main(arguments, plugins=[collected]) == 0:
        (ROOT / "docs" / "tests.md").write_text(page(collected.items))
