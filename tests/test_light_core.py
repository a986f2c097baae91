"""The core without any extra: what works, what names its extra, and what a run loads."""

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from matrix.alone import ALONE

import nonholo as nh
from nonholo.base.compiled import first_way

PROGRAM = Path(__file__).parent / "without_extras.py"
WITHOUT_HOME = {"GroupLagrangeDAlembert", "LagrangeDAlembert", "allow_float32", "examples", "mass_tensor_lagrangian"}
HEAVY = {"dask", "diffrax", "equinox", "jax", "matplotlib", "pandas", "pydantic", "xarray", "zarr"}


def _run(*arguments: str, folder: Path | None = None) -> subprocess.CompletedProcess:
    command = [sys.executable, str(PROGRAM), *arguments]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True)  # noqa: S603


def _printed(*arguments: str) -> Any:
    done = _run(*arguments)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def test_kernels_of_each_kind_of_motion() -> None:
    """They run from the library, or as the page "What works with what" says."""
    if first_way() != "library":
        pytest.skip("kernels run by another way")
    assert _printed("ways") == ALONE


CERTIFIED = dict.fromkeys(("branch_growth [certified]", "branches [certified]"), "certify")
ON_JAX = dict.fromkeys(
    ("consistency_defect", "critical_values", "equilibria [near]", "fit", "linearize", "rollout", "steer", "step"),
    "jax",
)
ON_JAX |= {"step": "jax", "step [flat]": "jax", "tracking_feedback": "jax", "steer [ipopt]": "steer"}


@pytest.mark.profile("faults", keep=["quick*"])
@pytest.mark.parametrize(("which", "asked"), [("quick", CERTIFIED), ("all", {**CERTIFIED, **ON_JAX})])
def test_calls_that_need_an_extra(which: str, asked: dict[str, str]) -> None:
    """Each public name is there without extras, or asks for JAX; each call works, or asks for the extra it needs."""
    assert _printed("calls", which) == [dict.fromkeys(WITHOUT_HOME | {"rollout", "step"}, "jax"), asked]


COMMANDS = [
    "simulate sleigh",
    "simulate suslov",
    "simulate veselova",
    "simulate left_invariant",
    "info sleigh.zarr",
    "plot sleigh.zarr -o picture.png",
    "export sleigh.zarr -o poses.csv",
    "explore sleigh.zarr -o page.html --no-browser",
    "extend sleigh.zarr --steps 60",
    "resume sleigh.zarr",
    "sweep SWEEP --members 20",
    "dataset sleigh -o sleighs --orbits 5 --steps 5",
    "new sleigh",
    "systems",
    "cite",
]


@pytest.mark.profile("faults", instead="test_commands_that_need_an_extra")
def test_commands_work(tmp_path: Path) -> None:
    """Every command but `paper` and `examples` does its work without extras."""
    sweep = str(PROGRAM.parents[1] / "scenarios" / "sleigh_turning_sweep.toml")
    sleigh, store = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1), tmp_path / "sleigh.zarr"
    nh.simulate(sleigh, body_velocity=(0.1, -1.0, 0.0), steps=50, store=store, checkpoint_every=20)
    for command in COMMANDS:
        done = _run("command", *command.replace("SWEEP", sweep).split(), folder=tmp_path)
        assert done.returncode == 0, f"{command}: {done.stdout}{done.stderr}"


@pytest.mark.profile("faults", keep=["paper"])
@pytest.mark.parametrize(
    ("command", "extra"),
    [
        (["paper"], "paper"),
        (["examples"], "jax"),
        (["simulate", "sleigh", "--set", 'run.difference="logarithmic"'], "jax"),
    ],
    ids=["paper", "examples", "logarithmic difference"],
)
def test_commands_that_need_an_extra(command: list[str], extra: str, tmp_path: Path) -> None:
    """A command that needs an extra says so in a sentence and does nothing."""
    done = _run("command", *command, folder=tmp_path)
    assert done.returncode == 2
    assert "Traceback" not in done.stderr
    assert f"pip install 'nonholo[{extra}]'" in " ".join(done.stderr.split())
    assert not list(tmp_path.rglob("*.zarr"))


RUN = "o = nh.simulate(nh.discretize(sleigh, 0.1), body_velocity=(1, 0, 0), steps=9)"


@pytest.mark.profile("faults", keep=["simulate", "flow"])
@pytest.mark.parametrize(
    ("run", "heavy"),
    [
        (RUN, {*HEAVY, "numba", "scipy.sparse"}),
        ("o = nh.flow(sleigh, body_velocity=(1, 0, 0), times=(0, 1))", {*HEAVY, "numba", "scipy.sparse"}),
        (f"nh.Grid({{'a': [1.0]}}); nh.sweep; {RUN}; nh.invariants(o)", {"dask", "diffrax", "jax", "matplotlib"}),
    ],
    ids=["simulate", "flow", "sweep"],
)
def test_a_run_loads_nothing_that_it_does_not_use(run: str, heavy: set[str]) -> None:
    """A run loads neither JAX, numba and sparse matrices nor what makes datasets, stores, pictures and scenarios."""
    program = f"import sys, nonholo as nh; sleigh = nh.ChaplyginSleigh(1.0, 1.0, 0.5); {run}; o.momentum, o.heading;"
    program += f"print(sorted({heavy} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)  # noqa: S603
    assert done.stdout.strip() == "[]"


def test_every_name_of_the_store_room_has_a_home() -> None:
    """The names of `nonholo.io`, which load on first use, are there; others are refused as in any module."""
    assert all(getattr(nh.io, name) is not None for name in nh.io.__all__)
    with pytest.raises(AttributeError, match=r"No nonholo.io attribute storre"):
        _ = nh.io.storre
