"""How results are printed."""

import numpy as np
import pytest

import nonholo as nh

TOP = nh.SuslovTop(np.diag([1.0, 2.0, 3.0]) + 0.1)
DISCRETE = nh.discretize(TOP, 0.1)
ORBIT = nh.simulate(DISCRETE, restricted_velocity=[0.3, 0.4], steps=20)
BOARD = nh.examples.snakeboard()
RESULTS = {
    "steps: 20": lambda: nh.invariants(ORBIT),
    "outcome: successful": lambda: nh.invariants(ORBIT),
    "points: 5 of CriticalPoint": lambda: nh.critical_energies(DISCRETE),
    "energy: 0.3": lambda: nh.invariant_curve(DISCRETE, 0.3),
    "points: shape (80, 161, 3)": lambda: nh.momentum_locus(DISCRETE),
    "spatial: []": lambda: nh.conserved_momenta(TOP),
    "growth: (3, 4, 5)": lambda: nh.accessibility(BOARD.system, BOARD.configuration),
    "motion: Discretization(system=SuslovTop(axis=[0.0, 0.0, 1.0],": lambda: nh.invariant_measure(DISCRETE),
    "attracting: [ 0.1 -0.1 -0. ]": TOP.equilibria,
    "certified: False": lambda: nh.branch_growth(nh.discretize(nh.ChaplyginSleigh(1, 0.5, 0.3), 0.1)),
}


@pytest.mark.parametrize("line", RESULTS)
def test_a_result_is_printed_as_a_short_table(line: str) -> None:
    """Its name, and a line for each value."""
    found = RESULTS[line]()
    lines = repr(found).splitlines()
    assert lines[0] == type(found).__name__
    assert any(each.strip().startswith(line) for each in lines)
    assert len(lines) < 25
    assert all(len(each) <= 140 for each in lines)
