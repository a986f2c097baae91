"""Moving pictures of orbits, as files.

Films as files: which kinds can be written, and how frames are drawn into one.

MP4 and WebM are written by ffmpeg, as matplotlib calls it. A GIF has one palette for all frames, chosen from a few of
them: a sixth of the size that a palette for each frame makes, as matplotlib writes it.
"""

import functools
import math
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any, TypeAlias, Unpack, cast

import numpy as np
from matplotlib.animation import FFMpegWriter
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgba_array
from matplotlib.figure import Figure
from PIL import Image

from nonholo.base.checks import checked_path, count, error, function, positive, shown, within_memory
from nonholo.base.types import Float
from nonholo.groups import SE, SO
from nonholo.io.places import check_file, complete_file
from nonholo.orbit import AbstractOrbit, Orbit
from nonholo.plot import theme
from nonholo.plot.animation import _scenes
from nonholo.plot.animation._scenes import Show, part_of, part_of_flow, shown_states
from nonholo.plot.motion.coordinates import momentum_track, track_of
from nonholo.plot.overviews import name_of
from nonholo.plot.parts import drawable_in_time, orbit_with_poses, same_space

_SIZE = 4.8  # inches; 480 pixels

Progress: TypeAlias = Callable[[int, int], None] | None
_DPI = 100  # pixels per inch
_COLORS = 96
_SHOWN_FOR_PALETTE = 6
_APART = 6  # colors of a palette, which pillow does not tell apart if they are closer
_CODECS = {  # of constant quality: lines of one color need few bits
    ".mp4": ("h264", ["-crf", "18", "-movflags", "+faststart"]),
    ".webm": ("libvpx-vp9", ["-pix_fmt", "yuv420p", "-crf", "30", "-b:v", "0", "-cpu-used", "4", "-row-mt", "1"]),
}


@theme.in_style
def animate(
    orbit: AbstractOrbit,
    path: str | Path,
    frames: int = 120,
    fps: float = 25.0,
    progress: Callable[[int, int], None] | None = None,
    *,
    flow: AbstractOrbit | None = None,
    overwrite: bool = False,
    **look: Unpack[theme.Look],
) -> Path:
    """Make a film of the moving body: a GIF, or an MP4 or WebM where the program ffmpeg is installed.

    On SO(3) the body turns within the sphere on which its forbidden axis, otherwise body axis 3, leaves a trace. It is
    drawn as the box whose mass tensor is proportional to its own; on SE(3) as the box that has its mass tensor; on
    SE(2) as the ellipse that has its mass and moment of inertia. In coordinates it is the `outline` of its system, or
    a point where there is none. A motion on another group is a point in the plane of its two largest momenta along
    the constraint. Of a long orbit of a body the part about the transition is shown, so that the body visibly moves
    but does not flicker.

    Args:
        orbit: An orbit of any system; with poses on SO(3), SE(2) or SE(3).
        path: Where to write, a new file; ends in .gif, .mp4 or .webm.
        frames: Number of frames; fewer if the orbit has fewer states.
        fps: Frames per second.
        progress: Called with the number of finished frames and their total.
        flow: The continuous motion from the same initial data, drawn beside the orbit at the same times.
        overwrite: Replace an older film at the path.
        **look: Title, label, color and more: `nh.plot.Look`. An inch of `size` has 100 pixels.

    Returns:
        The path.

    Raises:
        FileExistsError: The path exists, and is not to be replaced.
        ValueError: An orbit of a body without poses, a flow of another body, another suffix or one that
            needs ffmpeg, a number that is not positive.

    Example:
        >>> folder = getfixture("tmp_path")
        >>> sleigh = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1)
        >>> orbit = nh.simulate(sleigh, body_velocity=(1, 0, 0), steps=20)
        >>> nh.plot.animate(orbit, folder / "sleigh.gif", frames=3, size=(3.2, 2.4)).name
        'sleigh.gif'
    """
    orbit = drawable_in_time("animate(orbit=...)", orbit)
    motion, scene = _scene_of("animate(orbit=...)", orbit)
    if (beside := same_space("animate(flow=...)", flow, orbit)) is not None:
        _scene_of("animate(flow=...)", beside)
    target = film_path("animate(path=...)", path, overwrite=overwrite)
    total = min(count("animate(frames=...)", frames, "Pass how many frames there should be."), len(orbit))
    if progress is not None:
        function("animate(progress=...)", progress)
    rate = float(positive("animate(fps=...)", fps, "Pass frames per second."))
    frame_states = shown_states(orbit, motion(orbit), total)
    figure, axes, set_clock = _stage(orbit, orbit.time[frame_states])
    others = [] if beside is None else [part_of_flow(beside, orbit.time[frame_states])]
    shows = [set_clock, *scene(axes, orbit, [part_of(orbit, frame_states), *others])]
    with complete_file(target) as part:
        write_film(part, figure, shows, len(frame_states), rate, progress)
    return target


