"""The zoo is what it says it is, and the package keeps its promises about names."""

import inspect
import pathlib

import numpy as np
import pytest
from problems import PROBLEMS, Problem

import nonholo as nh


@pytest.mark.parametrize("problem", PROBLEMS, ids=lambda p: p.name)
def test_tags_are_true(problem: Problem) -> None:
    """Balanced problems have no coupling, flat ones a singular mass tensor, irregular ones D <= 2 |c|^2."""
    system = problem.system.canonical
    coupling = system.coupling if isinstance(system, nh.SuslovTop) else system.a
    assert ("balanced" in problem.tags) == (not np.any(coupling))
    if isinstance(system, nh.SuslovTop):
        assert ("flat" in problem.tags) == (abs(np.linalg.det(system.mass_tensor)) < 1e-12)
        regular = np.linalg.det(system.constrained_inertia) > 2 * coupling @ coupling
        assert ("irregular" in problem.tags) == (not regular)


def test_no_module_shadows_a_public_name() -> None:
    """A room or module directly under the package with a public function's name would replace it on import."""
    modules = {path.stem for path in pathlib.Path(nh.__file__).parent.iterdir()}
    functions = {name for name in dir(nh) if not inspect.ismodule(getattr(nh, name))}
    assert not modules & functions


@pytest.mark.parametrize("name", dir(nh))
def test_every_public_name_has_an_example(name: str) -> None:
    """Each public name resolves and its docstring holds a doctest."""
    thing = getattr(nh, name)
    if not inspect.ismodule(thing):
        assert ">>>" in (thing.__doc__ or ""), name


def test_unknown_names_are_refused() -> None:
    """A misspelt name is an AttributeError as in any module."""
    with pytest.raises(AttributeError, match="no attribute 'symulate'"):
        _ = nh.symulate
