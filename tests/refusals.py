"""Refusals as tables: what is asked, and the words of the error that it ends in."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

Kinds = type[Exception] | tuple[type[Exception], ...]


def refusals(
    *rows: tuple[Any, ...],
    ask: Callable[..., object] = lambda call: call(),
    kind: Kinds = ValueError,
    begin: str = "",
    end: str = "",
) -> Callable[..., None]:
    """Return the test that each row ends in one clear error, before any work and before a file is written.

    A row holds what is asked, by default a call, and last words of the error, which may all begin and end alike.
    """

    @pytest.mark.parametrize("row", rows, ids=[row[-1] for row in rows])
    def test(row: tuple[Any, ...], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.chdir(tmp_path)
        with pytest.raises(kind, match=begin + row[-1] + end):
            ask(*row[:-1])
        assert not list(tmp_path.iterdir())

    return test


def assert_refused(subject: Any, words: str, *doors: Callable[[Any], object], kind: Kinds = ValueError) -> None:
    """Check that each door, a function such as `load_orbit`, refuses a subject, such as a path, in such words."""
    for door in doors:
        with pytest.raises(kind, match=words):
            door(subject)
