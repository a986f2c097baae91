"""Write docs/api/*.md, the public names by what they are for: `python docs/make_api_pages.py`."""

import inspect
from importlib import import_module
from pathlib import Path
from typing import Any

import nonholo as nh

PAGES = Path(__file__).parent / "api"
OPEN = ("examples", "plot", "testing")  # rooms that users name
PAGE_ROOMS = {  # each page and its rooms, whose classes are described too: what is returned, and what to build on
    "systems": ("Systems", ["systems"]),
    "groups": ("Groups", ["groups"]),
    "discrete": ("The discrete map", ["discrete"]),
    "motions": ("Motions", ["simulation", "orbit", "continuous", "base"]),
    "analysis": ("Questions", ["analysis"]),
    "plot": ("Pictures", ["plotting"]),
    "explorer": ("The live page", ["explorer"]),
    "sweeps": ("Sweeps", ["ensembles"]),
    "stores": ("Stores", ["io"]),
    "lagrange-dalembert": ("Lagrange-d'Alembert", ["lagrange_dalembert"]),
    "examples": ("Examples", ["literature"]),
    "testing": ("Checks", ["testing"]),
}
INSIDE = ("io",)  # its classes serve other rooms
INNER = {"Frame", "Landscape", "Members", "Place", "ScalarRoute", "Start"}  # as do these


def public() -> dict[str, Any]:
    """Return what every public name means, those of the open rooms with the room before it."""
    names = {name: getattr(nh, name) for name in dir(nh) if name not in OPEN}
    return names | {f"{room}.{name}": getattr(getattr(nh, room), name) for room in OPEN for name in _named_by(room)}


def pages() -> dict[str, str]:
    """Return the text of each page, by the name of its file."""
    toctree = "\n".join(["```{toctree}", *PAGE_ROOMS, "```"])
    texts = {f"{name}.md": _page(*about) for name, about in PAGE_ROOMS.items()}
    return {"index.md": _TEXT.format(title="API", body=toctree)} | texts


def _page(title: str, rooms: list[str]) -> str:
    own = {name: value for name, value in public().items() if _room(value) in rooms}
    others = {
        f"{room}.{name}": value
        for room in rooms
        for name, value in vars(import_module(f"nonholo.{room}")).items()
        if inspect.isclass(value)
        and name in _named_by(room)
        and room not in INSIDE
        and name not in INNER
        and value not in public().values()
    }
    body = _entries(own) + ("\n\n## Results and interfaces\n\n" + _entries(others) if others else "")
    return _TEXT.format(title=title, body=body)


def _entries(names: dict[str, Any]) -> str:
    """Return a table of names, and their descriptions."""
    table = [f"   nonholo.{name}" for name in sorted(names)]
    entries = [f".. auto{_directive(names[name], name)}" for name in sorted(names)]
    return "\n".join(["```{eval-rst}", ".. autosummary::", "   :nosignatures:", "", *table, "", *entries, "```"])


def _directive(value: Any, name: str) -> str:
    if not inspect.isclass(value):
        return f"{'function' if callable(value) else 'data'}:: nonholo.{name}"
    builds_on = any(base.__module__.startswith("nonholo.") for base in value.__bases__)
    kind = "exception" if issubclass(value, Exception) else "class"
    return f"{kind}:: nonholo.{name}" + ("\n   :show-inheritance:" if builds_on else "")


def _room(value: Any) -> str:
    """Return the room of a class or function, or of the class of a value."""
    return value.__module__.split(".")[1]


def _named_by(room: str) -> list[str]:
    """Return what a room exports."""
    module = getattr(nh, room) if room in OPEN else import_module(f"nonholo.{room}")
    return getattr(module, "__all__", [])


_TEXT = """\
<!-- written by docs/make_api_pages.py -->
# {title}

{body}
"""


if __name__ == "__main__":
    PAGES.mkdir(exist_ok=True)
    for name, text in pages().items():
        (PAGES / name).write_text(text, "utf-8")
