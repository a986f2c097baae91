"""Texts in TOML from anywhere, bounded in depth before anybody looks at what they say."""

import tomllib
from typing import Any

_DEEPEST = 32  # arrays and tables in each other


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
