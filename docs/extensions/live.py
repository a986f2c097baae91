"""The live page of the front page, made by the library when the site is built: `live/sleigh.html`."""

from pathlib import Path
from typing import Any

import nonholo as nh


def _write(app: Any, exception: Exception | None) -> None:
    if exception is None and app.builder.format == "html":
        folder = Path(app.outdir) / "live"
        folder.mkdir(exist_ok=True)
        sleigh = nh.discretize(nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.5, b=0.3), 0.1)
        orbit = nh.simulate(sleigh, body_velocity=(0.05, -1.0, 0.0), steps=300)
        orbit.to_html(folder / "sleigh.html", overwrite=True)


def setup(app: Any) -> dict[str, bool]:
    """Connect, before the site is searched for what it loads."""
    app.connect("build-finished", _write, priority=800)
    return {"parallel_read_safe": True}
