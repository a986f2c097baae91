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
top = nh.VeselovaTop(np.diag([1.0, 2.0, 3.0]))
start = dict(restricted_velocity=(0.3, 0.2))
four = dict(restricted_velocity=(0.3, 0.2, 0.1, 0.1))
aside = dict(configuration=np.array([[1.0, 0, 0], [0, 1, 1], [0, 0, 1]]))
def task(block):
    return {'y': np.ones(len(block['x']))}
def design(n):
    return nh.RandomDesign(n, {'x': nh.Uniform(0, 1)})
def begin(call, short, long):
    call(short)
    print("begun", flush=True)
    try:
        call(long)
        print("over", flush=True)
    finally:
        print(f"processor {time.process_time()}", file=sys.stderr, flush=True)
"""
CALLS = {  # of n, and a short and a long one
    "simulate": "nh.simulate(sleigh, **start, steps=n, save_every=1000), 1000, 10**10",
    "simulate, general": "nh.simulate(general, **four, steps=n, save_every=1000), 1000, 10**9",
    "ensemble": "nh.ensemble(sleigh, restricted_velocity=np.full((64, 2), 0.2), steps=n), 10, 10**9",
    "ensemble, general": "nh.ensemble(general, restricted_velocity=np.full((8, 4), 0.2), steps=n), 10, 10**9",
    "iterate": "[len(o) for o in nh.iterate(sleigh, **start, steps=n)], 1000, 10**10",
    "branch rule": "nh.simulate(sleigh, **start, steps=n, branch='nearest', save_every=1000), 1000, 10**8",
    "sweep": "n and nh.sweep(task, design(n), 'run.zarr', 'synchronous', block=10), 0, 10**7",
    "flow": "nh.flow(top, times=np.linspace(0.0, 0.1 * n, n), **start), 3, 10**7",
    "flow, long": "nh.flow(top, times=(0.0, n), **start), 1.0, 1e9",
    "rollout": "nh.rollout(sleigh, steps=n, save_every=n, **start), 10, 10**9",
    "steer": "nh.steer(sleigh, {}, aside, steps=n), 4, 10**5",
    "steer, ipopt": "nh.steer(sleigh, {}, aside, steps=n, method='ipopt'), 4, 3000",
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
    command = [sys.executable, "-c", f"{HEAD}begin(lambda n: {CALLS[call]})"]
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
