"""What the command lines of the scripts share: `--smoke`, with which a script takes seconds, and its skips.

A smoke run makes every check of a script on numbers so small that its figures mean nothing.
"""

import argparse
import datetime
import importlib.metadata
import os
import platform
import sys
from pathlib import Path
from typing import Any, NoReturn

SMOKE = "--smoke" in sys.argv
PACKAGES = ("nonholo", "numpy", "scipy", "numba", "jax", "diffrax", "heyoka", "exudyn", "pydy", "sympy")
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


def machine() -> str:
    """Return one line about the machine and one about versions."""
    about = Path("/proc/cpuinfo")
    lines = about.read_text().splitlines() if about.exists() else []
    model = next((line.split(":")[1].strip() for line in lines if line.startswith("model name")), platform.processor())
    versions = []
    for package in PACKAGES:
        try:
            versions.append(f"{package} {importlib.metadata.version(package)}")
        except importlib.metadata.PackageNotFoundError:
            versions.append(f"{package} not installed")
    load = os.getloadavg()[0] if hasattr(os, "getloadavg") else float("nan")
    date = datetime.datetime.now(datetime.UTC).date()
    where = f"{model}, {os.cpu_count()} cores, load {load:.1f} at the start, {platform.system()}, {date}."
    return f"{where}\n\nPython {platform.python_version()}, {', '.join(versions)}."
