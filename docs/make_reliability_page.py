"""Write docs/reliability.md: what is promised, how it is tested, and the figures of the last long run of the fuzzers.

python tests/fuzz --json docs/figures-of-fuzz.json   # an hour
python docs/make_reliability_page.py
"""

# ruff: noqa: E501  # rows of tables
import json
import sys
from collections import Counter
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[1]
FIGURES = ROOT / "docs" / "figures-of-fuzz.json"
_NOT_RUN = "not run yet"
_WRONG_STEPS = ("wrong", "not finite")


def page(found: dict[str, Any]) -> str:
    """Return the text of the page for the figures of the fuzzers."""
    return _TEXT.format(
        **{name: figures(found[name]) if name in found else _NOT_RUN for name, figures in _FIGURES.items()}
    )


def _api(found: dict[str, Any]) -> str:
    classes = found["classes"]
    return (
        f"{found['trials']:,} calls of {found['call forms']} forms: {_listed(classes)}; {found['named']:,} of the "
        f"{classes['refused']:,} refusals name the argument that was changed"
    )


def _stores(found: dict[str, Any]) -> str:
    rows = (f"{name}: {_listed(row)}" for name, row in found["classes"].items())
    return f"{found['openings']:,} openings. " + "; ".join(rows)


def _kills(found: dict[str, Any]) -> str:
    return "; ".join(
        f"{name}: {row}" if isinstance(row, str) else f"{name}: {row['killed']} killed, {len(row['wrong'])} wrong"
        for name, row in found.items()
    )


def _steps(found: dict[str, Any]) -> str:
    total = Counter(found["all"])
    wrong = sum(count for name, count in total.items() if name.startswith(_WRONG_STEPS))
    regular = sum(count for name, count in total.items() if name.startswith("refused though"))
    return (
        f"{total['steps']:,} steps of {len(found['families'])} families, of which {total['solve the equation']:,} solve "
        f"their equation; of {total['sampled']:,} drawn ones {total['the root of the continuation']:,} are the root of "
        f"the continuation and {total['undecided']:,} are undecided; of {total['refused']:,} refusals "
        f"{total['refused at a fold']:,} are at a fold, {total['refused, undecided']:,} undecided and {regular:,} though "
        f"the continuation meets none; {wrong:,} wrong"
    )


def _listed(counts: dict[str, int]) -> str:
    return ", ".join(f"{count:,} {kind}" for kind, count in counts.items())


_FIGURES = {"api": _api, "stores": _stores, "kills": _kills, "steps": _steps}

_TEXT = """# Reliability

Written by `docs/make_reliability_page.py`; the figures are those of the last long run of `tests/fuzz`.

What may a user rely on, and how is it tested? Two libraries are our models. SQLite says in
[How SQLite is tested](https://www.sqlite.org/testing.html) what it does about full memories and disks, crashes and
hostile files, with figures; SUNDIALS tells its users by return codes what went wrong, never by a wrong number.

## What is promised

| promise | what it means | tested by |
|---|---|---|
| a result is right or refused | a step solves its equation on the branch that was asked for, or has an `Outcome` that says why not; nothing that is not finite is called successful | the fuzzer of steps, whose reference shares no code with the library; high precision in `tests/golden` |
| bits | one machine and set of versions has one result, in any number of threads, processes, blocks, stopped and resumed ([conventions](conventions.md), "Bits") | `tests/kernels/test_same_bits.py`, the fuzzer of kills |
| all or nothing | a store appears at its path when it is complete; a checkpoint is written whole or not at all; what a killed process left is removed by whoever writes the path next | `tests/io`, the fuzzer of kills |
| durability | what a checkpoint says is on the disk as far as the operating system tells; a power cut may cost the last checkpoints, see [Run for days](how-to/run-for-days.md) | profile `faults` |
| one writer | a store has one writer, by a lock of the operating system that ends with its process, also across containers | `tests/io/test_stream.py`, restarts in process namespaces |
| signals | Ctrl-C stops a run or a sweep that is stored at a block and says how to resume; in the command SIGTERM and SIGHUP do the same | `tests/ensembles/test_faults.py`, `tests/cli` |
| limits | what cannot fit into memory or on the disk is refused before any work, with the figure and the remedy; a run may take as long as it takes | `tests/test_limits.py` |
| arguments | what is no number, not finite or out of range is refused by name | the fuzzer of the public API |
| range of scales | numbers whose squares overflow or underflow are refused ([conventions](conventions.md)) or end in an `Outcome`. Bodies with general subspaces may say `not_converged` in units far from 1 | the fuzzer of steps, units from 1e-100 to 1e100 |
| files of strangers | nothing runs that the caller did not name, nothing outside of the store is written, memory is bounded ([Open a store from elsewhere](how-to/open-a-store-from-elsewhere.md)) | the fuzzer of stores |
| versions | stores of earlier schemas than those of 0.3.0 are refused, with what to do | `tests/io/test_earlier_schemas.py` |
| indices | compiled code stays within its arrays | profile `bounds` |
| processes | a run that folds comes back from a pool as an `OutcomeError`; JAX in a process forked after JAX was used is an error in words: start processes by "spawn" | `tests/test_pools.py` |
| no place to write | where package and home are read-only compiled code lies in a private temporary folder or in memory; damaged code is compiled again | `tests/test_compiled.py` |

## How hard it was tried

| fuzzer | figures |
|---|---|
| the public API: every public name, one or two arguments replaced by values that nobody expects | {api} |
| stores: cut, changed, edited and missing files, each loaded, resumed, extended, and by the command | {stores} |
| kills: SIGKILL at random times, two in five again in the resume; namespaces that end, as containers do | {kills} |
| steps: bodies and starts of all sizes, many next to a fold | {steps} |

Classes: *refused* by a check, *accepted* with a finite result, *outcome* said by an `OutcomeError`; broken are *raw* (an
error from inside), *silent* (accepted, though not legal), *hang*, *memory*, *abort*, *outside* (a file elsewhere was
changed) and *ran* (a function that a store names was called).

Again: `python tests/fuzz --json docs/figures-of-fuzz.json`, then `python docs/make_reliability_page.py`.

## What is not promised

- A checksum is no signature: who can write a store can write its checksum.
- Results of different machines or versions agree to tolerance, not to the bit.
- A sweep on a Dask cluster is as safe as the cluster: Dask runs whatever is sent to it.
"""


if __name__ == "__main__":
    (ROOT / "docs" / "reliability.md").write_text(page(json.loads(FIGURES.read_text())), "utf-8")
    sys.stdout.write("docs/reliability.md\n")
