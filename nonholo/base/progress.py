"""The progress bar of everything that takes long: on standard error, gone when the work is done."""

import contextlib
import contextvars
import sys
import time
from collections.abc import Callable, Iterator
from concurrent.futures import CancelledError

from rich.console import Console
from rich.progress import Progress, ProgressColumn, Task, TimeElapsedColumn
from rich.text import Text

_LATE = 2.0  # seconds

_over: contextvars.ContextVar[Callable[[], bool]] = contextvars.ContextVar("over", default=lambda: False)


@contextlib.contextmanager
def until(over: Callable[[], bool]) -> Iterator[None]:
    """Let what runs inside end with `CancelledError` at its first report after `over` has become true.

    Work in another thread is ended so: Ctrl-C reaches the main thread alone.

    Example:
        >>> with until(lambda: True), progress_bar("steps", wanted=False) as report:
        ...     report(3, 10)
        Traceback (most recent call last):
        concurrent.futures._base.CancelledError
    """
    token = _over.set(over)
    try:
        yield
    finally:
        _over.reset(token)


def _go_on() -> None:
    if _over.get()():
        raise CancelledError


class _Rate(ProgressColumn):
    """The number done in a second."""

    def render(self, task: Task) -> Text:
        speed = task.finished_speed or task.speed
        return Text("" if speed is None else f"{speed:,.0f}/s", style="progress.data.speed")


def progress_bar(title: str, wanted: bool) -> contextlib.AbstractContextManager[Callable[[int, int], None]]:
    """Give a function that reports how much is done, and of how much.

    Example:
        >>> with progress_bar("steps", wanted=False) as report:
        ...     report(3, 10)
    """
    return _shown_bar(title) if wanted else contextlib.nullcontext(lambda *_: _go_on())


@contextlib.contextmanager
def _shown_bar(title: str) -> Iterator[Callable[[int, int], None]]:
    columns = (*Progress.get_default_columns(), TimeElapsedColumn(), _Rate())
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(title, total=None)  # the bar pulses until it is known of how much

        def report(done: int, total: int) -> None:
            _go_on()
            bar.update(task, completed=done, total=total)

        yield report


@contextlib.contextmanager
def late_bar(title: str) -> Iterator[Callable[[int, int], None]]:
    """Give a function that reports how much is done, which a terminal shows of what takes longer than two seconds.

    Example:
        >>> with late_bar("flow") as report:
        ...     report(3, 10)
    """
    with contextlib.ExitStack() as opened:
        begun, bars = time.monotonic(), []

        def report(done: int, total: int) -> None:
            _go_on()
            if not bars and time.monotonic() - begun > _LATE and sys.stderr.isatty():
                bars.append(opened.enter_context(_shown_bar(title)))
            for show in bars:
                show(done, total)

        yield report


@contextlib.contextmanager
def waiting(title: str, wanted: bool) -> Iterator[None]:
    """Show what is being done, and for how long, where there is nothing to count.

    Example:
        >>> with waiting("measuring", wanted=False):
        ...     pass
    """
    with progress_bar(title, wanted):
        yield
