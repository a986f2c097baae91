"""All fuzzers, for long: `python tests/fuzz [--json FILE]` prints the figures of each, and writes them."""

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

LONG = {
    "api": ("--trials", "3000", "--workers", "2"),
    "stores": ("--trials", "200", "--workers", "2"),
    "kills": ("--trials", "20", "--restarts", "10"),
    "steps": ("--steps", "1000000"),
}


def main() -> int:
    """Run the fuzzers one after another; return 1 if one of them found something."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", type=Path, help="where the figures of all of them are written")
    given = parser.parse_args()
    found, broken = {}, 0
    with tempfile.TemporaryDirectory() as folder:
        for name, options in LONG.items():
            sys.stdout.write(f"== {name}\n")
            sys.stdout.flush()
            file = Path(folder) / f"{name}.json"
            program = Path(__file__).with_name(f"{name}.py")
            broken |= subprocess.run([sys.executable, program, *options, "--json", file], check=False).returncode  # noqa: S603
            found[name] = json.loads(file.read_text())
    if given.json:
        given.json.write_text(json.dumps(found, indent=1))
    return int(bool(broken))


if __name__ == "__main__":
    sys.exit(main())
