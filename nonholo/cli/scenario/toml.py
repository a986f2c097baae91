"""Texts in TOML from anywhere, bounded in size and depth before anybody looks at what they say."""

import tomllib
from pathlib import Path
from typing import Any

from nonholo.base.limits import size_text

_LARGEST = 1 << 22  # bytes of a file: a mass tensor of some hundred dimensions fits
_DEEPEST = 32  # arrays and tables in each other


def read_text(path: Path) -> str:
    """Return the text of a file, refused with an OSError if it is none or too large; pipes and devices may not end."""
    if path.exists() and not path.is_file():  # to open a pipe may take forever
        raise OSError("it is a folder, a device or a pipe")
    with path.open("rb") as file:
        found = file.read(_LARGEST + 1)
    if len(found) > _LARGEST:
        raise OSError(f"it has more than {size_text(_LARGEST)}")
    return found.decode("utf-8-sig")


def parsed(text: str) -> dict[str, Any]:
    """Return the document of a text.

    Raises:
        ValueError: It is not valid TOML, has an integer of thousands of digits, or arrays within arrays without end.

    Example:
        >>> parsed("a = 1")
        {'a': 1}
    """
    try:
        document = tomllib.loads(text)
    except RecursionError:
        document = None
    if document is None or _depth(document) > _DEEPEST:
        raise ValueError(f"arrays or tables are nested deeper than {_DEEPEST}")
    return document


def _depth(document: dict[str, Any]) -> int:
    """Return how deep arrays and tables are nested, without recursion."""
    depth, level = 0, [document]
    while level:
        held = [entry for each in level for entry in (each.values() if isinstance(each, dict) else each)]
        depth, level = depth + 1, [entry for entry in held if isinstance(entry, dict | list)]
    return depth
