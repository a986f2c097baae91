"""Moving pictures of orbits, as GIF files."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import Unpack

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgba_array
from matplotlib.figure import Figure
from PIL import Image

from nonholo.base.checks import count, error, function, positive, shown
from nonholo.base.checks import path as checked_path
from nonholo.base.limits import within_memory
from nonholo.base.types import Int
from nonholo.io import check_file
from nonholo.orbit import Orbit
from nonholo.plotting import theme
from nonholo.plotting.animation._scenes import sleigh_motion, sleigh_scene, top_motion, top_scene
from nonholo.plotting.parts import drawable, posed, window
from nonholo.plotting.sheets import sheet_of

_COLORS = 96
_SHOWN_FOR_PALETTE = 6


@theme.styled
def animate(
    orbit: Orbit,
    path: str | Path,
    frames: int = 120,
    fps: float = 25.0,
    progress: Callable[[int, int], None] | None = None,
    *,
    overwrite: bool = False,
    **look: Unpack[theme.Look],
) -> Path:
    """Make a GIF of the moving body: a top with its forbidden axis on the sphere, or a sleigh with its track.

    The top is drawn as the box whose mass tensor is proportional to its own, the sleigh as the ellipse that has its
    mass and moment of inertia. Of a long orbit the part about the transition is shown, so that the body visibly moves
    but does not flicker.

    Args:
        orbit: An orbit of a Suslov top on SO(3) or of a sleigh in the plane, with poses.
        path: Where to write, a new file; ends in .gif.
        frames: Number of frames; fewer if the orbit has fewer states.
        fps: Frames per second.
        progress: Called with the number of finished frames and their total.
        overwrite: Replace an older animation at the path.
        **look: Title, label, color and more: `nh.plot.Look`.

    Returns:
        The path.

    Raises:
        FileExistsError: The path exists, and is not to be replaced.
        ValueError: An orbit of another system or without poses, another suffix, a number that is not positive.

    Example:
        >>> folder = getfixture("tmp_path")
        >>> sleigh = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1)
        >>> orbit = nh.simulate(sleigh, body_velocity=(1, 0, 0), steps=20)
        >>> nh.plot.animate(orbit, folder / "sleigh.gif", frames=3).name
        'sleigh.gif'
    """
    motion, scene = _scene_of(orbit)
    target = _target(path)
    check_file(target, overwrite=overwrite, where="animate(path=...)")
    remedy = "Pass how many frames there should be."
    total = min(count("animate(frames=...)", frames, remedy), len(orbit))
    if progress is not None:
        function("animate(progress=...)", progress)
    rate = float(positive("animate(fps=...)", fps, "Pass frames per second."))
    shown = _shown_states(orbit, motion(orbit), total)
    figure, show = scene(orbit, shown)
    canvas = FigureCanvasAgg(figure)
    within_memory("animate(frames=...)", float(len(shown)) * math.prod(canvas.get_width_height()), "Ask for fewer.")
    sampled = np.unique(np.linspace(0, len(shown) - 1, _SHOWN_FOR_PALETTE).round().astype(int))
    palette = _palette([_photograph(canvas, show, int(frame)) for frame in sampled])
    pictures = []
    for frame in range(len(shown)):
        pictures.append(_photograph(canvas, show, frame).quantize(palette=palette, dither=Image.Dither.NONE))
        if progress is not None:
            progress(frame + 1, len(shown))
    duration = max(20, round(1000 / rate))
    pictures[0].save(target, save_all=True, append_images=pictures[1:], duration=duration, loop=0, optimize=True)
    return target


def _scene_of(orbit: Orbit) -> tuple[Callable[[Orbit], float], Callable[..., tuple[Figure, Callable[[int], None]]]]:
    where = "animate(orbit=...)"
    sheet = sheet_of(drawable(where, orbit).system)
    if sheet is None:
        got = f"{orbit!r} on {orbit.system.group}"
        requirement = "be an orbit of a Suslov top in space or a sleigh in the plane"
        raise error(where, requirement, got, "Use `overview` for a still picture.")
    posed(where, orbit)
    return (top_motion, top_scene) if sheet.blade is None else (sleigh_motion, sleigh_scene)


def _target(path: str | Path) -> Path:
    target = checked_path("animate(path=...)", path)
    if target.suffix.lower() != ".gif":
        raise error("animate(path=...)", "end in .gif", shown(str(path)), "Use `overview` for a still picture.")
    return target


def _shown_states(orbit: Orbit, motion: float, total: int) -> Int[np.ndarray, "F"]:
    """Return the states of the frames: the whole orbit, or the part about the transition if it moves too fast for that.

    `motion` is how far the body moves between two saved states, in units of what the eye can follow.
    """
    stride = max(1, int(1 / motion)) if motion > 0 else len(orbit)
    if len(orbit) <= stride * total:
        return np.linspace(0, len(orbit) - 1, total).round().astype(int)
    return np.arange(len(orbit))[window(orbit, motion, 1.0, total)]


def _photograph(canvas: FigureCanvasAgg, show: Callable[[int], None], frame: int) -> Image.Image:
    show(frame)
    canvas.draw()
    return Image.fromarray(np.asarray(canvas.buffer_rgba())[..., :3].copy(), "RGB")


def _palette(samples: list[Image.Image]) -> Image.Image:
    width, height = samples[0].size
    sheet = Image.new("RGB", (width, height * len(samples)))
    for row, sample in enumerate(samples):
        sheet.paste(sample, (0, row * height))
    common = sheet.quantize(colors=_COLORS, method=Image.Quantize.MEDIANCUT).getpalette() or []
    # thin lines are too few pixels to be given a color of their own, so theirs are added
    lines = np.vstack([theme.TIME(np.linspace(0, 1, 24)), to_rgba_array([theme.PAPER, theme.UNSTABLE, theme.INK])])
    palette = Image.new("P", (1, 1))
    palette.putpalette(common[: 3 * _COLORS] + (255 * lines[:, :3]).round().astype(int).ravel().tolist())
    return palette
