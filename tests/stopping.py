"""Runs and sweeps that are stopped while they write their store."""

import contextlib
from collections.abc import Iterator
from typing import Any, TypeAlias

import pytest

from nonholo.io.blocks import BlockStore

Failure: TypeAlias = type[BaseException] | BaseException


@contextlib.contextmanager
def failing_at(block: int, failure: Failure = KeyboardInterrupt) -> Iterator[None]:
    """Let Ctrl-C come, or a failure, when a run or a sweep writes a block."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(BlockStore, "write", _failing(BlockStore.write, block, failure))
        yield


def _failing(write: Any, block: int, failure: Failure) -> Any:
    def failing(self: BlockStore, number: int, *rest: Any) -> None:
        if number == block:
            raise failure
        write(self, number, *rest)

    return failing


@contextlib.contextmanager
def stopped_at(
    block: int, failure: Failure = KeyboardInterrupt, match: str | None = None
) -> Iterator[pytest.ExceptionInfo[BaseException]]:
    """Let Ctrl-C come, or a failure, when a run or a sweep writes a block; it has to end there."""
    kind = failure if isinstance(failure, type) else type(failure)
    with failing_at(block, failure), pytest.raises(kind, match=match) as caught:
        yield caught


@contextlib.contextmanager
def stopped_in(function: str, failure: Failure = KeyboardInterrupt, match: str | None = None) -> Iterator[None]:
    """Let Ctrl-C come, or a failure, where a function is called; it has to end what calls it."""

    def failing(*_: Any, **__: Any) -> None:
        raise failure

    kind = failure if isinstance(failure, type) else type(failure)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(function, failing)
        with pytest.raises(kind, match=match):
            yield
