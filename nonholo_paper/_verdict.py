"""The verdict on a statement of the paper: one word, and its meaning."""

import enum


class Verdict(enum.StrEnum):
    """Whether a statement of the paper is right, and if not, in which way.

    Example:
        >>> Verdict.MISPRINT.is_erratum, Verdict.REMARK.is_erratum, str(Verdict.EXCEPTIONS)
        (True, False, 'false with exceptions')
    """

    AS_PRINTED = "right as printed"
    MISPRINT = "misprint"
    HYPOTHESIS = "needs a hypothesis"
    EXCEPTIONS = "false with exceptions"
    FALSE = "false"
    CONTRADICTED = "contradicted by computation"
    SETTLED = "settled here"
    REMARK = "remark"

    @property
    def meaning(self) -> str:
        """Return what the word means."""
        return _MEANINGS[self]

    @property
    def is_erratum(self) -> bool:
        """Return whether the statement needs a correction; its finding then shows that the printed one fails."""
        return self in {Verdict.MISPRINT, Verdict.HYPOTHESIS, Verdict.EXCEPTIONS, Verdict.FALSE, Verdict.CONTRADICTED}


_MEANINGS = {
    Verdict.AS_PRINTED: "the statement holds as it stands",
    Verdict.MISPRINT: "a slip in a formula or a word; what was meant is right",
    Verdict.HYPOTHESIS: "false as it stands; it holds under a condition that is left out, and is named",
    Verdict.EXCEPTIONS: "false as it stands, but only for special bodies or sets, which are named",
    Verdict.FALSE: "a counterexample or the definition shows that it does not hold",
    Verdict.CONTRADICTED: "numbers speak against it; this is evidence and no proof",
    Verdict.SETTLED: "a question that the paper leaves open is answered",
    Verdict.REMARK: "no error: something is added or made precise",
}
