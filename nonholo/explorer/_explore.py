"""The doors of the live page: of a system, a discretization or an orbit.

One HTML file: the view, the kernels and the data of a motion, with a policy by which nothing else can run in it.
"""

import base64
import dataclasses
import functools
import gzip
import hashlib
import html
import json
import tempfile
import webbrowser
from importlib.metadata import version
from pathlib import Path
from typing import Any

import jinja2

from nonholo.base.checks import MissingExtraError, flags
from nonholo.base.checks import path as checked_path
from nonholo.base.memo import Keeper
from nonholo.base.results import Outcome
from nonholo.explorer._motion import kernel, kinds_beside, shown_motion, simulate_state
from nonholo.io.places import check_file, new_file
from nonholo.orbit import Orbit

_HEIGHT = 760  # pixels in a notebook

_VIEW = Path(__file__).with_name("view")


@dataclasses.dataclass(frozen=True, repr=False)
class Page(Keeper):
    """A live page; in a notebook it shows itself, and with anywidget its sliders are heard in Python.

    Attributes:
        text: The whole of it, HTML in ASCII.
        first_state: Body, start and time step with which it opens; None for a replay.
        table: The table of forces that it carries, as in its data; None without one.
    """

    text: str
    first_state: dict[str, Any] | None = None
    table: dict[str, Any] | None = None

    def __repr__(self) -> str:
        return f"<Page of {len(self.text) / 1e3:.0f} kB>"

    def _repr_html_(self) -> str:
        permissions = "allow-scripts allow-downloads allow-modals"
        inner = html.escape(self.text, quote=True)
        look = f"width:100%;height:{_HEIGHT}px;border:0"
        about = f'sandbox="{permissions}" style="{look}" title="The live page of nonholo"'
        return f'<iframe {about} srcdoc="{inner}"></iframe>'

    def _repr_mimebundle_(self, **_: Any) -> Any:
        if self.widget is None:
            return {}
        data, about = self.widget._repr_mimebundle_()
        return {**data, "text/plain": repr(self)}, about

    @functools.cached_property
    def widget(self) -> Any:
        """The page as a widget, as `mo.ui.anywidget(page.widget)` takes it in marimo; None without anywidget."""
        try:
            from nonholo.explorer._widget import PageWidget
        except MissingExtraError:
            return None
        return PageWidget(text=self.text, height=_HEIGHT, state=self.first_state or {})

    @property
    def state(self) -> dict[str, Any] | None:
        """Body, start and time step that the page shows now: the last that its sliders in a notebook said."""
        widget = vars(self).get("widget")  # there is one when a notebook has shown the page
        return self.first_state if widget is None or self.first_state is None else dict(widget.state)

    def orbit(self) -> Orbit:
        """Return the motion that the page shows now, computed here: in a notebook that of its sliders.

        Raises:
            ValueError: A replay, whose orbit was passed to `explore`; a state that is no body's.

        Example:
            >>> nh.explore(nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.5)).orbit()
            <Orbit of ChaplyginSleigh: 401 states, time 0 to 40, successful>
        """
        return simulate_state("Page.orbit()", self.state, self.table)

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

    Tops with n = 3 and sleighs in the plane, also under `Gravity`, `Friction` and a table of forces, and tops with
    n = 4 run there with the very numbers of `nh.simulate`; sliders change the body, the forces, the start and the time
    step. Any other orbit is replayed from its numbers, and the page names this. It fetches nothing, and its content
    security policy lets nothing run in it but its own view.

    Args:
        value: A system, what `discretize` returned, or an orbit with poses; in coordinates with x and y among them.

    Raises:
        ValueError: Something else, an orbit without poses, a system without a kernel for the page.

    Example:
        >>> page = explore(nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.5))
        >>> page.save("sleigh.html")  # doctest: +SKIP
        >>> page.text.count("<script")
        2
    """
    data, title, note = shown_motion("explore(value=...)", value)
    return Page(page_text(data, title, note, version("nonholo")), data.get("state"), data.get("table"))


def orbit_to_html(orbit: Any, path: str | Path, *, overwrite: bool = False) -> None:
    """Write the live page of an orbit to a new file; see `explore`."""
    where = "Orbit.to_html(path=...)"
    check_file(checked_path(where, path), overwrite=overwrite, where=where)
    explore(orbit).save(path, overwrite=overwrite)


def page_text(data: dict[str, Any], title: str, note: str, version: str) -> str:
    """Return the text of a page, in ASCII; what it is given is escaped, and data cannot end their element."""
    outcomes = {int(outcome): (outcome.name, outcome.message) for outcome in Outcome}
    modules = {} if "replay" in data else {kind: kernel(kind) for kind in kinds_beside(data["kind"])}
    kernels = {kind: base64.b64encode(gzip.compress(each, mtime=0)).decode() for kind, each in modules.items()}
    content = {**data, "title": title, "library": version, "outcomes": outcomes, "kernels": kernels}
    text = json.dumps(content, allow_nan=False, separators=(",", ":")).replace("<", "\\u003c")
    script, style = _text("view.js"), _text("style.css")
    parts = {"data": text, "licence": _text("three-LICENSE.txt"), "note": note, "title": title, "version": version}
    parts |= {"script": script, "script_hash": _hash(script), "style": style, "style_hash": _hash(style)}
    whole = jinja2.Environment(autoescape=True).from_string(_text("page.html")).render(parts)
    return whole.encode("ascii", "xmlcharrefreplace").decode()


@functools.cache
def _text(name: str) -> str:
    return (_VIEW / name).read_text("utf-8")


def _hash(text: str) -> str:
    """Return how a content security policy names a text."""
    return f"sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}"
