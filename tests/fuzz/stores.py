"""Fuzz stores: `python tests/fuzz/stores.py --trials 200 --seed 0 --workers 2 [--json FILE]`.

This many stores of orbits, and of sweeps, have a file damaged, as many have their JSON edited. Each is then loaded,
shown, resumed, extended and exported. Right are the numbers of the whole store, to the bit, and refusals of ours.
"""

# ruff: noqa: E402
import collections
import sys
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[1]))
import compilers

compilers.use_caches()

from fuzz.figures import counted, options, report
from fuzz.judge import BROKEN, Verdict
from fuzz.openings import FAMILIES, KINDS, Trial, trials
from fuzz.worker import answers

RIGHT, WRONG = ("same", "refused"), (*BROKEN, "outside", "ran")


def figures(chosen: list[Trial], workers: int) -> dict[str, Any]:
    """Do trials; return the counts of each family and kind of damage, and what went wrong."""
    counts: dict[str, collections.Counter[str]] = collections.defaultdict(collections.Counter)
    wrong = []
    for trial, answer in answers("fuzz.openings:prepared", chosen, workers, addresses=8 * 2**30):
        said, verdict = ("", Verdict(answer)) if isinstance(answer, str) else answer
        counts[f"{trial.family}, {trial.kind}"][verdict.kind] += 1
        if verdict.kind in WRONG:
            row = {"class": verdict.kind, "trial": ":".join(map(str, trial)), "what": said, "message": verdict.message}
            wrong.append(row)
    rows = {name: {kind: result[kind] for kind in (*RIGHT, *WRONG)} for name, result in sorted(counts.items())}
    return {"openings": len(chosen), "classes": rows, "broken": sorted(wrong, key=lambda row: list(row.values()))}


def lines(result: dict[str, Any]) -> list[str]:
    """Return figures for people, with a line that does again what went wrong."""
    again = "python tests/fuzz/stores.py --only"
    broken = [f"{x['class']}: {again} '{x['trial']}'\n    {x['what']}\n    {x['message']}" for x in result["broken"]]
    return [f"{result['openings']} openings", *counted(result["classes"]), *broken]


def main() -> int:
    """Draw trials or take the one that is asked for, do them, print the figures."""
    parser = options(__doc__, trials=200, workers=1)
    parser.add_argument("--only", help="one trial: FAMILY:STORE:KIND:SEED:OPENING")
    arguments = parser.parse_args()
    if arguments.only:
        family, store, kind, seed, opening = arguments.only.split(":")
        chosen = [Trial(family, store, kind, int(seed), opening)]
    else:
        chosen = [
            t for family in FAMILIES for kind in KINDS for t in trials(family, kind, arguments.trials, arguments.seed)
        ]
    return int(bool(report(arguments, lambda: figures(chosen, arguments.workers), lines)["broken"]))


if __name__ == "__main__":
    sys.exit(main())
