"""Scripts of the repository as modules, and what Python prints in a process of its own."""

import importlib.util
import json
import os
import subprocess
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

ROOT = Path(__file__).parents[1]


def script(path: str) -> ModuleType:
    """Return the script at a path from the root of the repository as a module."""
    spec = importlib.util.spec_from_file_location(Path(path).stem, ROOT / path)
    assert spec
    assert spec.loader
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # dataclasses look for their module there
    folder = str((ROOT / path).parent)
    if folder not in sys.path:
        sys.path.append(folder)  # of what scripts share
    spec.loader.exec_module(module)
    return module


def printed(*arguments: str, cwd: Path | None = None, **variables: str) -> Any:
    """Return the JSON that Python prints with arguments, in a folder, under variables of the environment."""
    command, environment = [sys.executable, *arguments], {**os.environ, **variables}
    done = subprocess.run(command, cwd=cwd, env=environment, stdout=subprocess.PIPE, check=True)  # noqa: S603
    return json.loads(done.stdout or "null")
