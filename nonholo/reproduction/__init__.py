"""The paper, recomputed: every numbered statement and every figure, with the measured value beside the claim.

Findings stand in `statements` and `figures`, the formulas that they compare in `formulas`, the definitions in 50 digits
in `_twin`. Nothing outside this room uses them, but the command `nonholo paper` and the tests.
"""
