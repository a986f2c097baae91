"""A figure: a picture of the paper, drawn again, and the number that checks it."""

import dataclasses
from collections.abc import Callable
from typing import Any

from matplotlib.figure import Figure as MatplotlibFigure

from nonholo_paper._claims import claims, in_one_line
from nonholo_paper._finding import Finding


@dataclasses.dataclass(frozen=True)
class Figure:
    """A picture with its caption and its finding.

    Attributes:
        name: Name of its files, the label of the paper without its ending: "st" for st.fig.
        labels: Labels of the paper that it illustrates, its own first.
        caption: What is drawn, with all parameters; formulas between dollar signs.
        draw: Draws it.
        finding: Measures what it shows.
    """

    name: str
    labels: tuple[str, ...]
    caption: str
    draw: Callable[[], MatplotlibFigure]
    finding: Finding


def figure(draw: Callable[[], Any], finding: Finding) -> Figure:
    """Return the figure of a module; its name, labels and caption stand in claims/figures.toml."""
    words = claims(finding.measure.__module__)
    return Figure(words["name"], tuple(words["labels"]), in_one_line(words["caption"]), draw, finding)
