"""The high-precision references of tests/golden as systems and arrays."""

import json
import pathlib

import numpy as np

import nonholo as nh

_GOLDEN = pathlib.Path(__file__).parent / "golden"


def golden(name: str) -> list[dict]:
    """Return the cases of a file."""
    return json.loads((_GOLDEN / name).read_text())


def numbers(nested: object) -> np.ndarray:
    """Return nested lists of decimal strings as a float64 array."""
    return np.array(nested, dtype=np.float64)


def golden_system(case: dict) -> nh.SuslovTop | nh.ChaplyginSleigh:
    """Build the system of a case."""
    kind = {"suslov": nh.SuslovTop, "sleigh": nh.ChaplyginSleigh}[case["system"]]
    return kind(**case["parameters"])
