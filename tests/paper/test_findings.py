"""Findings hold, bring what they have to, and can fail: with one sign or factor changed, one of them turns red."""

import math
import random
from types import ModuleType

import pytest
from paper.mutations import Mutant, all_mutants, functions, modules, survives, unchanged, users

from nonholo_paper._finding import Finding, Measured, finding
from nonholo_paper._registry import Entry, entries
from nonholo_paper._verdict import Verdict

SAMPLE = 40  # of all mutants; `python tests/paper/mutations.py` tries every one


def sample() -> list[Mutant]:
    """Return a part of the mutants, the same in every run."""
    reference = all_mutants()
    return random.Random(5).sample(reference, min(SAMPLE, len(reference)))  # noqa: S311 (a choice of tests)


@pytest.mark.profile("paper", keep=["energy_theorem*", "suslov_euler_angles*"])
@pytest.mark.parametrize("mutant", sample(), ids=str)
def test_a_changed_formula_turns_a_finding_red(mutant: Mutant) -> None:
    """Some finding notices the change."""
    assert not survives(mutant, users(mutant.module, mutant.function))


@pytest.mark.parametrize("module", modules(), ids=lambda module: module.__name__.rpartition(".")[2])
def test_every_formula_is_used(module: ModuleType) -> None:
    """Every function of a module of formulas is reached by a finding."""
    assert functions(module)
    assert not [name for name in functions(module) if not users(module, name)]


@pytest.mark.profile("paper", keep=["suslov_displacements*", "symmetric_pairs*"])
@pytest.mark.parametrize("mutant", sample()[:10], ids=lambda mutant: mutant.place)
def test_an_unchanged_formula_survives(mutant: Mutant) -> None:
    """Findings notice the change, not that a formula was replaced."""
    assert survives(unchanged(mutant.module, mutant.function), users(mutant.module, mutant.function))


def test_formulas_are_restored() -> None:
    """After a mutant the formula is again the one of its file."""
    mutant = sample()[0]
    before = dict(vars(mutant.module))
    survives(mutant, [])
    assert vars(mutant.module) == before


SLOW = {"S6", "bi-asymptotic", "suslov-space-axes", "top-solvability", "C35"}
QUICK = [entry for entry in reversed(entries()) if entry.figure is None and entry.finding.label not in SLOW]
HERE = (
    *{entry.finding.measure.__module__: entry for entry in QUICK}.values(),
    *{(entry.finding.kind, entry.finding.verdict): entry for entry in QUICK}.values(),
)
"""The first finding of each part of the paper, and of each verdict on each kind of statement."""


def _profile(entry: Entry) -> list[pytest.MarkDecorator]:
    """Return where a finding is tried: those of the default run have no mark."""
    return [] if entry in HERE else [pytest.mark.profile("paper", instead="test_finding_holds")]


@pytest.mark.parametrize(
    "entry", [pytest.param(entry, marks=_profile(entry), id=entry.finding.label) for entry in entries()]
)
def test_finding_holds(entry: Entry) -> None:
    """The right statement holds to its tolerance, and what is printed wrong fails."""
    measured = entry.finding.measure()
    assert entry.finding.holds(measured), measured


ERRATA = [verdict for verdict in Verdict if verdict.is_erratum]
ADDED = [Verdict.SETTLED, Verdict.REMARK]


def _finding(verdict: Verdict, claim: str = "\u201cclaim\u201d", **changed: object) -> Finding:
    errata, corrected = ("S1",) if verdict.is_erratum else (), None if verdict is Verdict.AS_PRINTED else "right"
    arguments = {"errata": errata, "corrected": corrected} | changed
    build = finding("label", "remark", "Section 1", claim, verdict=verdict, tolerance=1e-9, **arguments)
    return build(lambda: Measured(0.0))


def test_verdicts() -> None:
    """Four words say that something is to be corrected; each word has a meaning of its own."""
    names = {"MISPRINT", "HYPOTHESIS", "EXCEPTIONS", "FALSE", "CONTRADICTED"}
    assert {verdict.name for verdict in ERRATA} == names
    assert len({verdict.meaning for verdict in Verdict}) == len(Verdict)


@pytest.mark.parametrize("verdict", Verdict)
@pytest.mark.parametrize(
    ("defect", "printed", "holds"),
    [
        *((defect, 1.0, defect <= 1e-9) for defect in (0.0, 1e-9, 2e-9, math.nan)),
        *((0.0, printed, printed > 1e-6) for printed in (1e-8, 9e-7, 2e-6, math.nan)),
    ],
)
def test_a_finding_holds(verdict: Verdict, defect: float, printed: float, holds: bool) -> None:
    """What is right is met to the tolerance, what is denied fails by more than a thousand; NaN is never good."""
    assert _finding(verdict).holds(Measured(defect, printed)) is holds


@pytest.mark.parametrize("verdict", Verdict)
def test_an_erratum_shows_that_the_printed_statement_fails(verdict: Verdict) -> None:
    """Without a defect of the printed statement an erratum does not hold; the others deny nothing."""
    assert _finding(verdict).holds(Measured(0.0)) is not verdict.is_erratum


CORRECTED, ROW, QUOTED = "have `corrected` exactly where", "have a row of the errata exactly where", "quote the paper"


@pytest.mark.parametrize(
    ("verdict", "values", "words"),
    [
        *((each, {"corrected": "right" if each is Verdict.AS_PRINTED else None}, CORRECTED) for each in Verdict),
        *((each, {"errata": () if each.is_erratum else ("S1",)}, ROW) for each in Verdict),
        *((each, {"claim": "claim"}, QUOTED) for each in (*ERRATA, *ADDED)),
    ],
)
def test_what_a_verdict_needs(verdict: Verdict, values: dict[str, object], words: str) -> None:
    """A correction and a row come exactly with what is to be corrected; what is not right as printed is quoted."""
    with pytest.raises(ValueError, match=f"'label' must {words}"):
        _finding(verdict, **values)
