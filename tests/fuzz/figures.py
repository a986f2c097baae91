"""What every fuzzer does with its figures: print them for people, write them for programs."""

import argparse
import json
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any


def options(text: str, **numbers: int) -> argparse.ArgumentParser:
    """Return the options that fuzzers share, described by the first line of a docstring, and some numbers."""
    parser = argparse.ArgumentParser(description=text.splitlines()[0])
    for name, usual in numbers.items():
        parser.add_argument(f"--{name}", type=int, default=usual)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--json", type=Path, help="where the figures are written")
    return parser


def counted(rows: dict[str, dict[str, int]]) -> list[str]:
    """Return a line for each row of counts."""
    return [f"{name}: " + ", ".join(f"{count} {kind}" for kind, count in row.items()) for name, row in rows.items()]


def report(
    arguments: argparse.Namespace, figures: Callable[[], dict[str, Any]], lines: Callable[[dict[str, Any]], list[str]]
) -> dict[str, Any]:
    """Make figures, print and write them; return them."""
    begin = time.monotonic()
    result = figures() | {"seed": arguments.seed}
    sys.stdout.write("\n".join(lines(result)) + f"\n{time.monotonic() - begin:.0f} s\n")
    if arguments.json:
        arguments.json.write_text(json.dumps(result, indent=1))
    return result
