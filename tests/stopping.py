"""Runs that are stopped while they write their store."""

import contextlib
from collections.abc import Iterator
from typing import Any

import pytest

from nonholo.io import Stream


@contextlib.contextmanager
def stopped_at(
    block: int, failure: type[BaseException] | BaseException = KeyboardInterrupt, match: str | None = None
) -> Iterator[pytest.ExceptionInfo[BaseException]]:
    """Let Ctrl-C come, or a failure, when a run writes a block; it has to end the run."""
    write = Stream.write

    def failing(self: Stream, number: int, *rest: Any) -> None:
        if number == block:
            raise failure
        write(self, number, *rest)

    kind = failure if isinstance(failure, type) else type(failure)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Stream, "write", failing)
        with pytest.raises(kind, match=match) as caught:
            yield caught