def _scene_of(where: str, orbit: AbstractOrbit) -> tuple[Callable[[Any], float], Callable[..., Iterator[Show]]]:
    """Return the motion of an orbit between saved states, in units of what the eye can follow, and what draws it."""
    track = track_of(orbit) or momentum_track(orbit)
    scenes: dict[Any, tuple[Any, Any]] = {
        SO(3): (_scenes.motion_on_sphere, _scenes.draw_on_sphere),
        SE(2): (_scenes.motion_in_plane, _scenes.draw_body_in_plane),
        SE(3): (_scenes.motion_in_space, functools.partial(_scenes.draw_in_space, track)),
    }
    if isinstance(orbit, Orbit) and orbit.system.group in scenes:
        return scenes[orbit_with_poses(where, orbit).system.group]
    draw = _scenes.draw_path_in_plane if len(track.names) == 2 else _scenes.draw_in_space
    return lambda _: 0.0, functools.partial(draw, track)


def _stage(orbit: AbstractOrbit, times: Float[np.ndarray, "F"]) -> tuple[Figure, Axes, Show]:
    """Return a figure with a title, the time and a strip that shows the progress; its axes; what sets both."""
    figure = theme.new_figure((_SIZE, _SIZE), None)
    axes = figure.add_axes((0.02, 0.05, 0.96, 0.88))
    figure.text(0.03, 0.965, theme.option("title", name_of(orbit)), va="center", fontsize="large", fontweight="bold")
    clock = figure.text(0.97, 0.965, "", va="center", ha="right", family="monospace", color=theme.QUIET)
    strip = figure.add_axes((0.03, 0.022, 0.94, 0.012), xlim=(0, 1), ylim=(0, 1))
    strip.set_axis_off()
    colors = theme.time_colors(orbit, np.linspace(times[0], times[-1], 256))
    strip.imshow(colors[None], extent=(0, 1, 0, 1), aspect="auto", alpha=0.9)
    cover = strip.axvspan(0.0, 1.0, color=theme.LEVEL, linewidth=0)

    def set_clock(frame: int) -> None:
        part = (frame + 1) / len(times)
        cover.set(x=part, width=1 - part)
        clock.set_text(f"t = {times[frame]:.4g}")

    return figure, axes, set_clock


def film_path(where: str, path: str | Path, *, overwrite: bool) -> Path:
    """Return a path at which a film can be written on this machine."""
    target = checked_path(where, path)
    if (suffix := target.suffix.lower()) not in (".gif", *_CODECS):
        raise error(where, "end in .gif, .mp4 or .webm", shown(str(path)), "Use `orbit.to_html` for a page.")
    if suffix in _CODECS and not FFMpegWriter.isAvailable():
        remedy = "Install it (on Debian the package ffmpeg), or write a .gif."
        raise error(where, "end in .gif without the program ffmpeg", shown(str(path)), remedy)
    check_file(target, overwrite=overwrite, where=where)
    return target


def write_film(path: str, figure: Figure, shows: list[Show], total: int, rate: float, progress: Progress) -> None:
    """Write a film with this many frames a second, each drawn in the figure by all of `shows`."""
    if codec := _CODECS.get(Path(path).suffix.lower()):
        writer = FFMpegWriter(cast(Any, rate), codec[0], bitrate=-1, extra_args=codec[1])
        with writer.saving(figure, path, _DPI):
            for _ in _frames(shows, range(total), progress):
                writer.grab_frame()
        return
    figure.set_dpi(_DPI)
    canvas = FigureCanvasAgg(figure)
    size = float(total) * math.prod(canvas.get_width_height())
    within_memory("animate(frames=...)", size, "Ask for fewer, or write a .mp4.")

    def photograph() -> Image.Image:
        canvas.draw()
        return Image.fromarray(np.asarray(canvas.buffer_rgba())[..., :3].copy(), "RGB")

    some = np.unique(np.linspace(0, total - 1, _SHOWN_FOR_PALETTE).round().astype(int)).tolist()
    look: Any = {"palette": _palette([photograph() for _ in _frames(shows, some)]), "dither": Image.Dither.NONE}
    first, *others = [photograph().quantize(**look) for _ in _frames(shows, range(total), progress)]
    first.save(path, save_all=True, append_images=others, duration=max(20, round(1000 / rate)), loop=0, optimize=True)


def _frames(shows: list[Show], frames: Sequence[int], progress: Progress = None) -> Iterator[int]:
    """Draw frames one by one, and report each after what is done with it."""
    for frame in frames:
        for show in shows:
            show(frame)
        yield frame
        if progress is not None:
            progress(frame + 1, len(frames))


def _palette(samples: list[Image.Image]) -> Image.Image:
    sheet = Image.fromarray(np.concatenate([np.asarray(sample) for sample in samples]), "RGB")
    common = sheet.quantize(colors=_COLORS, method=Image.Quantize.MEDIANCUT).getpalette() or []
    # thin lines are too few pixels to be given a color of their own, so theirs are added; white stays white
    own = (theme.PAPER, theme.INK, theme.CONTINUOUS, *theme.COMPONENTS)
    lines = (255 * np.vstack([theme.TIME(np.linspace(0, 1, 24)), to_rgba_array(own)])[:, :3]).round()
    others = np.reshape(common[: 3 * _COLORS], (-1, 3))
    apart = np.abs(others[:, None] - lines).max(axis=2).min(axis=1) > _APART
    palette = Image.new("P", (1, 1))
    palette.putpalette(np.concatenate([others[apart], lines]).astype(int).ravel().tolist())
    return palette
