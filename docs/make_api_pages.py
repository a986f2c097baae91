"""Write docs/api/*.md, the public names by what they are for, and the list in `help(nonholo)`: run this file.

Which name belongs to which task says the docstring of `nonholo/__init__.py`, one line a name.
"""

import inspect
import re
import textwrap
from importlib import import_module
from pathlib import Path
from typing import Any

import nonholo as nh

ROOT = Path(__file__).parents[1]
PAGES = ROOT / "docs" / "api"
INIT = ROOT / "nonholo" / "__init__.py"
OPEN = ("examples", "plot", "testing")  # rooms that users name
PAGE_ROOMS = {  # each page and its rooms, whose classes are described too: what is returned, and what to build on
    "systems": ("Systems", ["systems"]),
    "groups": ("Groups", ["groups"]),
    "discrete": ("The discrete map", ["discrete"]),
    "motions": ("Motions", ["simulation", "orbit", "continuous", "base"]),
    "analysis": ("Questions", ["analysis"]),
    "plot": ("Pictures", ["plot"]),
    "explorer": ("The live page", ["explorer"]),
    "sweeps": ("Sweeps", ["ensembles"]),
    "stores": ("Stores", ["io"]),
    "lagrange-dalembert": ("Lagrange-d'Alembert", ["lagrange_dalembert"]),
    "examples": ("Examples", ["examples"]),
    "testing": ("Checks", ["testing"]),
}
INSIDE = ("io",)  # its classes serve other rooms
INNER = {"Frame", "Landscape", "Members", "Place", "ScalarRoute", "Start"}  # as do these
_LINE = re.compile(r"^    (\w+)(?:: .*)?$", re.MULTILINE)
_WIDTH = 120


def public() -> dict[str, Any]:
    """Return what every public name means, those of the open rooms with the room before it."""
    names = {name: getattr(nh, name) for name in dir(nh) if name not in OPEN}
    return names | {f"{room}.{name}": getattr(getattr(nh, room), name) for room in OPEN for name in _named_by(room)}


def tasks() -> dict[str, list[str]]:
    """Return the public names by task, as the docstring of the package has them; the open rooms among them."""
    groups = re.findall(r"^(\S[^\n]*):\n((?:    [^\n]*\n?)+)", inspect.cleandoc(nh.__doc__ or ""), re.MULTILINE)
    return {title: _LINE.findall(lines) for title, lines in groups}


def pages() -> dict[str, str]:
    """Return the text of each page, by the name of its file."""
    texts = {f"{name}.md": _page(*about) for name, about in PAGE_ROOMS.items()}
    return {"index.md": _index()} | texts


def package_text() -> str:
    """Return the text of `nonholo/__init__.py` with what every name of its docstring is for."""
    text = INIT.read_text("utf-8")
    end = text.index('"""\n', 4)
    return _LINE.sub(_with_summary, text[:end]) + text[end:]


def _with_summary(line: re.Match[str]) -> str:
    return "    " + textwrap.shorten(f"{line[1]}: {_summary(line[1])}", _WIDTH - 4, placeholder=" ...")


def _summary(name: str) -> str:
    """Return the first line of the docstring of a public name."""
    *room, own = name.split(".")
    value = getattr(getattr(nh, room[0]) if room else nh, own)
    described = inspect.isclass(value) or inspect.isroutine(value) or inspect.ismodule(value)
    text = value.__doc__ if described else _beside(own)
    return inspect.cleandoc(text or "").split("\n")[0]


def _beside(name: str) -> str:
    """Return the string that stands below the assignment of a name somewhere in the library."""
    described = re.compile(rf'^{name} = .*\nr?"""(.*?)"""', re.MULTILINE)
    return next(match[1] for path in INIT.parent.rglob("*.py") if (match := described.search(path.read_text("utf-8"))))


def _index() -> str:
    """Return the page of all names by task."""
    groups = tasks() | {f"In `nonholo.{room}`": [f"{room}.{name}" for name in _named_by(room)] for room in OPEN}
    tables = "\n\n".join(f"## {title}\n\n{_rows(names)}" for title, names in groups.items())
    return _INDEX.format(tables=tables, pages="\n".join(PAGE_ROOMS))


def _rows(names: list[str]) -> str:
    lines = ["| name | what it is for |", "|---|---|"]
    return "\n".join([*lines, *(f"| {_link(name)} | {_summary(name).replace('|', chr(92) + '|')} |" for name in names)])


def _link(name: str) -> str:
    if name in OPEN:
        return f"[{name}]({name}.md)"
    role = {"autoclass": "class", "autoexception": "exc", "autofunction": "func", "autodata": "data"}
    return f"{{py:{role['auto' + _directive(public()[name], name).partition('::')[0]]}}}`{name} <nonholo.{name}>`"


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
    ready = _ready_systems() if "examples" in rooms else ""
    body = ready + _entries(own) + ("\n\n## Results and interfaces\n\n" + _entries(others) if others else "")
    return _TEXT.format(title=title, body=body)


def _ready_systems() -> str:
    """Return the table of ready systems: what they are, their source, and what is known."""
    head = "| system | what | coordinates | source | known |"
    rows = [head, "|---" * 5 + "|"]
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
        rows.append("| " + " | ".join(cells) + " |")
    return "\n".join([_READY, *rows, "", ""])


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
    """Return what a room exports: what it lists, or else what it imports."""
    module = getattr(nh, room) if room in OPEN else import_module(f"nonholo.{room}")
    return getattr(module, "__all__", [name for name in vars(module) if not name.startswith("_")])


_READY = """\
All have pictures, `to_csv`, `to_pandas`, stores whose runs resume and extend, events, `nh.compare`, `nh.ensemble`, and
sweeps over their parameters and starts by `nh.FamilyTask`. `tests/examples/` and
`tests/cli/test_every_example.py` do all of it with each of them.
"""

_TEXT = """\
<!-- written by docs/make_api_pages.py -->
# {title}

{body}
"""

_INDEX = """\
<!-- written by docs/make_api_pages.py -->
# Every name, by task

`import nonholo as nh`; `help(nh)` shows the same list. A name leads to its formula, its arguments and an example. The
letters of the paper have [their own table](../reference/symbols.md); so have
[commands](../reference/command-line.md) and [keys of scenarios](../reference/scenarios.md);
[what works with what](../reference/what-works-with-what.md) crosses abilities with kinds of motion.

{tables}

```{{toctree}}
:hidden:

../reference/symbols
../reference/what-works-with-what
../reference/command-line
../reference/scenarios
```

```{{toctree}}
:caption: Descriptions
:hidden:

{pages}
```
"""


if __name__ == "__main__":
    PAGES.mkdir(exist_ok=True)
    for name, text in pages().items():
        (PAGES / name).write_text(text, "utf-8")
    INIT.write_text(package_text(), "utf-8")
