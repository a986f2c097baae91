"""The folder of the page: whose it is, and how it is written. Nothing is measured here."""

import json
import math
import os
import uuid
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from nonholo_paper._page import GENERATOR, page
from nonholo_paper._run import Result

_PAGE = "index.html"
_DATA = "findings.json"


def check_folder(folder: Path) -> None:
    """Refuse a folder that holds something else than an earlier page.

    Raises:
        OSError: It is not a folder, holds something else, or cannot be written.
    """
    if folder.exists() and not folder.is_dir():
        raise NotADirectoryError(f"'{folder}' is not a folder. Choose another one with -o.")
    if folder.is_dir() and any(folder.iterdir()) and not _is_own(folder / _PAGE):
        what = "holds files that `nonholo paper` did not write"
        raise FileExistsError(f"The folder '{folder}' {what}. Choose an empty or a new one with -o.")
    nearest = next(parent for parent in (folder, *folder.absolute().parents) if parent.exists())
    if not os.access(nearest, os.W_OK | os.X_OK):
        raise PermissionError(f"'{nearest}' is not writable. Choose another folder with -o.")


def write_folder(folder: Path, results: Sequence[Result], remark: str = "") -> None:
    """Write index.html, findings.json and the pictures; other files in the folder stay."""
    figures = folder / "figures"
    texts = {_PAGE: page(results, remark), _DATA: json.dumps([_as_json(result) for result in results], indent=1)}
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in texts.items():
        _write(folder / name, text.encode())
    figures.mkdir(exist_ok=True)
    for result in results:
        for name, data in result.pictures.items():
            _write(figures / name, data)


def _is_own(path: Path) -> bool:
    return path.is_file() and GENERATOR in path.read_text("utf-8", errors="replace")


def _write(path: Path, data: bytes) -> None:
    part = path.with_name(f".{uuid.uuid4().hex[:12]}.{path.name}")
    try:
        part.write_bytes(data)
        part.replace(path)
    finally:
        part.unlink(missing_ok=True)


def _as_json(result: Result) -> dict[str, Any]:
    finding, measured = result.entry.finding, result.measured
    return {
        "label": finding.label,
        "kind": finding.kind,
        "source": finding.source,
        "claim": finding.claim,
        "verdict": finding.verdict,
        "corrected": finding.corrected,
        "measured": _number(measured.corrected if measured else None),
        "printed_measured": _number(measured.printed if measured else None),
        "tolerance": finding.tolerance,
        "holds": result.holds,
        "seconds": round(result.seconds, 4),
        "errata": list(finding.errata),
        "note": result.failure or (measured.note if measured else ""),
        "figure": result.entry.figure.name if result.entry.figure else None,
    }


def _number(value: float | None) -> float | str | None:
    """Return a number as JSON has it; infinity and NaN as words."""
    if value is None:
        return None
    return float(value) if math.isfinite(value) else str(float(value))
