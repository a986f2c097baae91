"""Measuring findings and drawing figures, with the time they took; a finding that raises has failed."""

import dataclasses
import io
import time
from collections.abc import Callable, Sequence

import matplotlib
from matplotlib.figure import Figure as MatplotlibFigure

from nonholo_paper._finding import Measured
from nonholo_paper._registry import Entry
from nonholo_paper.figures import Figure

FORMATS = ("png", "svg", "pdf")


@dataclasses.dataclass(frozen=True)
class Result:
    """The outcome of a finding.

    Attributes:
        entry: The finding with its place.
        measured: What it measured; None if it raised an exception.
        failure: The exception, in words.
        seconds: Time of measuring and drawing.
        pictures: The files of its picture, by name: "st.png", "st.svg", "st.pdf".
    """

    entry: Entry
    measured: Measured | None
    failure: str
    seconds: float
    pictures: dict[str, bytes] = dataclasses.field(default_factory=dict)

    @property
    def holds(self) -> bool:
        """Return whether it was measured, and the right statement holds and the wrong one fails."""
        return self.measured is not None and not self.failure and bool(self.entry.finding.holds(self.measured))


def evaluate(entry: Entry) -> Result:
    """Measure a finding and draw its picture."""
    begun = time.perf_counter()
    measured, failure, pictures = None, "", {}
    try:
        measured = entry.finding.measure()
        pictures = _draw(entry.figure) if entry.figure else {}
    except Exception as raised:
        failure = f"{type(raised).__name__}: {raised}"
    return Result(entry, measured, failure, time.perf_counter() - begun, pictures)


def evaluate_all(chosen: Sequence[Entry], report: Callable[[int, int], object]) -> list[Result]:
    """Measure findings one after another; `report` hears how many are done, and of how many."""
    results = []
    for entry in chosen:
        report(len(results), len(chosen))
        results.append(evaluate(entry))
    return results


def _draw(figure: Figure) -> dict[str, bytes]:
    drawn = figure.draw()
    return {f"{figure.name}.{suffix}": _saved(drawn, suffix) for suffix in FORMATS}


def _saved(drawn: MatplotlibFigure, suffix: str) -> bytes:
    target = io.BytesIO()
    undated = {"png": {}, "svg": {"Date": None}, "pdf": {"CreationDate": None}}
    with matplotlib.rc_context({"svg.hashsalt": "nonholo"}):
        drawn.savefig(target, format=suffix, dpi=150, metadata=undated[suffix])
    return target.getvalue()
