"""The progress bar of everything that takes long: on standard error, gone when the work is done."""

import contextlib
from collections.abc import Callable, Iterator

from rich.console import Console
from rich.progress import Progress, ProgressColumn, Task
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
    with Progress(*Progress.get_default_columns(), _Rate(), console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(title)
        yield lambda done, total: bar.update(task, completed=done, total=total)
