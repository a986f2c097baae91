"""The map of a sweep, drawn beside its store; a picture that fails never costs the result."""

import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from nonholo.base.progress import waiting
from nonholo.cli.scenario.sweeps import library_name
from nonholo.cli.scenario.toml import parsed
from nonholo.cli.screen.errors import FAILED, store_errors, warn
from nonholo.io import complete_file

if TYPE_CHECKING:
    import xarray


def draw_sweep(
    result: "xarray.Dataset", picture: Path, *names: str | None, dpi: float = 150, **look: Any
) -> str | None:
    """Draw a quantity over the design; return the path of the picture, None if there is none."""
    os.environ.setdefault("MPLBACKEND", "agg")
    quantity, across, up = (None if name is None else _named(name) for name in names)
    try:
        from nonholo import plot

        figure: Any = plot.sweep_map(result, quantity, across, up, **look).axes.figure
        with complete_file(picture) as part, waiting("drawing", sys.stderr.isatty()):
            figure.savefig(part, dpi=dpi)
    except Exception as failure:
        warn(f"no picture: {type(failure).__name__}: {failure}")
        return None
    return str(picture)


def _named(path: str) -> str:
    """Return the name in a result of a key path."""
    from nonholo.ensembles import component_name

    return component_name(library_name(path))


def draw_stored_sweep(
    store: Path, picture: Path, color: str | None, x: str | None, y: str | None, **options: Any
) -> tuple[str | None]:
    """Draw the sweep of a store: what is asked for, or what its scenario shows."""
    from nonholo.ensembles import load_sweep
    from nonholo.ensembles.stores import attributes_of

    with store_errors(FAILED):
        result = load_sweep(store)
    if not (color or x or y):
        shown = _output_of(attributes_of(store).get("scenario", ""))
        color, x, y = (shown.get(name) for name in ("color", "x", "y"))
    return (draw_sweep(result, picture, color, x, y, **options),)


def _output_of(scenario: str) -> dict[str, Any]:
    """Return the table [output] of a scenario; of a text that is none, which a store may keep too, an empty one."""
    try:
        output = parsed(scenario).get("output")
    except ValueError:
        return {}
    return output if isinstance(output, dict) else {}
