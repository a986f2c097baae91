"""The figures of docs/project/figures.md from one command: sizes, tests, bits, and what the scripts that time print.

    python benchmarks/figures.py [--parts sizes tests bits tables ...] [--smoke]

A part that is not named keeps its former figures, with the machine and the load at which they were taken.
"""

import ast
import functools
import hashlib
import json
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

from _command import LEFT_OUT, SMOKE, machine, options, small

import nonholo as nh

ROOT = Path(__file__).parents[1]
DATA = ROOT / "docs" / "figures.json"
PAGE = ROOT / "docs" / "project" / "figures.md"
TIMED = small(("tables", "calls", "reading", "forces", "coordinates", "flow", "against_c"), ("calls",))
FOLDERS = ("nonholo", "nonholo_paper", "tests", "benchmarks", "docs")
_FAILED = "Ended with code"
_SEED = 113020  # of the fuzzers
ELSEWHERE = {
    "python tests/mutants.py": "errors made by hand, and the tests that notice them: hours",
    ".ci/run --soak": "every case of every profile: hours",
    "python benchmarks/flow_bodies.py": "twelve bodies beside heyoka",
    "python benchmarks/flow_accuracy.py": "their errors against 60 digits",
    "python benchmarks/steering.py --compare": "a thousand sleighs parked",
    "python benchmarks/sweeps.py": "sweeps of ten million members",
    "python benchmarks/live_page.py": "the live page, needs Chromium",
    "python benchmarks/gpu.py": "a million tops, needs a GPU",
}


def sizes() -> str:
    """Return the table of files and code lines of each folder, and what follows from them."""
    lines = {folder: Counter(dict(code_lines(ROOT / folder))) for folder in FOLDERS}
    rows = [f"| `{name}` | {len(result)} | {result.total():,} |" for name, result in lines.items()]
    names = len(dir(nh)) + sum(len(getattr(nh, room).__all__) for room in ("examples", "plot", "testing"))
    core, tested = lines["nonholo"].total(), lines["tests"].total()
    return "\n".join(
        [
            "| folder | Python files | code lines |",
            "| --- | ---: | ---: |",
            *rows,
            "",
            f"{names} public names, {core / names:.0f} code lines a name; {tested / core:.2f} lines of tests a line.",
        ]
    )


def code_lines(folder: Path) -> list[tuple[str, int]]:
    """Return the number of lines that are no comments, docstrings or blanks of each Python file."""
    return [(str(path), _code_lines(path.read_text("utf-8"))) for path in sorted(folder.rglob("*.py"))]


def _code_lines(text: str) -> int:
    documented: set[int] = set()
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.FunctionDef | ast.ClassDef | ast.Module) and ast.get_docstring(node, clean=False):
            documented.update(range(node.body[0].lineno, (node.body[0].end_lineno or 0) + 1))
    lines = enumerate(map(str.strip, text.split("\n")), 1)
    return sum(bool(line) and not line.startswith("#") and number not in documented for number, line in lines)


def tests() -> str:
    """Return how many tests there are, from the page that `python docs/make_tests_page.py` writes."""
    lines = (ROOT / "docs" / "tests.md").read_text("utf-8").splitlines()
    head, whole = (next(line for line in lines if line.startswith(start)) for start in ("| room |", "| **all** |"))
    return "\n".join([head, "| --- " * (head.count("|") - 1) + "|", whole])


def bits() -> str:
    """Return a digest of what the kernels give for random bodies: on one machine equal digests mean equal bits."""
    bodies = small(600, 6)
    with tempfile.TemporaryDirectory() as folder:
        file = str(Path(folder) / "calls.gz")
        _output(["tests/kernels/replay.py", "record", file, str(bodies)])
        way, *digests = json.loads(_output(["tests/kernels/replay.py", "bits", file, "2"]))
    whole = hashlib.sha256("".join(digests).encode()).hexdigest()
    calls = f"{len(digests):,} calls of {bodies} bodies by the kernels of the {way}: `{whole[:16]}`."
    return f"{calls} Their arguments come from NumPy, whose OpenBLAS rounds differently on other processors."


def timed(name: str) -> str:
    """Return what a script prints, and its failure if one of its bounds is missed."""
    done = _run([f"benchmarks/{name}.py", *(["--smoke"] if SMOKE else [])])
    failure = done.stderr.strip().rpartition("\n")[2]
    ended = "" if done.returncode in (0, LEFT_OUT) else f"\n{_FAILED} {done.returncode}: {failure}"
    return done.stdout.strip() + ended


def _output(arguments: list[str]) -> str:
    done = _run(arguments)
    if done.returncode:
        raise RuntimeError(f"{' '.join(arguments)}:\n{done.stdout}{done.stderr}")
    return done.stdout


