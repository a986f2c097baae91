"""The doors of the live page: of a system, a discretization or an orbit."""

import dataclasses
import html
import tempfile
import webbrowser
from importlib.metadata import version
from pathlib import Path
from typing import Any

from nonholo.base.checks import flags
from nonholo.base.checks import path as checked_path
from nonholo.explorer._motion import shown_motion
from nonholo.explorer._page import page_text
from nonholo.io import check_file, new_file

_HEIGHT = 760  # pixels in a notebook


@dataclasses.dataclass(frozen=True, repr=False)
class Page:
    """A live page; in a notebook it shows itself.

    Attributes:
        text: The whole of it, HTML in ASCII.
    """

    text: str

    def __repr__(self) -> str:
        return f"<Page of {len(self.text) / 1e3:.0f} kB>"

    def _repr_html_(self) -> str:
        allowed = "allow-scripts allow-downloads allow-modals"
        inner = html.escape(self.text, quote=True)
        look = f"width:100%;height:{_HEIGHT}px;border:0"
        return f'<iframe sandbox="{allowed}" style="{look}" title="The live page of nonholo" srcdoc="{inner}"></iframe>'

    def save(self, path: str | Path, *, overwrite: bool = False) -> None:
        """Write the page to a new file.

        Raises:
            FileExistsError: The path exists, and is not to be replaced.
        """
        where = "Page.save(path=...)"
        flags("Page.save", overwrite=overwrite)
        target = checked_path(where, path)
        check_file(target, overwrite=overwrite, where=where)
        with new_file(target, overwrite=overwrite) as file:
            file.write(self.text)

    def open(self) -> Path:
        """Write the page to a temporary file, open it in the browser, and return the file."""
        path = Path(tempfile.mkdtemp(prefix="nonholo-")) / "page.html"
        self.save(path)
        webbrowser.open(path.as_uri())
        return path


def explore(value: Any) -> Page:
    """Return the live page of a motion: one file that runs the library's own kernel in the browser.

    Tops with n = 3 and sleighs in the plane run there with the very numbers of `nh.simulate`; sliders change the body,
    the start and the time step. Any other orbit is replayed from its numbers, and the page says so. It fetches nothing,
    and its content security policy lets nothing run in it but its own view.

    Args:
        value: A system, what `discretize` returned, or an orbit with poses.

    Raises:
        ValueError: Something else, an orbit without poses, a system without a kernel for the page.

    Example:
        >>> page = explore(nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.5))
        >>> page.save("sleigh.html")  # doctest: +SKIP
        >>> page.text.count("<script")
        2
    """
    data, title, note = shown_motion("explore(value=...)", value)
    return Page(page_text(data, title, note, version("nonholo")))


def orbit_to_html(orbit: Any, path: str | Path, *, overwrite: bool = False) -> None:
    """Write the live page of an orbit to a new file; see `explore`."""
    where = "Orbit.to_html(path=...)"
    check_file(checked_path(where, path), overwrite=overwrite, where=where)
    explore(orbit).save(path, overwrite=overwrite)
