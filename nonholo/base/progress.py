"""The progress bar of everything that takes long: on standard error, gone when the work is done."""

import contextlib
import contextvars
import itertools
import sys
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import CancelledError, ThreadPoolExecutor, wait
from typing import Any, TypeVar

from rich.console import Console
from rich.progress import Progress, ProgressColumn, Task, TimeElapsedColumn
from rich.text import Text

_LATE, _PATIENCE = 2.0, 1.0  # seconds
Result = TypeVar("Result")
_over: contextvars.ContextVar[Callable[[], bool]] = contextvars.ContextVar("over", default=lambda: False)
_overs: dict[int, Callable[[], bool]] = {}
_numbers = itertools.count()
_announcements: set[Any] = set()
_calls: set[int] = set()
_LOOK = 0.2  # seconds between two looks at the keyboard, where a signal does not end the waiting


@contextlib.contextmanager
def setting(variable: contextvars.ContextVar[Result], value: Result) -> Iterator[None]:
    """Give a variable of the context a value, which it has in the block alone.

    Example:
        >>> with setting(_over, lambda: True):
        ...     is_over()
        True
    """
    token = variable.set(value)
    try:
        yield
    finally:
        variable.reset(token)


def until(over: Callable[[], bool]) -> contextlib.AbstractContextManager[None]:
    """Let what runs inside end with `CancelledError` at its first report after `over` has become true.

    Work in another thread is ended so: Ctrl-C reaches the main thread alone.

    Example:
        >>> with until(lambda: True), progress_bar("steps", is_visible=False) as report:
        ...     report(3, 10)
        Traceback (most recent call last):
        concurrent.futures._base.CancelledError
    """
    return setting(_over, over)


def is_over() -> bool:
    """Return whether the work is over: see `until`."""
    return _over.get()()


@contextlib.contextmanager
def compiling(name: str, kind: Any, call: Any) -> Iterator[None]:
    """Report a wait on standard error, once for a kind of what is compiled; a call that has ended compiles nothing."""
    if (number := hash(call)) in _calls:  # the call itself would keep every system that was compiled
        yield
        return

    def say() -> None:
        if kind not in _announcements:
            _announcements.add(kind)
            sys.stderr.write(f"compiling {name}, once ...\n")

    timer = threading.Timer(_PATIENCE, say)
    timer.daemon = True
    timer.start()
    try:
        yield
    finally:
        timer.cancel()
    _calls.add(number)


@contextlib.contextmanager
def number_of_work() -> Iterator[int]:
    """Give a number by which code of other threads asks `number_is_over` of this work.

    Example:
        >>> with until(lambda: True), number_of_work() as number:
        ...     number_is_over(number)
        True
    """
    number = next(_numbers)
    _overs[number] = _over.get()
    try:
        yield number
    finally:
        del _overs[number]


def number_is_over(number: int) -> bool:
    """Return whether the work of a number is over, from any thread: see `number_of_work`."""
    return _overs[int(number)]()


def go_on(*_: float) -> None:
    """Raise `CancelledError` where the work is over, however much is done."""
    if _over.get()():
        raise CancelledError


_report: contextvars.ContextVar[Any] = contextvars.ContextVar("told", default=go_on)


def interruptibly(work: Callable[[], Result]) -> Result:
    """Return what a function returns; Ctrl-C is answered at once, also while compiled code is at work.

    The function runs in another thread. After Ctrl-C it is left alone, and ends where it next asks whether to `go_on`.

    Example:
        >>> interruptibly(lambda: 6 * 7)
        42
    """
    if threading.current_thread() is not threading.main_thread():
        return work()
    pool, left, context = ThreadPoolExecutor(1), threading.Event(), contextvars.copy_context()
    context.run(_over.set, left.is_set)
    future = pool.submit(context.run, work)
    try:
        while not future.done():
            wait([future], _LOOK)
    finally:
        left.set()
        pool.shutdown(wait=False)
    return future.result()


_SILENT = contextlib.nullcontext(go_on)


class _Rate(ProgressColumn):
    """The number done in a second."""

    def render(self, task: Task) -> Text:
        speed = task.finished_speed or task.speed
        return Text("" if speed is None else f"{speed:,.0f}/s", style="progress.data.speed")


def progress_bar(title: str, is_visible: bool) -> contextlib.AbstractContextManager[Callable[[float, float], None]]:
    """Give a function that reports how much is done, and of how much.

    Example:
        >>> with progress_bar("steps", is_visible=False) as report:
        ...     report(3, 10)
    """
    return _shown_bar(title) if is_visible else _SILENT


def telling(title: str, is_visible: bool) -> contextlib.AbstractContextManager[Any]:
    """Show what the work inside tells.

    Example:
        >>> with telling("time", is_visible=False):
        ...     tell(3.0, 10.0)
    """
    return _telling(title, is_visible) if is_visible or _report.get() is not go_on else _SILENT


@contextlib.contextmanager
def _telling(title: str, is_visible: bool) -> Iterator[None]:
    with progress_bar(title, is_visible) as report, setting(_report, report):
        yield


def tell(amount: float, total: float) -> None:
    """Report how much is done, and of how much, to every listener (`telling`)."""
    _report.get()(amount, total)


@contextlib.contextmanager
def _shown_bar(title: str) -> Iterator[Callable[[float, float], None]]:
    columns = (*Progress.get_default_columns(), TimeElapsedColumn(), _Rate())
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(title, total=None)  # the bar pulses until it is known of how much

        def report(amount: float, total: float) -> None:
            go_on()
            bar.update(task, completed=amount, total=total)

        yield report


@contextlib.contextmanager
def late_bar(title: str) -> Iterator[Callable[[int, int], None]]:
    """Give a function that reports how much is done, which a terminal shows of what takes longer than two seconds.

    Example:
        >>> with late_bar("flow") as report:
        ...     report(3, 10)
    """
    with contextlib.ExitStack() as stack:
        start, bars = time.monotonic(), []

        def report(amount: int, total: int) -> None:
            go_on()
            if not bars and time.monotonic() - start > _LATE and sys.stderr.isatty():
                bars.append(stack.enter_context(_shown_bar(title)))
            for show in bars:
                show(amount, total)

        yield report
