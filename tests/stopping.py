"""Runs that are stopped while they write their store."""

import contextlib
from collections.abc import Iterator
from typing import Any, TypeAlias

import pytest

from nonholo.io import Stream

Failure: TypeAlias = type[BaseException] | BaseException


@contextlib.contextmanager
def failing_at(block: int, failure: Failure = KeyboardInterrupt) -> Iterator[None]:
    """Let Ctrl-C come, or a failure, when a run writes a block."""
    write = Stream.write

    def failing(self: Stream, number: int, *rest: Any) -> None:
        if number == block:
            raise failure
        write(self, number, *rest)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Stream, "write", failing)
        yield


@contextlib.contextmanager
def stopped_at(
    block: int, failure: Failure = KeyboardInterrupt, match: str | None = None
) -> Iterator[pytest.ExceptionInfo[BaseException]]:
    """Let Ctrl-C come, or a failure, when a run writes a block; it has to end the run."""
    kind = failure if isinstance(failure, type) else type(failure)
    with failing_at(block, failure), pytest.raises(kind, match=match) as caught:
        yield caught
