"""Ctrl-C in every long call: a child gets SIGINT in the midst of its work, and ends within two seconds.

They are seconds of its processors: others may be at work on the machine.
"""

import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

HEAD = """
import signal, sys, time
signal.signal(signal.SIGINT, signal.default_int_handler)
import numpy as np, nonholo as nh
sleigh = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1)
general = nh.discretize(nh.LLSystem(nh.SO(4), np.diag([1.0, 2.0, 3.0, 4.0]), np.eye(6)[:4]), 0.1)
start = dict(restricted_velocity=(0.3, 0.2))
def begin(short, long):
    short()
    print("begun", flush=True)
    try:
        long()
        print("over", flush=True)
    finally:
        print(f"processor {time.process_time()}", file=sys.stderr, flush=True)
"""
CALLS = {
    "simulate": "begin(*(lambda n=n: nh.simulate(sleigh, **start, steps=n, save_every=1000) for n in (1000, 10**10)))",
    "simulate, general": (
        "v = dict(restricted_velocity=(0.3, 0.2, 0.1, 0.1))\n"
        "begin(*(lambda n=n: nh.simulate(general, **v, steps=n, save_every=1000) for n in (1000, 10**9)))"
    ),
    "ensemble": (
        "v = np.full((64, 2), 0.2)\n"
        "begin(*(lambda n=n: nh.ensemble(sleigh, restricted_velocity=v, steps=n) for n in (10, 10**9)))"
    ),
    "ensemble, general": (
        "v = np.full((8, 4), 0.2)\n"
        "begin(*(lambda n=n: nh.ensemble(general, restricted_velocity=v, steps=n) for n in (10, 10**9)))"
    ),
    "iterate": "begin(*(lambda n=n: [len(o) for o in nh.iterate(sleigh, **start, steps=n)] for n in (10, 10**10)))",
    "branch rule": (
        "begin(*(lambda n=n: nh.simulate(sleigh, **start, steps=n, branch='nearest', save_every=1000) "
        "for n in (1000, 10**8)))"
    ),
    "sweep": (
        "def task(block):\n    return {'y': np.ones(len(block['x']))}\n"
        "design = lambda n: nh.RandomDesign(n, {'x': nh.Uniform(0, 1)})\n"
        "begin(lambda: None, lambda: nh.sweep(task, design(10**7), 'run.zarr', 'synchronous', block=10))"
    ),
    "flow": (
        "top = nh.VeselovaTop(np.diag([1.0, 2.0, 3.0]))\n"
        "times = lambda n: np.linspace(0.0, 0.1 * n, n)\n"
        "begin(*(lambda n=n: nh.flow(top, times=times(n), restricted_velocity=(0.3, 0.2)) for n in (3, 10**7)))"
    ),
    "flow, long": (
        "top = nh.VeselovaTop(np.diag([1.0, 2.0, 3.0]))\n"
        "begin(*(lambda end=end: nh.flow(top, times=(0.0, end), restricted_velocity=(0.3, 0.2)) for end in (1.0, 1e9)))"
    ),
    "rollout": "begin(*(lambda n=n: nh.rollout(sleigh, steps=n, save_every=n, **start) for n in (10, 10**9)))",
    "steer": (
        "aside = {'configuration': np.array([[1.0, 0, 0], [0, 1, 1], [0, 0, 1]])}\n"
        "begin(*(lambda n=n: nh.steer(sleigh, {}, aside, steps=n) for n in (4, 10**5)))"
    ),
    "steer, ipopt": (
        "aside = {'configuration': np.array([[1.0, 0, 0], [0, 1, 1], [0, 0, 1]])}\n"
        "begin(*(lambda n=n: nh.steer(sleigh, {}, aside, steps=n, method='ipopt') for n in (4, 3000)))"
    ),
}


def processor_time(process: int) -> float:
    """Return the seconds that a process has had of the processors."""
    fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="processor times of other processes are read there")
@pytest.mark.profile("faults", keep=["simulate"])
@pytest.mark.parametrize("call", CALLS)
def test_ctrl_c(call: str, tmp_path) -> None:  # noqa: ANN001
    """The call raises `KeyboardInterrupt` after two seconds of the processor at most."""
    command = [sys.executable, "-c", HEAD + CALLS[call]]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True, "cwd": tmp_path}
    with subprocess.Popen(command, **pipes) as child:  # noqa: S603
        try:
            assert child.stdout is not None
            begun = child.stdout.readline()
            time.sleep(0.5)
            before = processor_time(child.pid)
            child.send_signal(signal.SIGINT)
            _, complaint = child.communicate(timeout=60)
        finally:
            child.kill()
    assert begun == "begun\n", complaint
    assert "KeyboardInterrupt" in complaint
    (at_end,) = re.findall(r"processor (\S+)", complaint)
    assert float(at_end) - before < 2.0
