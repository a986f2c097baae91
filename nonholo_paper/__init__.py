"""The paper, recomputed: every numbered statement and every figure, with the measured value beside the claim.

A product about the library, and a user of it: nothing in `nonholo` needs it but the command `nonholo paper`. Findings
stand in `statements` and `figures`, their words in claims/, their formulas in `formulas`, definitions in 50 digits in
`_twin`.
"""

from nonholo_paper._checklist import Section, sections
from nonholo_paper._finding import Finding, Measured, finding
from nonholo_paper._folder import check_folder, write_folder
from nonholo_paper._registry import Entry, entries, select
from nonholo_paper._run import Result, evaluate_all
from nonholo_paper._verdict import Verdict

__all__ = [
    "Entry",
    "Finding",
    "Measured",
    "Result",
    "Section",
    "Verdict",
    "check_folder",
    "entries",
    "evaluate_all",
    "finding",
    "sections",
    "select",
    "write_folder",
]
