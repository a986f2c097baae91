"""Fuzz the public API: `python tests/fuzz/api.py --trials 3000 --seed 0 --workers 2 [--json FILE]`.

Each trial is done in a worker under limits. It ends *refused* by a check of ours, *accepted* (legal, finite), *warned*
(legal, not finite, and a RuntimeWarning says so), *silent* (accepted though illegal, or not finite though successful),
*raw* (any other exception), *memory*, *hang* or *abort*.
"""

# ruff: noqa: E402
import collections
import sys
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[1]))
import compilers

compilers.use_caches()

from fuzz.calls import all_calls
from fuzz.figures import options, report
from fuzz.judge import BROKEN, GOOD, Verdict
from fuzz.trials import Trial, draw, from_text, told
from fuzz.worker import answers


def verdicts(trials: list[Trial], workers: int) -> list[tuple[Trial, Verdict]]:
    """Return what came of trials."""
    result = answers("fuzz.trials:prepared", trials, workers)
    return [(trial, Verdict(answer) if isinstance(answer, str) else answer) for trial, answer in result]


def figures(result: list[tuple[Trial, Verdict]]) -> dict[str, Any]:
    """Return the counts, and of what broke the trials."""
    counts = collections.Counter(verdict.kind for _, verdict in result)
    broken = sorted((v.kind, told(trial), v.message) for trial, v in result if v.kind in BROKEN)
    return {
        "trials": len(result),
        "call forms": len({trial[0] for trial, _ in result}),
        "classes": {kind: counts[kind] for kind in (*GOOD, *BROKEN)},
        "named": sum(verdict.named for _, verdict in result),
        "broken": [{"class": kind, "trial": trial, "message": message} for kind, trial, message in broken],
    }


def lines(result: dict[str, Any]) -> list[str]:
    """Return figures for people, with a line that does again what broke."""
    refused = result["classes"]["refused"]
    head = f"{result['trials']} trials of {result['call forms']} call forms; "
    head += f"{result['named']} of {refused} refusals name the changed argument"
    table = [f"{kind:10} {count:6}" for kind, count in result["classes"].items()]
    again = "python tests/fuzz/api.py --only"
    return [head, *table] + [f"{x['class']}: {again} '{x['trial']}'\n    {x['message']}" for x in result["broken"]]


def main() -> int:
    """Draw trials or take the one that is asked for, do them, print the figures."""
    parser = options(__doc__, trials=3000, workers=1)
    parser.add_argument("--only", help="one trial: CALL: ARGUMENT = VALUE")
    parser.add_argument("--call", default="", help="only calls whose names begin so")
    arguments = parser.parse_args()
    calls = {name: call for name, call in all_calls().items() if name.startswith(arguments.call)}
    trials = [from_text(arguments.only)] if arguments.only else draw(calls, arguments.trials, arguments.seed)
    return int(bool(report(arguments, lambda: figures(verdicts(trials, arguments.workers)), lines)["broken"]))


if __name__ == "__main__":
    sys.exit(main())
