"""A finding: one statement of the paper, and the number that decides it."""

import dataclasses
from collections.abc import Callable
from typing import Literal

from nonholo_paper._verdict import Verdict

Kind = Literal["equation", "lemma", "proposition", "theorem", "remark", "figure", "footnote"]


@dataclasses.dataclass(frozen=True)
class Measured:
    """The largest distance between two sides of a statement, over the data that it was evaluated on.

    Attributes:
        corrected: Defect of the right statement.
        printed: Defect of the one that is denied, where there is one: large. It is the printed statement of an
            erratum, or what a remark or an answer excludes.
        note: What was evaluated, in a few words: "40 random tops, n = 3, 4, 6".
    """

    corrected: float
    printed: float | None = None
    note: str = ""


@dataclasses.dataclass(frozen=True)
class Finding:
    """A statement of the paper, its verdict, and how it is measured.

    Attributes:
        label: Label of the equation, theorem or figure in the paper; "footnote-3"; of an unlabeled slip its row of the
            errata, "S6" or "C2"; otherwise a name of ours.
        kind: Kind of statement.
        source: Place in the paper: "Section 4, equation (ep3.26)".
        claim: What is printed, with formulas between dollar signs: between quotation marks the words of the paper,
            which every verdict but "right as printed" needs; otherwise our words.
        verdict: The verdict.
        corrected: The right statement; of remarks and questions what is added, what is answered.
        errata: Rows of the errata that it decides.
        tolerance: Largest defect of a right statement; the one that is denied has to have more than 1000 times as much.
        measure: Evaluates it.
    """

    label: str
    kind: Kind
    source: str
    claim: str
    verdict: Verdict
    corrected: str | None
    errata: tuple[str, ...]
    tolerance: float
    measure: Callable[[], Measured]

    def holds(self, measured: Measured) -> bool:
        """Return whether the right statement holds and the wrong one fails."""
        if not measured.corrected <= self.tolerance:
            return False
        if measured.printed is None:
            return not self.verdict.is_erratum
        return measured.printed > 1000 * self.tolerance


def finding(
    label: str,
    kind: Kind,
    source: str,
    claim: str,
    *,
    verdict: Verdict = Verdict.AS_PRINTED,
    corrected: str | None = None,
    errata: tuple[str, ...] = (),
    tolerance: float,
) -> Callable[[Callable[[], Measured]], Finding]:
    """Turn a function that measures a statement into its finding."""
    if (verdict is Verdict.AS_PRINTED) != (corrected is None):
        raise ValueError(f"Finding {label!r} must have `corrected` exactly where it is not right as printed.")
    if verdict.is_erratum != bool(errata):
        raise ValueError(f"Finding {label!r} must have a row of the errata exactly where something is to be corrected.")
    if corrected is not None and not ("\u201c" in claim and "\u201d" in claim):
        raise ValueError(f"Finding {label!r} must quote the paper, since it is not right as printed.")

    def build(measure: Callable[[], Measured]) -> Finding:
        return Finding(label, kind, source, claim, verdict, corrected, errata, tolerance, measure)

    return build
