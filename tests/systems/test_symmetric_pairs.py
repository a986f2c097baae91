"""Symmetric pairs: a found subalgebra satisfies the three inclusions, and where there is none the answer is no."""

import numpy as np
import pytest
from groups.examples import HEISENBERG
from refusals import refusals

import nonholo as nh
from nonholo.groups import AbstractMatrixGroup, MatrixGroup
from nonholo.systems import SuslovTop, is_symmetric_pair, reference_point_subspace, symmetric_complement

_E3, _E6 = np.eye(3), np.eye(6)
_SLEIGH = [[0, 0, -1, 0, 0, 0], [0, 1, 0, 0, 0, 0], [0, 0, 0, 1, 0, 0]]


def _turned(group: AbstractMatrixGroup, rows: object) -> np.ndarray:
    """The same subspace seen from another frame, with its rows mixed."""
    rng = np.random.default_rng(2)
    rows = np.asarray(rows, dtype=float)
    return rng.normal(size=(len(rows), len(rows))) @ rows @ group.adjoint(group.random(rng)).T


_SCREWS = MatrixGroup(nh.SE(3).basis + np.concatenate([nh.SE(3).basis[3:], 0 * nh.SE(3).basis[3:]]))

PAIRS = {
    "top": (nh.SO(3), SuslovTop(np.eye(3)).constraint_subspace),
    "top in five dimensions": (nh.SO(5), SuslovTop(np.eye(5)).constraint_subspace),
    "SO(4) over SO(2) x SO(2)": (nh.SO(4), _E6[1:5]),
    "sleigh": (nh.SE(2), _E3[:2]),
    "sleigh in space": (nh.SE(3), _SLEIGH),
    "translations": (nh.SE(3), _E6[3:]),
    "translations beside screws": (_SCREWS, _E6[3:]),  # the coordinate complement is no subalgebra
    "Heisenberg, horizontal": (HEISENBERG, _E3[:2]),
    "Heisenberg, an ideal": (HEISENBERG, _E3[1:]),
    "no motion": (nh.SE(3), np.empty((0, 6))),
}
OTHERS = {
    "one axis": (nh.SO(3), _E3[:1]),
    "everything": (nh.SO(3), _E3),
    "all rotations": (nh.SE(3), _E6[:3]),
    "one translation": (nh.SE(2), _E3[1:2]),
    "knife edge that may turn about every axis": (nh.SE(3), reference_point_subspace(3, [[1, 0, 0]])),
    "sleigh without its runner": (nh.SE(3), _SLEIGH[:2]),
    "center of the Heisenberg algebra": (HEISENBERG, _E3[2:]),  # normal, but without a complementary subalgebra
    "random": (nh.SO(4), np.random.default_rng(0).normal(size=(3, 6))),
}


@pytest.mark.parametrize("name", PAIRS)
def test_complement_by_its_definition(name: str) -> None:
    """The algebra is h + d, [h, h] in h, [h, d] in d, [d, d] in h, in the user's frame and in any other."""
    group, rows = PAIRS[name]
    for d in (np.asarray(rows, dtype=float), _turned(group, rows)):
        h = symmetric_complement(group, d)
        assert h is not None
        assert np.linalg.matrix_rank(np.concatenate([h, d])) == len(h) + len(d) == group.dim
        assert _outside(group, h, h, h) < 1e-11
        assert _outside(group, h, d, d) < 1e-11
        assert _outside(group, d, d, h) < 1e-11


def _outside(group: AbstractMatrixGroup, x: np.ndarray, y: np.ndarray, space: np.ndarray) -> float:
    """The largest part of a bracket outside a space, for rows of the size that `_turned` makes (below 10)."""
    brackets = group.bracket(x[:, None], y[None, :])
    return float(np.abs(brackets - brackets @ np.linalg.pinv(space) @ space).max(initial=0.0))


@pytest.mark.parametrize("name", OTHERS)
def test_no_complement(name: str) -> None:
    """Subspaces without a symmetric pair are refused in every frame."""
    group, rows = OTHERS[name]
    assert not is_symmetric_pair(group, rows)
    assert not is_symmetric_pair(group, _turned(group, rows))


test_what_is_no_subspace_of_a_group_is_refused = refusals(
    (lambda: is_symmetric_pair(nh.SO(3), np.eye(2)), r"constraint_subspace=\.\.\.\)` must have shape \(any, 3\)"),
    (lambda: is_symmetric_pair("SO(3)", np.eye(3)), r"group=\.\.\.\)` must be a matrix group. Got 'SO\(3\)'"),
    begin=r"is_symmetric_pair\(",
)
