"""All figures by name, in the order of the paper."""

import functools
import importlib

from nonholo_paper.figures._figure import Figure

NAMES = (
    "Suslov",
    "Chsleigh",
    "mom_dynamics",
    "generic_xy",
    "st",
    "st1",
    "four_branches",
    "quat",
    "quat_dots",
    "circ",
    "deltoid",
    "cubic",
    "circle",
    "naive_spiral",
    "cusps",
)


@functools.cache
def figures() -> dict[str, Figure]:
    """Return the figures in the order of the paper."""
    modules = (importlib.import_module(f"nonholo_paper.figures.{name.lower()}") for name in NAMES)
    return {module.FIGURE.name: module.FIGURE for module in modules}