def _run(arguments: list[str]) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, *arguments], cwd=ROOT, capture_output=True, text=True, check=False)  # noqa: S603


def fuzz() -> str:
    """Return a row for each fuzzer, with what it found and its seed."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "figures.json"
        done = _run(["tests/fuzz", "--seed", str(_SEED), "--json", str(file)])
        result = json.loads(file.read_text())
    rows = [f"| {name} | {FUZZED[name](result[name])} |" for name in result]
    ended = [f"\n{_FAILED} {done.returncode}"] * bool(done.returncode)
    about = f"`python tests/fuzz --seed {_SEED}`; [Reliability](../reliability.md) explains the classes."
    return "\n".join([about, "", "| fuzzer | figures |", "| --- | --- |", *rows, *ended])


PARTS: dict[str, Callable[[], str]] = {
    "sizes": sizes,
    "tests": tests,
    "bits": bits,
    **{name: functools.partial(timed, name) for name in TIMED},
    **small({"fuzz": fuzz}, {}),
}


def page(result: dict[str, Any]) -> str:
    """Return the text of the page."""
    parts = [f"## {name.replace('_', ' ').capitalize()}\n\n{_part(name, result.get(name))}" for name in PARTS]
    others = "\n".join(f"| `{command}` | {about} |" for command, about in ELSEWHERE.items())
    return _TEXT.format(parts="\n\n".join(parts), others=others)


def _part(name: str, part: dict[str, str] | None) -> str:
    if part is None:
        return f"Not run: `python benchmarks/figures.py --parts {name}`."
    table = f"```text\n{part['text']}\n```" if name in TIMED and name != "tables" else part["text"]
    return f"{part['about']}\n\n{table}"


def _api(result: dict[str, Any]) -> str:
    classes = result["classes"]
    return (
        f"{result['trials']:,} calls of {result['call forms']} forms: {_listed(classes)}; {result['named']:,} of the "
        f"{classes['refused']:,} refusals name the argument that was changed"
    )


def _stores(result: dict[str, Any]) -> str:
    rows = (f"{name}: {_listed(row)}" for name, row in result["classes"].items())
    return f"{result['openings']:,} openings. " + "; ".join(rows)


def _kills(result: dict[str, Any]) -> str:
    return "; ".join(
        f"{name}: {row}" if isinstance(row, str) else f"{name}: {row['killed']} killed, {len(row['wrong'])} wrong"
        for name, row in result.items()
    )


def _steps(result: dict[str, Any]) -> str:
    total = Counter(result["all"])
    wrong = sum(count for name, count in total.items() if name.startswith(("wrong", "not finite")))
    regular = sum(count for name, count in total.items() if name.startswith("refused though"))
    return (
        f"{total['steps']:,} steps of {len(result['families'])} families, of which {total['solve the equation']:,} "
        f"solve their equation; of {total['sampled']:,} drawn ones {total['the root of the continuation']:,} are the "
        f"root of the continuation and {total['undecided']:,} are undecided; of {total['refused']:,} refusals "
        f"{total['refused at a fold']:,} are at a fold, {total['refused, undecided']:,} undecided and {regular:,} "
        f"though the continuation meets none; {wrong:,} wrong"
    )


def _listed(counts: dict[str, int]) -> str:
    return ", ".join(f"{count:,} {kind}" for kind, count in counts.items())


FUZZED = {"api": _api, "stores": _stores, "kills": _kills, "steps": _steps}

_TEXT = """\
<!-- written by benchmarks/figures.py -->
# Figures

All figures of this page come from `python benchmarks/figures.py`, but for those of the last table. Each part
names the machine and the load at which it was run; at a load above the number of cores times are too long, and only
ratios count. [Benchmarks](../benchmarks.md) explains the tables.

{parts}

## Other commands

| command | figures |
| --- | --- |
{others}
"""


def main() -> None:
    """Compute the parts, and write the page."""
    parser = options(__doc__)
    parser.add_argument("--parts", nargs="*", choices=PARTS, default=list(PARTS), help="all by default; none: the page")
    result = json.loads(DATA.read_text()) if DATA.exists() else {}
    for name in parser.parse_args().parts:
        about, begun = machine(), time.perf_counter()
        text = PARTS[name]()
        result[name] = {"about": f"{about.partition(chr(10))[0]} {time.perf_counter() - begun:.0f} s.", "text": text}
        print(f"{name}: {time.perf_counter() - begun:.0f} s", flush=True)
        if not SMOKE:
            DATA.write_text(json.dumps({name: result[name] for name in PARTS if name in result}, indent=1) + "\n")
    text = page(result)
    if SMOKE:
        print(text)
    else:
        PAGE.write_text(text, "utf-8")
    sys.exit(int(_FAILED in text))


if __name__ == "__main__":
    main()
