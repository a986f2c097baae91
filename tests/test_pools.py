"""Processes of others: a run that folds does not hold up a pool, JAX in a forked child says so."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import nonholo as nh
from nonholo.base.numerics import _double_precision

pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="forks")


def lines_of(name: str, body: str = "sleigh") -> list[str]:
    """Run the program, which forks, in a process without threads; if it hangs, fail with where each process stood."""
    command = [sys.executable, "-X", "faulthandler", str(Path(__file__).with_name("pools.py")), name, body]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    with subprocess.Popen(command, start_new_session=True, **pipes) as program:  # noqa: S603
        try:
            printed, said = program.communicate(timeout=120)
        except subprocess.TimeoutExpired:
            os.killpg(program.pid, signal.SIGABRT)  # its forked children too: they hold the pipes
            printed, said = program.communicate()
    assert program.returncode == 0, said
    return printed.splitlines()


@pytest.mark.profile("faults", keep=["executor-top"])
@pytest.mark.parametrize("body", ["sleigh", "top"])
@pytest.mark.parametrize("pool", ["executor", "pool"])
def test_a_fold_does_not_hang_a_pool(pool: str, body: str) -> None:
    """The run that folds comes back as an `OutcomeError` with its orbit, the others as orbits."""
    lines = lines_of(pool, body)
    failures = [line for line in lines if line.startswith("OutcomeError")]
    energies = [line for line in lines if line not in failures]
    assert len(failures) == 1
    assert "no_real_branch" in failures[0]
    assert [float(energy) > 0 for energy in energies] == [True, True]


def test_jax_after_a_fork(monkeypatch: pytest.MonkeyPatch) -> None:
    """What needs JAX refuses where it would wait forever, in words."""
    monkeypatch.setattr(_double_precision, "_is_orphan", True)
    sleigh = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1)
    with pytest.raises(RuntimeError, match="forked from one that had used JAX"):
        nh.step(sleigh, np.array([0.1, 0.1]))
    top = nh.VeselovaTop(np.diag([1.0, 2.0, 3.0]))
    with pytest.raises(RuntimeError, match="forked"):
        nh.flow(top, times=[0, 1], restricted_velocity=(0.1, 0.1), method="diffrax")


@pytest.mark.profile("faults", instead="test_jax_after_a_fork")
def test_jax_in_a_forked_child() -> None:
    """What needs JAX refuses where it would wait forever, in words; compiled runs continue."""
    said, energy = lines_of("jax")
    assert "forked from one that had used JAX" in said
    assert "spawn" in said
    assert float(energy) > 0
