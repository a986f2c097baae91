"""A finding: one statement of the paper, and the number that decides it."""

import dataclasses
from collections.abc import Callable
from typing import Literal

Kind = Literal["equation", "lemma", "proposition", "theorem", "remark", "figure", "footnote"]
Printed = Literal[True, False, "misprint"]


@dataclasses.dataclass(frozen=True)
class Measured:
    """How far two sides of a statement are apart, at worst, over the data that it was evaluated on.

    Attributes:
        corrected: Defect of the right statement.
        printed: Defect of the printed one, where it differs: large, at the counterexample.
        note: What was evaluated, in a few words: "40 random tops, n = 3, 4, 6".
    """

    corrected: float
    printed: float | None = None
    note: str = ""


@dataclasses.dataclass(frozen=True)
class Finding:
    """A statement of the paper, whether it is right as printed, and how it is measured.

    Attributes:
        label: Label of the equation, theorem or figure in the paper; "footnote-3"; of an unlabelled slip its row of the
            errata, "S14" or "C22".
        kind: Kind of statement.
        source: Place in the paper: "Section 4, equation (ep3.26)".
        claim: What is printed, in our words, with formulas between dollar signs.
        as_printed: True; False for a wrong claim; "misprint" for a slip in a formula whose sense is right.
        corrected: The right statement where the printed one is not.
        errata: Rows of the errata that it decides.
        tolerance: Largest defect of a right statement; where the claim is not right as printed, the defect of the
            printed statement has to be larger than 1000 times as much.
        measure: Evaluates it.
    """

    label: str
    kind: Kind
    source: str
    claim: str
    as_printed: Printed
    corrected: str | None
    errata: tuple[str, ...]
    tolerance: float
    measure: Callable[[], Measured]

    def holds(self, measured: Measured) -> bool:
        """Tell whether the right statement holds and the wrong one fails."""
        if not measured.corrected <= self.tolerance:
            return False
        wrong = self.as_printed is not True
        return not wrong or (measured.printed is not None and measured.printed > 1000 * self.tolerance)


def finding(
    label: str,
    kind: Kind,
    source: str,
    claim: str,
    *,
    as_printed: Printed = True,
    corrected: str | None = None,
    errata: tuple[str, ...] = (),
    tolerance: float,
) -> Callable[[Callable[[], Measured]], Finding]:
    """Turn a function that measures a statement into its finding."""
    if (as_printed is True) != (corrected is None):
        raise ValueError(f"Finding {label!r} must have `corrected` exactly where it is not right as printed.")

    def build(measure: Callable[[], Measured]) -> Finding:
        return Finding(label, kind, source, claim, as_printed, corrected, errata, tolerance, measure)

    return build
