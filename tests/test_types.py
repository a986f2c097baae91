"""The public names have the types that a strict checker needs."""

import json
import subprocess
import sys
from pathlib import Path

PROGRAM = Path(__file__).parent / "typed_program.py"


def test_a_strict_program_has_no_error(tmp_path: Path) -> None:
    """Pyright in its strict mode finds nothing in a program with a call of each kind, and the results as it says."""
    root = PROGRAM.parents[1]
    settings = {"typeCheckingMode": "strict", "include": [str(PROGRAM)], "extraPaths": [str(root)]}
    (tmp_path / "pyrightconfig.json").write_text(json.dumps(settings | {"pythonVersion": "3.11"}))
    command = [sys.executable, "-m", "pyright", "--pythonpath", sys.executable, "-p", str(tmp_path)]
    checked = subprocess.run(command, capture_output=True, text=True, check=False)  # noqa: S603
    assert checked.returncode == 0, checked.stdout
