"""All fuzzers, for long: `python tests/fuzz [--only NAME ...] [--seed N] [--json FILE]` prints the figures of each.

Into the file go the figures of those that are named, all by default; what it holds of others stays.
"""

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

LONG = {
    "api": ("--trials", "3000", "--workers", "2"),
    "stores": ("--trials", "200", "--workers", "2"),
    "kills": ("--trials", "20", "--restarts", "10"),
    "steps": ("--steps", "1000000"),
}


def run(name: str, seed: int) -> tuple[dict[str, Any], bool]:
    """Run a fuzzer; return its figures, and whether something is broken."""
    sys.stdout.write(f"== {name}\n")
    sys.stdout.flush()
    with tempfile.TemporaryDirectory() as folder:
        file, program = Path(folder) / "figures.json", Path(__file__).with_name(f"{name}.py")
        command = [sys.executable, program, *LONG[name], "--seed", str(seed), "--json", file]
        code = subprocess.run(command, check=False).returncode  # noqa: S603
        return json.loads(file.read_text()), code != 0


def merged(file: Path, result: dict[str, Any]) -> dict[str, Any]:
    """Return figures with those of other fuzzers that a file holds, in the order of the page."""
    content = json.loads(file.read_text()) if file.exists() else {}
    return {name: {**content, **result}[name] for name in LONG if name in {**content, **result}}


def main() -> int:
    """Run the fuzzers one after another; return 1 if one of them found something."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", nargs="+", choices=LONG, default=list(LONG), help="which of them")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--json", type=Path, help="where the figures are written")
    arguments = parser.parse_args()
    broken = False
    for name in arguments.only:
        result, wrong = run(name, arguments.seed)
        broken |= wrong
        if arguments.json:
            arguments.json.write_text(json.dumps(merged(arguments.json, {name: result}), indent=1))
    return int(broken)


if __name__ == "__main__":
    sys.exit(main())
