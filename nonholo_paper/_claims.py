"""The claims: what the paper prints, where, and its verdict. Functions of `statements`, `figures` measure them.

The words stand in claims/, a file for each section and one for the figures, under the names of module and function.
"""

import functools
import tomllib
from collections.abc import Callable
from importlib import resources
from typing import Any

from nonholo_paper._finding import Finding, Measured, finding
from nonholo_paper._verdict import Verdict


def statement(measure: Callable[[], Measured]) -> Finding:
    """Turn a function that measures a statement into the finding whose words stand in claims/ under its name."""
    words = claims(measure.__module__)[measure.__name__]
    return finding(
        words["label"],
        words["kind"],
        words["source"],
        in_one_line(words["claim"]),
        verdict=Verdict(words.get("verdict", Verdict.AS_PRINTED)),
        corrected=in_one_line(words["corrected"]) if "corrected" in words else None,
        errata=tuple(words.get("errata", ())),
        tolerance=words.get("tolerance", 1e-45),
    )(measure)


def claims(module: str) -> dict[str, Any]:
    """Return the table of a module of statements or figures."""
    name = module.rpartition(".")[2]
    return _file(name.partition("_")[0] if name.startswith("section") else "figures")[name]


def in_one_line(text: str) -> str:
    """Return a text without its line breaks."""
    return " ".join(text.split())


@functools.cache
def _file(name: str) -> dict[str, Any]:
    return tomllib.loads((resources.files("nonholo_paper") / "claims" / f"{name}.toml").read_text("utf-8"))
