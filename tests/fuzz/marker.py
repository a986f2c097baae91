"""What runs only if a store makes the library run code: it leaves a file behind."""

from pathlib import Path
from typing import Any


def touch(*_: Any, **__: Any) -> dict[str, Any]:
    """Leave the file PWNED."""
    Path("PWNED").touch()
    return {}
