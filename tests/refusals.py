"""Tests of refusals as tables: a row holds what is passed and, last, words of the error."""

import re
from collections.abc import Callable, Collection
from pathlib import Path
from typing import Any

import pytest


def refusals(rows: Collection[Any], call: Callable[..., Any] | None = None) -> Callable[..., None]:
    """Return a test that calls a function with each row; without one a row begins with what is called.

    Rows may have names, in a dictionary. Each call must end in a `ValueError` before a file is written.
    """
    named = rows if isinstance(rows, dict) else dict(enumerate(rows))

    @pytest.mark.parametrize("row", named.values(), ids=map(str, named))
    def test(row: tuple[Any, ...], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.chdir(tmp_path)
        with pytest.raises(ValueError, match=re.compile(row[-1])):
            call(*row[:-1]) if call else row[0]()
        assert not list(tmp_path.iterdir())

    return test
