"""The page of findings: one HTML file that needs nothing else, neither scripts nor a network."""

import base64
import itertools
import platform
import re
from collections import Counter
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import jinja2
from markupsafe import Markup

from nonholo import __version__
from nonholo_paper._checklist import Section
from nonholo_paper._formulas import to_html
from nonholo_paper._run import Result
from nonholo_paper._verdict import Verdict

GENERATOR = '<meta name="generator" content="nonholo paper">'
_MIME = {"svg": "image/svg+xml", "png": "image/png"}
_LARGE = 400_000  # bytes of an SVG, beyond which its PNG is embedded
_ADDED = {Verdict.SETTLED: "Answer", Verdict.REMARK: "Added"}  # in the place of "Right"


class _Card(NamedTuple):
    """A finding on the page, with the address of its place and of its picture."""

    result: Result
    anchor: str
    verdict: Verdict
    heading: str
    status: str
    picture: str | None


def page(results: Sequence[Result], remark: str = "") -> str:
    """Return the page of findings as HTML; the remark stands below its heading."""
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("nonholo_paper", "."),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=jinja2.StrictUndefined,
    )
    environment.filters |= {"formulas": _markup, "figure": _figure}
    return environment.get_template("page.html.j2").render(
        generator=Markup(GENERATOR),  # noqa: S704 (ours)
        sections=list(_sections(results)),
        failed=[result for result in results if not result.holds],
        counts=Counter(result.entry.finding.verdict for result in results),
        total=len(results),
        verdicts=list(Verdict),
        seconds=sum(result.seconds for result in results),
        remark=remark,
        versions=f"nonholo {__version__}, Python {platform.python_version()}",
    )


def anchor(label: str, number: int) -> str:
    """Return the address of a finding on the page; of several with one label, the first is number 1.

    Example:
        >>> anchor("sus_int", 1), anchor("**", 2)
        ('sus_int', '2a2a-2')
    """
    plain = re.sub(r"[^\w.-]", lambda result: f"{ord(result[0]):x}", label)
    return plain if number == 1 else f"{plain}-{number}"


def _sections(results: Sequence[Result]) -> Iterator[tuple[Section, list[_Card]]]:
    records: Counter[str] = Counter()
    for section, group in itertools.groupby(results, key=lambda result: result.entry.section):
        yield section, [_card(result, records) for result in group]


def _card(result: Result, records: Counter[str]) -> _Card:
    finding = result.entry.finding
    records[finding.label] += 1
    status = "fails" if not result.holds else "correction holds" if finding.verdict.is_erratum else "holds"
    heading = _ADDED.get(finding.verdict, "Right")
    place = anchor(finding.label, records[finding.label])
    return _Card(result, place, finding.verdict, heading, status, _embedded(result))


def _embedded(result: Result) -> str | None:
    by_suffix = {name.rpartition(".")[2]: data for name, data in result.pictures.items()}
    if not by_suffix:
        return None
    suffix = "svg" if len(by_suffix["svg"]) < _LARGE else "png"
    return f"data:{_MIME[suffix]};base64,{base64.b64encode(by_suffix[suffix]).decode()}"


def _markup(text: str) -> Markup:
    return Markup(to_html(text))  # noqa: S704 (escaped by `to_html`)


def _figure(number: float | None) -> str:
    """Return a number in two digits."""
    return "none" if number is None else "0" if number == 0 else f"{number:.1e}"
