"""The core without any extra: what works, what names its extra, what a run loads; how short a warm call is."""

import itertools
import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from types import FrameType
from typing import Any

import jax.numpy as jnp
import pytest
from matrix.alone import ALONE

import nonholo as nh
from nonholo.base.compiled import first_way

PROGRAM = Path(__file__).parent / "without_extras.py"
SLEIGH = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1)
WITHOUT_HOME = {"GroupLagrangeDAlembert", "LagrangeDAlembert", "allow_float32", "examples", "mass_tensor_lagrangian"}
ON_REQUEST = {"dask", "diffrax", "jax", "matplotlib"}  # which nothing loads that does not ask for it
HEAVY = ON_REQUEST | {"equinox", "numba", "pandas", "pydantic", "scipy.sparse", "xarray", "zarr"}


def _run(*arguments: str, folder: Path | None = None) -> subprocess.CompletedProcess:
    command = [sys.executable, str(PROGRAM), *arguments]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True)  # noqa: S603


def _printed(*arguments: str) -> Any:
    done = _run(*arguments)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def test_kernels_of_each_kind_of_motion() -> None:
    """They run from the library, also with rows of a parameter, or as the page "What works with what" says."""
    if first_way() != "library":
        pytest.skip("kernels run by another way")
    assert _printed("ways") == ALONE
    assert _printed("numbers") == ["library"]


CERTIFIED = dict.fromkeys(("branch_growth [certified]", "branches [certified]"), "certify")
ON_JAX = ("consistency_defect", "critical_values", "equilibria [near]", "fit", "linearize", "rollout", "steer", "step")
ASKING = dict.fromkeys((*ON_JAX, "step [flat]", "tracking_feedback"), "jax") | {"steer [ipopt]": "steer"} | CERTIFIED


@pytest.mark.profile("faults", keep=["quick*"])
@pytest.mark.parametrize(("which", "arguments"), [("quick", CERTIFIED), ("all", ASKING)])
def test_calls_that_need_an_extra(which: str, arguments: dict[str, str]) -> None:
    """Each public name is there without extras, or asks for JAX; each call works, or asks for the extra it needs."""
    assert _printed("calls", which) == [dict.fromkeys(WITHOUT_HOME | {"rollout", "step"}, "jax"), arguments]


COMMANDS = [
    "simulate sleigh", "simulate suslov", "simulate veselova", "simulate left_invariant", "info sleigh.zarr",
    "plot sleigh.zarr -o picture.png", "export sleigh.zarr -o poses.csv",
    "explore sleigh.zarr -o page.html --no-browser", "extend sleigh.zarr --steps 60", "resume sleigh.zarr",
    "sweep SWEEP --members 20", "dataset sleigh -o sleighs --orbits 5 --steps 5", "new sleigh", "systems", "cite",
]  # fmt: skip


@pytest.mark.profile("faults", instead="test_commands_that_need_an_extra")
def test_commands_work(tmp_path: Path) -> None:
    """Every command but `paper` and `examples` does its work without extras."""
    sweep = str(PROGRAM.parents[1] / "scenarios" / "sleigh_turning_sweep.toml")
    store = tmp_path / "sleigh.zarr"
    nh.simulate(SLEIGH, body_velocity=(0.1, -1.0, 0.0), steps=50, store=store, checkpoint_every=20)
    for command in COMMANDS:
        done = _run("command", *command.replace("SWEEP", sweep).split(), folder=tmp_path)
        assert done.returncode == 0, f"{command}: {done.stdout}{done.stderr}"


@pytest.mark.profile("faults", keep=["paper"])
@pytest.mark.parametrize(
    ("command", "extra"),
    [("paper", "paper"), ("examples", "jax"), ('simulate sleigh --set run.difference="logarithmic"', "jax")],
    ids=["paper", "examples", "logarithmic difference"],
)
def test_commands_that_need_an_extra(command: str, extra: str, tmp_path: Path) -> None:
    """A command that needs an extra says so in a sentence and does nothing."""
    done = _run("command", *command.split(), folder=tmp_path)
    assert done.returncode == 2
    assert "Traceback" not in done.stderr
    assert f"pip install 'nonholo[{extra}]'" in " ".join(done.stderr.split())
    assert not list(tmp_path.rglob("*.zarr"))


RUN = "o = nh.simulate(nh.discretize(sleigh, 0.1), body_velocity=(1, 0, 0), steps=9)"
FLOW = "o = nh.flow(sleigh, body_velocity=(1, 0, 0), times=(0, 1))"
SWEEP = f"nh.Grid({{'a': [1.0]}}); nh.sweep; {RUN}; nh.invariants(o)"


@pytest.mark.profile("faults", keep=["simulate", "flow"])
@pytest.mark.parametrize(
    ("run", "heavy"),
    [(RUN, HEAVY), (FLOW, HEAVY), (SWEEP, ON_REQUEST)],
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


_FILES, _CHANGES, _IN_COORDINATES, _SHARED = 16, 28, 17, 10
"""The first three may only fall."""
_LIBRARY = Path(nh.__file__).parent


def _entered(call: Callable[[], Any]) -> list[Path]:
    """Return the files of the library that a warm call enters, in order."""
    call()
    entered: list[Path] = []

    def look(frame: FrameType, event: str, _: Any) -> None:
        file = Path(frame.f_code.co_filename)
        if event == "call" and file.is_relative_to(_LIBRARY):
            entered.append(file.relative_to(_LIBRARY))

    before = sys.getprofile()
    sys.setprofile(look)
    try:
        call()
    finally:
        sys.setprofile(before)
    return entered


def _of_a_sleigh() -> list[Path]:
    return _entered(lambda: nh.simulate(SLEIGH, restricted_velocity=(0.3, 0.4), steps=10))


def _forms(q: Any) -> Any:
    return jnp.array([[-jnp.sin(q[2]), jnp.cos(q[2]), 0.0]])


def test_a_call_for_a_body_is_short() -> None:
    """A room is the first folder of the library; every return to one counts."""
    entered = _of_a_sleigh()
    changes = sum(a.parts[0] != b.parts[0] for a, b in itertools.pairwise(entered))
    assert len(set(entered)) <= _FILES
    assert changes <= _CHANGES


def test_a_call_in_coordinates_shares_its_files() -> None:
    """The same run in coordinates is the same call, with other equations."""
    discrete = nh.discretize(nh.LagrangeDAlembert(lambda _, v: v @ v / 2, _forms, dimension=3), 0.1)
    velocity: dict[str, Any] = {"configuration": (0.0, 0.0, 0.0), "body_velocity": (1.0, 0.0, 0.3)}
    entered = set(_entered(lambda: nh.simulate(discrete, steps=10, **velocity)))
    assert len(entered) <= _IN_COORDINATES
    assert len(entered & set(_of_a_sleigh())) >= _SHARED
