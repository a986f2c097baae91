"""The list of labels, footnotes and errata rows, against the findings."""

import re
import tomllib
from collections import Counter
from importlib import resources

import pytest

from nonholo_paper._checklist import sections
from nonholo_paper._registry import UnknownLabelError, entries, select
from nonholo_paper._verdict import Verdict

LABELS = [label for section in sections() for label in section.labels]
CLAIMS = [label for section in sections() for label in section.claims]
ERRATA = [number for section in sections() for number in section.errata]


def test_list_is_whole() -> None:
    """The TeX source has 100 labels up to the end of the document and 6 footnotes; no name occurs twice."""
    footnotes = [f"footnote-{number}" for number in range(1, 7)]
    assert [label for label in LABELS if label.startswith("footnote")] == footnotes
    assert len(LABELS) - len(footnotes) == 100
    assert all(re.fullmatch(r"[SC]\d+", number) for number in ERRATA)
    assert max(Counter(LABELS + CLAIMS + ERRATA).values()) == 1


def test_findings_and_list_have_the_same_labels_and_rows() -> None:
    """Every label, footnote, claim and row of the errata has a finding, and no finding has another one."""
    labels = {entry.finding.label for entry in entries()}
    assert {*LABELS, *CLAIMS} - labels == set()
    assert labels - {*LABELS, *CLAIMS, *ERRATA} == set()
    assert {number for entry in entries() for number in entry.finding.errata} == set(ERRATA)


def test_every_claim_is_measured() -> None:
    """Each claim belongs to a function of its module that measures it, and each such function has a claim."""
    findings = [entry.finding for entry in entries()]
    measured = {(finding.measure.__module__.rpartition(".")[2], finding.measure.__name__) for finding in findings}
    files = (resources.files("nonholo_paper") / "claims").iterdir()
    tables = [table for file in files for table in tomllib.loads(file.read_text("utf-8")).items()]
    claims = {(module, name) for module, words in tables for name, claim in words.items() if isinstance(claim, dict)}
    assert claims == measured


def test_rows_are_what_is_to_be_corrected() -> None:
    """Every finding with something to correct has a row, and no remark, no answer and nothing right has one."""
    for entry in entries():
        assert entry.finding.verdict.is_erratum == bool(entry.finding.errata), entry.finding.label


def test_what_is_not_right_as_printed_is_quoted() -> None:
    """Whatever is said against a statement, or added to it, stands beside the words of the paper."""
    for entry in entries():
        quoted = re.search("\u201c.+\u201d", entry.finding.claim)
        assert quoted or entry.finding.verdict is Verdict.AS_PRINTED, entry.finding.label


def test_order_is_that_of_the_paper() -> None:
    """Sections follow each other, and labels within a section."""
    order = [sections().index(entry.section) for entry in entries()]
    assert order == sorted(order)
    listed = list(dict.fromkeys(entry.finding.label for entry in entries() if entry.finding.label in LABELS))
    assert listed == [label for label in LABELS if label in listed]


def test_findings_are_chosen_by_label_row_and_picture() -> None:
    """A label, a row of the errata and the name of a picture choose a finding."""
    assert {entry.finding.label for entry in select(["sus_int"])} == {"sus_int"}
    assert all("S14" in entry.finding.errata for entry in select(["S14"]))
    assert [entry.figure.name for entry in select(["st"]) if entry.figure] == ["st"]


def test_an_unknown_label_is_refused() -> None:
    """A label that no finding has is refused with near ones."""
    with pytest.raises(UnknownLabelError, match=r"no finding 'sus_imt'. Did you mean .*sus_int"):
        select(["sus_int", "sus_imt"])
    with pytest.raises(UnknownLabelError, match=r"docs/paper.md"):
        select(["????????????????????"])
