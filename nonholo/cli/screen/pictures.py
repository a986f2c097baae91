"""Pictures of a run, drawn beside its store; a picture that fails never costs the run."""

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

from nonholo.base.progress import progress_bar, waiting
from nonholo.cli.screen.errors import warn
from nonholo.cli.screen.kinds import KINDS, figure_of
from nonholo.io import complete_file

if TYPE_CHECKING:
    from nonholo.orbit import Orbit

_MOST_TIMES = 20_000  # of the flow that is drawn along


def beside(store: Path, suffix: str) -> Path:
    """Return the path of a picture that belongs to a store."""
    return store.with_name(f"{store.name.removesuffix('.zarr')}.{suffix}")


def draw(
    orbit: "Orbit",
    picture: Path | None,
    animation: Path | None,
    *,
    progress: bool,
    look: dict[str, Any] | None = None,
    kind: str = KINDS[0],
    dpi: float = 150,
    **names: str | None,
) -> dict[str, str | None]:
    """Draw what is asked for, with progress if wanted; return the paths of what was drawn, None for the rest."""
    look = look or {}
    drawn: dict[str, str | None] = {"picture": None, "animation": None}
    if picture is None and animation is None:
        return drawn
    os.environ.setdefault("MPLBACKEND", "agg")
    try:
        from nonholo import plot

        if picture is not None:
            with complete_file(picture) as part, waiting("drawing", progress):
                figure_of(kind, orbit, _flow, look, **names).savefig(part, dpi=dpi)
            drawn["picture"] = str(picture)
        if animation is not None:
            with progress_bar("frames", progress) as report:
                plot.animate(orbit, animation, progress=report, overwrite=True, **look)
            drawn["animation"] = str(animation)
    except Exception as failure:
        warn(f"no picture: {type(failure).__name__}: {failure}")
    return drawn


def warn_of_older(store: Path, drawn: dict[str, str | None]) -> None:
    """Say so if a picture beside a store that was replaced still shows the run before."""
    for path in (beside(store, "png"), beside(store, "gif")):
        if path.exists() and str(path) not in drawn.values():
            warn(f"'{path}' shows an older run. Remove it, or draw it again with: nonholo plot {store}")


def _flow(orbit: "Orbit") -> "Orbit | None":
    """Return the continuous motion from the same start where a closed form makes it cheap."""
    import nonholo

    if not orbit.is_compact:
        return None
    form = orbit.system.normal_form
    is_exact = form is not None and form.is_sleigh and form.is_planar
    if orbit.cayley is None or orbit.canonical_pose is None or not is_exact:
        return None
    times = orbit.time[:: max(1, len(orbit) // _MOST_TIMES)]
    start = {"momentum": orbit.restricted_momentum[0], "configuration": orbit.configuration[0]}
    try:
        return nonholo.flow(orbit.system, times=times, method="closed_form", **start)
    except Exception as failure:
        warn(f"the continuous motion is not drawn along: {type(failure).__name__}: {failure}")
        return None
