"""The progress bar of everything that takes long: on standard error, gone when the work is done."""

import contextlib
from collections.abc import Callable, Iterator

from rich.console import Console
from rich.progress import Progress, ProgressColumn, Task, TimeElapsedColumn
from rich.text import Text


class _Rate(ProgressColumn):
    """How many are done in a second."""

    def render(self, task: Task) -> Text:
        speed = task.finished_speed or task.speed
        return Text("" if speed is None else f"{speed:,.0f}/s", style="progress.data.speed")


@contextlib.contextmanager
def progress_bar(title: str, wanted: bool) -> Iterator[Callable[[int, int], None]]:
    """Give a function that reports how much is done, and of how much.

    Example:
        >>> with progress_bar("steps", wanted=False) as report:
        ...     report(3, 10)
    """
    if not wanted:
        yield lambda *_: None
        return
    columns = (*Progress.get_default_columns(), TimeElapsedColumn(), _Rate())
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(title, total=None)  # the bar pulses until it is known of how much
        yield lambda done, total: bar.update(task, completed=done, total=total)


@contextlib.contextmanager
def waiting(title: str, wanted: bool) -> Iterator[None]:
    """Show what goes on, and for how long, where there is nothing to count.

    Example:
        >>> with waiting("measuring", wanted=False):
        ...     pass
    """
    with progress_bar(title, wanted):
        yield
