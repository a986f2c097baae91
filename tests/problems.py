"""The zoo: systems with tags and admissible starts, and generators of random ones. Itself tested in test_problems."""

import dataclasses

import numpy as np
from bodies import GENERAL, OTHERS
from hypothesis import strategies as st

import nonholo as nh
from nonholo.systems import AbstractLLSystem, AbstractSystem


@dataclasses.dataclass(frozen=True)
class Problem:
    """A system, an admissible start and what is known of it."""

    name: str
    system: AbstractLLSystem
    restricted_velocity: tuple[float, float]
    tags: frozenset[str]


def _problem(name: str, system: AbstractLLSystem, velocity: tuple[float, float], *tags: str) -> Problem:
    return Problem(name, system, velocity, frozenset(tags))


_ROD = np.outer([1.0, 0.5, 0.4], [1.0, 0.5, 0.4]) + np.diag([0.01, 0.02, 0.0])
_AXIS = (2 / 3, -1 / 3, 2 / 3)
_INERTIA = [[3.0, 0.1, 0.2], [0.1, 2.0, 0.3], [0.2, 0.3, 2.5]]

PROBLEMS = [
    _problem("top", nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]]), (0.9, -0.4), "unbalanced"),
    _problem("tilted top", nh.SuslovTop.from_inertia(_INERTIA, _AXIS), (0.5, 0.6), "unbalanced"),
    _problem("c eigenvector", nh.SuslovTop([[1, 0, 0.4], [0, 1.5, 0], [0.4, 0, 0.8]]), (0.3, 0.7), "unbalanced"),
    _problem("balanced top", nh.SuslovTop(np.diag([1.0, 2.0, 3.0])), (0.5, -0.2), "balanced"),
    _problem("flat top", nh.SuslovTop([[1, 0.2, 0], [0.2, 2, 0], [0, 0, 0]]), (0.5, -0.2), "balanced", "flat"),
    _problem("rod", nh.SuslovTop(_ROD), (0.1, 0.3), "unbalanced", "irregular"),
    _problem("sleigh", nh.ChaplyginSleigh(1.0, 1.0, 0.5), (0.8, -0.5), "unbalanced"),
    _problem("offset sleigh", nh.ChaplyginSleigh(2.0, 1.0, 0.5, 0.3), (0.9, -0.4), "unbalanced"),
    _problem("backward sleigh", nh.ChaplyginSleigh(1.5, 0.7, -0.3, -1.0), (-0.6, 0.5), "unbalanced"),
    _problem("far offset sleigh", nh.ChaplyginSleigh(1.0, 1.0, 0.2, 20.0), (0.5, 9.0), "unbalanced"),
    _problem("balanced sleigh", nh.ChaplyginSleigh(1.0, 1.0, 0.0), (0.5, 0.7), "balanced"),
    _problem("sleigh on its normal", nh.ChaplyginSleigh(1.0, 1.0, 0.0, 0.5), (0.5, 0.7), "balanced"),
]

EVERY: dict[str, AbstractSystem] = {problem.name: problem.system for problem in PROBLEMS}
EVERY |= {name: system for name, (system, _) in GENERAL.items()} | OTHERS
"""One body of each kind that has a flow."""

_entry = st.floats(-1.0, 1.0)


@st.composite
def tops(draw: st.DrawFn) -> nh.SuslovTop:
    """Draw a physical top: a mass tensor of three mass points, kept away from a vanishing constrained inertia."""
    points = np.array(draw(st.lists(st.tuples(_entry, _entry, _entry), min_size=3, max_size=3)))
    return nh.SuslovTop(points.T @ points + 0.05 * np.diag([1.0, 1.0, 0.0]))


@st.composite
def sleighs(draw: st.DrawFn) -> nh.ChaplyginSleigh:
    """Draw a sleigh, balanced ones included."""
    mass, inertia = draw(st.floats(0.1, 3.0)), draw(st.floats(0.05, 3.0))
    offset = draw(st.sampled_from([0.0, 1.0])) * draw(_entry)
    return nh.ChaplyginSleigh(mass, inertia, offset, draw(st.floats(-2.0, 2.0)))


systems = st.one_of(tops(), sleighs())
velocities = st.tuples(_entry, _entry).map(np.array)
