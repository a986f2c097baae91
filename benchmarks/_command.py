"""What the command lines of the scripts share: `--smoke`, with which a script takes seconds, and its skips.

A smoke run makes every check of a script on numbers so small that its figures mean nothing.
"""

import argparse
import sys
from typing import Any, NoReturn

SMOKE = "--smoke" in sys.argv
LEFT_OUT = 77
"""The exit code of a script that misses what it needs."""


def small(usual: Any, smoke: Any) -> Any:
    """Return a number of the figures, or that of a smoke run."""
    return smoke if SMOKE else usual


def options(about: str | None) -> argparse.ArgumentParser:
    """Return a parser that knows `--smoke`, with the text of a script."""
    parser = argparse.ArgumentParser(description=about, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--smoke", action="store_true", help="all checks on small numbers, in seconds; no figures")
    return parser


def leave_out(reason: str) -> NoReturn:
    """End a script that misses what it needs, and say what that is."""
    print(f"left out: {reason}", flush=True)
    raise SystemExit(LEFT_OUT)
