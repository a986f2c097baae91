"""One HTML file: the view, the kernels and the data of a motion, with a policy by which nothing else can run in it."""

import base64
import functools
import gzip
import hashlib
import json
from pathlib import Path
from typing import Any

import jinja2

from nonholo.base.results import Outcome
from nonholo.explorer._kernel import kernel, kinds_beside

_VIEW = Path(__file__).with_name("view")


def page_text(data: dict[str, Any], title: str, note: str, version: str) -> str:
    """Return the text of a page, in ASCII; what it is given is escaped, and data cannot end their element."""
    outcomes = {int(outcome): (outcome.name, outcome.message) for outcome in Outcome}
    kernels = {} if "replay" in data else {kind: _packed(kernel(kind)) for kind in kinds_beside(data["kind"])}
    known = {**data, "title": title, "library": version, "outcomes": outcomes, "kernels": kernels}
    text = json.dumps(known, allow_nan=False, separators=(",", ":")).replace("<", "\\u003c")
    script, style = _text("view.js"), _text("style.css")
    whole = _template().render(
        data=text,
        licence=_text("three-LICENSE.txt"),
        note=note,
        script=script,
        script_hash=_hash(script),
        style=style,
        style_hash=_hash(style),
        title=title,
        version=version,
    )
    return whole.encode("ascii", "xmlcharrefreplace").decode()


@functools.cache
def _text(name: str) -> str:
    return (_VIEW / name).read_text("utf-8")


@functools.cache
def _template() -> jinja2.Template:
    return jinja2.Environment(autoescape=True).from_string(_text("page.html"))


def _packed(module: bytes) -> str:
    return base64.b64encode(gzip.compress(module, mtime=0)).decode()


def _hash(text: str) -> str:
    """Return how a content security policy names a text."""
    return f"sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}"
