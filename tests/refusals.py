"""Refusals as tables: what is asked, and the words of the error that it ends in."""

from collections.abc import Callable
from typing import Any

import pytest

Kinds = type[Exception] | tuple[type[Exception], ...]


def refusals(
    *rows: tuple[Any, str],
    ask: Callable[[Any], object] = lambda call: call(),
    kind: Kinds = ValueError,
    begin: str = "",
    end: str = "",
) -> Callable[[Any, str], None]:
    """Return the test that each row ends in one clear error, before any work.

    A row is what is asked, by default a call, and words of the error, which may all begin and end alike.
    """

    @pytest.mark.parametrize(("given", "words"), rows, ids=[words for _, words in rows])
    def test(given: Any, words: str) -> None:
        with pytest.raises(kind, match=begin + words + end):
            ask(given)

    return test
