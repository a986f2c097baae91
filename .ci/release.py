"""Build a release: `python .ci/release.py`. With `--check` it only says what is in the way.

A placeholder stands where something is not known before the project has a home. `placeholders.toml` lists them.
"""

import argparse
import re
import subprocess
import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[1]
PLACEHOLDERS = tomllib.loads((ROOT / ".ci" / "placeholders.toml").read_text())
_VERSIONS = {
    "pyproject.toml": r'^version = "(.*)"$',
    "CITATION.cff": r"^version: (.*)$",
    "recipe/recipe.yaml": r'^  version: "(.*)"$',
    "CHANGELOG.md": r"^## \[(.*)\]",
    "docs/index.md": r"nonholo-([0-9.]*)-py3-none",
}


def left() -> list[str]:
    """Return the placeholders that are left, each with its file, its line and its meaning."""
    return [
        f"{file}:{number}: {name}, {entry['what']}"
        for name, entry in PLACEHOLDERS.items()
        for file in entry["files"]
        for number, line in enumerate((ROOT / file).read_text().splitlines(), 1)
        if name in line
    ]


def versions() -> dict[str, str]:
    """Return the version that each file names first."""
    texts = {file: re.search(pattern, (ROOT / file).read_text(), re.M) for file, pattern in _VERSIONS.items()}
    return {file: match[1] if match else "none" for file, match in texts.items()}


def obstacles() -> list[str]:
    """Return what is in the way of a release, a line each."""
    one = versions()
    several = [f"{file}: version {version}" for file, version in one.items()] if len(set(one.values())) > 1 else []
    return left() + several


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true", help="build nothing")
    arguments = parser.parse_args()
    if lines := obstacles():
        sys.exit("\n".join([*lines, "No release is built."]))
    for command in () if arguments.check else (["build"], ["twine", "check", "--strict", "dist/*"]):
        subprocess.run([sys.executable, "-m", *command], cwd=ROOT, check=True)  # noqa: S603
