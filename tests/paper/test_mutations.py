"""Findings can fail: with one sign or factor of a formula changed, one of them turns red."""

import random
from types import ModuleType

import pytest
from paper.mutations import Mutant, all_mutants, functions, modules, survives, unchanged, users

SAMPLE = 40  # of all mutants; `python tests/paper/mutations.py` tries every one


def sample() -> list[Mutant]:
    """Return a part of the mutants, the same in every run."""
    known = all_mutants()
    return random.Random(5).sample(known, min(SAMPLE, len(known)))  # noqa: S311 (a choice of tests)


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
