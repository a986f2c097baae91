"""Write docs/api/*.md, the public names by what they are for: `python docs/make_api_pages.py`."""

import inspect
import re
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
INNER = {"Frame", "FunctionRoute", "Landscape", "Members", "Place", "ScalarRoute", "Start"}  # as do these


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
    ready = _ready_systems() if "literature" in rooms else ""
    body = ready + _entries(own) + ("\n\n## Results and interfaces\n\n" + _entries(others) if others else "")
    return _TEXT.format(title=title, body=body)


def _ready_systems() -> str:
    """Return the table of ready systems: what they are, their source, what is known, and whether they have events."""
    head = "| system | what | coordinates | source | known | events |"
    rows = [head, "|---" * 6 + "|"]
    for name in sorted({*nh.examples.__all__} - {"Example"}):
        ready, text = getattr(nh.examples, name)(), inspect.getdoc(getattr(nh.examples, name)) or ""
        source = " ".join(text.partition("Reference: ")[2].partition("\n\n")[0].split())
        source = re.sub(r"\[([a-z0-9-]+)\]", r"[\1](../references.md)", source)
        cells = [
            f"`{name}`",
            text.partition("\n")[0],
            ", ".join(ready.coordinates),
            source,
            " ".join(ready.facts).replace("|", "\\|"),
        ]
        rows.append("| " + " | ".join([*cells, "yes" if _has_events(ready.system) else "no"]) + " |")
    return "\n".join([_READY, *rows, "", ""])


def _has_events(system: Any) -> bool:
    """Tell whether runs find events: parts of steps are defined in coordinates, and where the step is compiled."""
    return getattr(system, "has_parts", None) or nh.discretize(system, 0.1).route.compiled is not None


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


_READY = """\
All have pictures, `to_csv`, `to_pandas`, `nh.compare`, `nh.ensemble`, and sweeps over their parameters and starts by
`nh.FamilyTask`. Those without events have a potential written in Python, whose steps are not compiled.
"""

_TEXT = """\
<!-- written by docs/make_api_pages.py -->
# {title}

{body}
"""


if __name__ == "__main__":
    PAGES.mkdir(exist_ok=True)
    for name, text in pages().items():
        (PAGES / name).write_text(text, "utf-8")
