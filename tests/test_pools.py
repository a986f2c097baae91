"""Processes of others: a run that folds does not hold up a pool, JAX in a forked child says so."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import nonholo as nh
from nonholo.base.numerics import _double_precision

pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="forks")


def lines_of(name: str) -> list[str]:
    """Run the program, which forks, in a process without threads; fail if it hangs."""
    command = [sys.executable, str(Path(__file__).with_name("pools.py")), name]
    done = subprocess.run(command, capture_output=True, text=True, check=True, timeout=120)  # noqa: S603
    return done.stdout.splitlines()


@pytest.mark.profile("faults", keep=["executor"])
@pytest.mark.parametrize("pool", ["executor", "pool"])
def test_a_fold_does_not_hang_a_pool(pool: str) -> None:
    """The run that folds comes back as an `OutcomeError`, the others as what they are."""
    lines = lines_of(pool)
    failures = [line for line in lines if line.startswith("OutcomeError")]
    energies = [line for line in lines if line not in failures]
    assert len(failures) == 1
    assert "no_real_branch" in failures[0]
    assert [float(energy) > 0 for energy in energies] == [True, True]


def test_jax_after_a_fork(monkeypatch: pytest.MonkeyPatch) -> None:
    """What needs JAX refuses where it would wait forever, in words."""
    monkeypatch.setattr(_double_precision, "_orphaned", True)
    sleigh = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1)
    with pytest.raises(RuntimeError, match="forked from one that had used JAX"):
        nh.step(sleigh, np.array([0.1, 0.1]))
    with pytest.raises(RuntimeError, match="forked"):
        nh.flow(
            nh.VeselovaTop(np.diag([1.0, 2.0, 3.0])), times=[0, 1], restricted_velocity=(0.1, 0.1), method="diffrax"
        )


@pytest.mark.profile("faults", instead="test_jax_after_a_fork")
def test_jax_in_a_forked_child() -> None:
    """What needs JAX refuses where it would wait forever, in words; compiled runs continue."""
    said, energy = lines_of("jax")
    assert "forked from one that had used JAX" in said
    assert "spawn" in said
    assert float(energy) > 0
