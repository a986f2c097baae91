"""The scripts of `benchmarks/`: each runs to its end on small numbers, and they know the library by one door."""

import os
import re
import subprocess
import sys

import numpy as np
import pytest
from scripts import ROOT, script

import nonholo as nh

FOLDER = ROOT / "benchmarks"
SCRIPTS = sorted(path.stem for path in FOLDER.glob("*.py") if not path.stem.startswith("_"))
INSIDE = script("benchmarks/_inside.py")
LEFT_OUT = script("benchmarks/_command.py").LEFT_OUT


@pytest.mark.profile("benchmarks", instead="test_what_scripts_measure_is_there")
@pytest.mark.parametrize("name", SCRIPTS)
def test_a_smoke_run_comes_to_its_end(name: str) -> None:
    """All checks of a script hold; one that misses a library or a device says which."""
    environment = os.environ | {"PYTHONPATH": os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])}
    command = [sys.executable, FOLDER / f"{name}.py", "--smoke"]
    done = subprocess.run(command, capture_output=True, text=True, check=False, env=environment)  # noqa: S603
    if done.returncode == LEFT_OUT:
        pytest.skip(done.stdout.strip().splitlines()[-1])
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.parametrize("name", INSIDE.HOMES)
def test_what_scripts_measure_is_there(name: str) -> None:
    """Every private part that a script measures has the name and the place that it had."""
    assert getattr(INSIDE, name) is not None


def test_the_integration_of_a_flow_is_that_of_the_call() -> None:
    """What is timed as the integration alone ends where `nh.flow` does, to the bit."""
    sleigh, start, times = nh.ChaplyginSleigh(1.0, 1.0, 0.5), {"body_velocity": (1.0, -0.3, 0.0)}, np.array([0.0, 3.0])
    solved = INSIDE.integration(sleigh, times, 1e-14, **start)()
    assert np.array_equal(solved.states.momenta, nh.flow(sleigh, times=times, **start).reduced_momentum)


@pytest.mark.parametrize("path", sorted(FOLDER.rglob("*.py")), ids=lambda path: path.stem)
def test_private_parts_have_one_door(path) -> None:  # noqa: ANN001
    """Only `_inside` imports anything else than `nonholo`: a change inside is followed in one place."""
    imported = re.findall(r"^\s*(?:import|from) (nonholo\S*)", path.read_text(), re.MULTILINE)
    assert path.stem == "_inside" or set(imported) <= {"nonholo"}


def test_every_script_has_its_line() -> None:
    """The pages list each script: docs/benchmarks.md with the command, and the folder's own page."""
    page, readme = (ROOT / "docs" / "benchmarks.md").read_text(), (FOLDER / "README.md").read_text()
    repeat = page[page.index("## Repeat") :]
    assert [name for name in SCRIPTS if f"`{name}.py" not in repeat] == []
    assert [name for name in SCRIPTS if f"`{name}.py`" not in readme] == []
