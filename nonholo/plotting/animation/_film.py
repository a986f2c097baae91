"""Films as files: which kinds can be written, and how frames are drawn into one.

MP4 and WebM are written by ffmpeg, as matplotlib calls it. A GIF has one palette for all frames, chosen from a few of
them: a sixth of the size that a palette for each frame makes, as matplotlib writes it.
"""

import math
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, TypeAlias, cast

import numpy as np
from matplotlib.animation import FFMpegWriter
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgba_array
from matplotlib.figure import Figure
from PIL import Image

from nonholo.base.checks import error, shown
from nonholo.base.checks import path as checked_path
from nonholo.base.limits import within_memory
from nonholo.io import check_file
from nonholo.plotting import theme

Progress: TypeAlias = Callable[[int, int], None] | None
_DPI = 100  # pixels per inch
_COLORS = 96
_SHOWN_FOR_PALETTE = 6
_APART = 6  # colors of a palette, which pillow does not tell apart if they are closer
_CODECS = {  # of constant quality: lines of one color need few bits
    ".mp4": ("h264", ["-crf", "18", "-movflags", "+faststart"]),
    ".webm": ("libvpx-vp9", ["-pix_fmt", "yuv420p", "-crf", "30", "-b:v", "0", "-cpu-used", "4", "-row-mt", "1"]),
}


def film_path(where: str, path: str | Path, *, overwrite: bool) -> Path:
    """Return a path at which a film can be written on this machine."""
    target = checked_path(where, path)
    suffix = target.suffix.lower()
    if suffix not in (".gif", *_CODECS):
        raise error(where, "end in .gif, .mp4 or .webm", shown(str(path)), "Use `overview` for a still picture.")
    if suffix in _CODECS and not FFMpegWriter.isAvailable():
        remedy = "Install it (on Debian the package ffmpeg), or write a .gif."
        raise error(where, "end in .gif where there is no program ffmpeg", shown(str(path)), remedy)
    check_file(target, overwrite=overwrite, where=where)
    return target


def write_film(
    path: str, figure: Figure, draw: Callable[[int], None], total: int, rate: float, progress: Progress = None
) -> None:
    """Write a film with this many frames a second, of whose figure `draw` makes each."""
    codec = _CODECS.get(Path(path).suffix.lower())
    if codec is None:
        _write_gif(path, figure, draw, total, rate, progress)
        return
    with FFMpegWriter(cast(Any, rate), codec[0], bitrate=-1, extra_args=codec[1]).saving(figure, path, _DPI) as writer:
        for _ in _frames(draw, total, progress):
            writer.grab_frame()


def _frames(draw: Callable[[int], None], total: int, progress: Progress) -> Iterator[int]:
    """Draw the frames one by one, and report each after what is done with it."""
    for frame in range(total):
        draw(frame)
        yield frame
        if progress is not None:
            progress(frame + 1, total)


def _write_gif(
    path: str, figure: Figure, draw: Callable[[int], None], total: int, rate: float, progress: Progress
) -> None:
    figure.set_dpi(_DPI)
    canvas = FigureCanvasAgg(figure)
    held = float(total) * math.prod(canvas.get_width_height())
    within_memory("animate(frames=...)", held, "Ask for fewer, or write a .mp4.")

    def photograph() -> Image.Image:
        canvas.draw()
        return Image.fromarray(np.asarray(canvas.buffer_rgba())[..., :3].copy(), "RGB")

    samples = []
    for frame in np.unique(np.linspace(0, total - 1, _SHOWN_FOR_PALETTE).round().astype(int)):
        draw(int(frame))
        samples.append(photograph())
    look: Any = {"palette": _palette(samples), "dither": Image.Dither.NONE}
    first, *others = [photograph().quantize(**look) for _ in _frames(draw, total, progress)]
    duration = max(20, round(1000 / rate))
    first.save(path, save_all=True, append_images=others, duration=duration, loop=0, optimize=True)


def _palette(samples: list[Image.Image]) -> Image.Image:
    width, height = samples[0].size
    sheet = Image.new("RGB", (width, height * len(samples)))
    for row, sample in enumerate(samples):
        sheet.paste(sample, (0, row * height))
    common = sheet.quantize(colors=_COLORS, method=Image.Quantize.MEDIANCUT).getpalette() or []
    # thin lines are too few pixels to be given a color of their own, so theirs are added; white stays white
    own = (theme.PAPER, theme.INK, theme.CONTINUOUS, *theme.COMPONENTS)
    lines = (255 * np.vstack([theme.TIME(np.linspace(0, 1, 24)), to_rgba_array(own)])[:, :3]).round()
    others = np.reshape(common[: 3 * _COLORS], (-1, 3))
    apart = np.abs(others[:, None] - lines).max(axis=2).min(axis=1) > _APART
    palette = Image.new("P", (1, 1))
    palette.putpalette(np.concatenate([others[apart], lines]).astype(int).ravel().tolist())
    return palette
