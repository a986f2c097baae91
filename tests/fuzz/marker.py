"""Functions for others to call: one that a store may name, which leaves a file behind, one that hangs and dies."""

import os
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np


def turned(states: Any) -> np.ndarray:
    """Zero where a sleigh looks along the first axis, or back."""
    return np.sin(states.heading)


def touch(*_: Any, **__: Any) -> dict[str, Any]:
    """Leave the file PWNED."""
    Path("PWNED").touch()
    return {}


def answering() -> Callable[[str], str]:
    """Return what hangs, dies or answers, as asked."""

    def do(job: str) -> str:
        if job == "die":
            os.abort()
        if job == "hang":
            time.sleep(600)
        return "said"

    return do
