"""The commands: what they keep, print, return and refuse, and how they write numbers."""

import json
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from commands import Command, Figures, assert_ends, assert_shows, json_of, words_of
from matplotlib.figure import Figure

import nonholo as nh
from nonholo.cli.commands import runs
from nonholo.cli.scenario.files import load_scenario
from nonholo.cli.screen.report import duration
from nonholo.simulation import _run


def test_json_is_all_that_is_printed(figures: Figures) -> None:
    """`--json` prints one object with the figures of the run and the path of its store."""
    report = figures("suslov")
    assert report["steps"] == 800
    assert report["outcome"] == "successful"
    for name in ("energy_drift", "constraint_residual", "group_residual", "reversal_defect"):
        assert 0 <= report[name] < 1e-14, name
    assert report["seconds_per_step"] > 0
    assert report["body"]["inertia_tensor"][2] == [-0.5, 0.3, 2.4]
    assert report["picture"] is None
    assert len(nh.load_orbit(report["store"])) == 801


@pytest.mark.parametrize("name", ["suslov", "sleigh"])
def test_built_in_scenarios_settle(name: str, figures: Figures) -> None:
    """The built-in motions go over from the repelling to the attracting steady motion."""
    orbit = nh.load_orbit(figures(name)["store"])
    attracting = orbit.system.equilibria().attracting
    along = orbit.body_velocity @ attracting / np.linalg.norm(orbit.body_velocity, axis=1) / np.linalg.norm(attracting)
    assert along[0] < -0.99
    assert along[-1] > 1 - 1e-6


def test_table(nonholo: Command) -> None:
    """Without `--json` a table shows the invariants, both tensors of the body, and where things are."""
    rows = ("time per step", "relative energy drift", "reversal defect", "largest step angle", "mass tensor J")
    others = ("inertia tensor", "runs/suslov-001.zarr", "800 of 800")
    assert_shows(nonholo("simulate", "suslov", "--no-plot"), *rows, *others)


@pytest.mark.profile("faults", instead="test_each_sweep_has_a_new_number")
@pytest.mark.parametrize("rows", [100, 10_000], ids=["several blocks", "one block"])
def test_runs_at_the_same_time_get_different_stores(rows: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Runs that begin and end together all keep their orbit."""
    monkeypatch.setattr(_run, "_ROWS", rows)
    loaded = load_scenario("sleigh", [])
    runs._check_output(None, overwrite=False, new=None)
    with ThreadPoolExecutor(4) as pool:
        ends = list(pool.map(lambda _: runs.run_and_keep(loaded, None, overwrite=False, progress=False), range(8)))
    assert len({store for store, _ in ends}) == 8
    assert all(len(nh.load_orbit(store)) == 1 + loaded.scenario.run.steps for store, _ in ends)
    assert len(list((tmp_path / "runs").iterdir())) == 8


def test_a_picture_of_an_older_run_is_told(nonholo: Command) -> None:
    """After --overwrite --no-plot a warning says that the picture beside the store is that of the run before."""
    nonholo("simulate", "suslov", "-o", "a.zarr", "--steps", 20)
    ended = nonholo("simulate", "suslov", "-o", "a.zarr", "--steps", 10, "--overwrite", "--no-plot")
    assert_ends(ended, 0, "'a.png' shows an older run")


def test_a_picture_of_the_user_is_not_overwritten(nonholo: Command) -> None:
    """A picture that exists where the run would draw is refused like a store."""
    Path("a.png").write_text("mine")
    assert nonholo("simulate", "sleigh", "-o", "a.zarr", "--steps", 3).exit_code == 2
    assert Path("a.png").read_text() == "mine"


def test_a_run_that_stops_keeps_its_good_steps(nonholo: Command) -> None:
    """A fold ends the run with exit code 1, the step reached and the reason, in JSON too; the good states are kept."""
    assert_ends(nonholo("simulate", "sleigh", "--no-plot", "--time-step", 1.3), 1, "Step 5 of 300", "no_real_branch")
    orbit = nh.load_orbit("runs/sleigh-001.zarr")
    assert (len(orbit), orbit.outcome) == (5, nh.Outcome.no_real_branch)
    report = json.loads(nonholo("simulate", "sleigh", "--no-plot", "--time-step", 1.3, "--json").stdout)
    assert report["steps"] == 4
    assert "Step 5 of 300" in report["stopped"]


def test_a_body_that_cannot_be_is_told_once(nonholo: Command) -> None:
    """The command says in its own words, and once, that there is no such body, and runs it."""
    body = "body={kind='suslov', inertia=[[5.0, 0, 0], [0, 3.1, 0], [0, 0, 1.5]]}"
    result = assert_ends(nonholo("simulate", "suslov", "--set", body, "--steps", 5, "--no-plot"), 0)
    assert result.stderr.count("its mass tensor has the eigenvalue -0.2") == 1
    assert "Warning: No distribution of mass has `SuslovTop.from_inertia(inertia=...)`" in result.stderr


def test_a_start_off_the_locus(nonholo: Command) -> None:
    """A full momentum that no displacement has is an outcome, not a crash."""
    assert_ends(nonholo("simulate", "sleigh", "--set", "start={momentum=[0.3, 1.0, 5.0]}"), 1, "off_momentum_locus")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--set", "start.body_velocity=[0,1,1]"], "start.body_velocity: must satisfy the constraint"),
        (["--set", "start.body_velocity=[0,1]"], "start.body_velocity: must have shape (3,)"),
        (["--set", "start.configuration=[[1,0,0],[0,2,0],[0,0,1]]"], "start.configuration: must lie in SE(2)"),
        (["--steps", 0], "--steps 0: run.steps: must be greater than 0"),
        (["--time-step", "nan"], "--time-step nan: run.time_step: must be a finite number"),
        (["--set", "body.mass"], "must be KEY=VALUE"),
        (["--set", 'run.branch="inner"'], "run.branch: must be a rule without regions"),
        (["-o", "mine.txt/a.zarr"], "The results cannot be kept in 'mine.txt', no writable folder."),
    ],
)
def test_usage_errors(arguments: list[Any], message: str, nonholo: Command) -> None:
    """Wrong input ends with exit code 2, a sentence with the key path, and nothing made."""
    Path("mine.txt").touch()
    assert_ends(nonholo("simulate", "sleigh", *arguments), 2, message)
    assert not list(Path("runs").iterdir()) if Path("runs").exists() else True


def test_options_reach_the_run(figures: Figures) -> None:
    """--steps, --time-step and --set, of the branch rule too, are in force and kept in the store."""
    settings = ("--set", "body.a=0.25", "--set", "run.save_every=2", "--set", 'run.branch="nearest"')
    orbit = nh.load_orbit(figures("sleigh", "--steps", 7, "--time-step", 0.05, *settings)["store"])
    assert (len(orbit), float(orbit.system.a), float(orbit.time[1]), orbit.branch) == (4, 0.25, 0.1, "nearest")


def test_a_failing_picture_does_not_cost_the_run(nonholo: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    """If drawing fails there is a warning, and the run is kept and successful."""

    def fail(_: object, path: str, **__: object) -> None:
        Path(path).write_text("half")
        raise RuntimeError("no ink")

    monkeypatch.setattr(Figure, "savefig", fail)
    assert_ends(nonholo("simulate", "suslov", "--steps", 5), 0, "no picture: RuntimeError: no ink")
    assert len(nh.load_orbit("runs/suslov-001.zarr")) == 6
    assert [path.name for path in Path("runs").iterdir()] == ["suslov-001.zarr"]


def test_animation(nonholo: Command) -> None:
    """--gif draws an animation beside the store."""
    result = assert_ends(nonholo("simulate", "sleigh", "--steps", 8, "--gif", "--no-plot"), 0)
    assert result.stderr == ""
    assert Path("runs/sleigh-001.gif").read_bytes().startswith(b"GIF89a")


def test_info_and_plot_of_a_flow(nonholo: Command) -> None:
    """Stores of continuous orbits are shown and drawn like others."""
    sleigh = nh.ChaplyginSleigh(1.0, 1.0, 0.5)
    nh.save_orbit(nh.flow(sleigh, body_velocity=(0.1, -1, 0), times=np.linspace(0, 9, 40)), "flow.zarr")
    assert_shows(nonholo("info", "flow.zarr"), "kind ContinuousFlow")
    assert nonholo("plot", "flow.zarr").exit_code == 0


def test_info(nonholo: Command) -> None:
    """`info` shows how a store was made and measures its invariants again, as a table and as JSON."""
    nonholo("simulate", "suslov", "--no-plot", "-o", "a.zarr", "--steps", 50)
    report = json_of(nonholo("info", "a.zarr", "--json"))
    assert report["provenance"]["motion"]["time_step"] == 0.1
    assert report["provenance"]["versions"]["numpy"] == np.__version__
    assert report["steps"] == 50
    assert_shows(nonholo("info", "a.zarr"), "difference matrix", f"kernels {report['provenance']['kernels']}")


def test_a_store_can_be_run_again(nonholo: Command, figures: Figures) -> None:
    """The scenario kept in a store repeats the run bit for bit."""
    first = figures("sleigh", "--set", "body.b=0.1234567890123456", "--steps", 40)
    Path("again.toml").write_text(nonholo("info", first["store"], "--scenario").stdout)
    second = figures("again.toml")
    one, two = nh.load_orbit(first["store"]), nh.load_orbit(second["store"])
    assert one.pose.tobytes() == two.pose.tobytes()


def test_stores_that_cannot_be_read(nonholo: Command) -> None:
    """No store is a usage error; a damaged one is a failure that names the chunk."""
    assert nonholo("info", "nothing.zarr").exit_code == 2
    nonholo("simulate", "suslov", "--no-plot", "-o", "a.zarr", "--steps", 5)
    Path("a.zarr/canonical/cayley/c/0/0").unlink()
    for command in ("info", "plot"):
        assert_ends(nonholo(command, "a.zarr"), 1, "chunk c/0/0 of the array canonical/cayley")
    assert "difference matrix" in " ".join(nonholo("info", "a.zarr").stdout.split())


def test_version(nonholo: Command) -> None:
    """`--version` prints the version."""
    assert nonholo("--version").stdout == f"nonholo {nh.__version__}\n"


def test_help_loads_nothing_heavy() -> None:
    """Neither `import nonholo` nor any help text loads the numerical libraries."""
    script = """
import sys
import nonholo
from typer.testing import CliRunner
from nonholo.cli._app import app
for command in ("", "simulate", "new", "systems", "info", "plot", "paper"):
    result = CliRunner().invoke(app, [*command.split(), "--help"])
    assert result.exit_code == 0 and "Usage" in result.stdout, command
heavy = {"jax", "numba", "numpy", "scipy", "xarray", "zarr", "matplotlib", "mpmath", "flint", "jinja2", "latex2mathml"}
print(sorted(heavy & set(sys.modules)))
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)  # noqa: S603
    assert done.stdout.strip() == "[]"


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="only Linux has a device that is full")
@pytest.mark.parametrize("arguments", [("cite",), ("new", "sleigh"), ("systems",), ("--help",)], ids=" ".join)
def test_full_standard_output_is_one_sentence(arguments: tuple[str, ...]) -> None:
    """Where the standard output cannot be written the command ends with code 1 and the reason of the system."""
    command = [sys.executable, "-c", "from nonholo.cli._app import main; main()", *arguments]
    with open("/dev/full", "w") as full:
        done = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True, check=False)  # noqa: S603
    assert (done.returncode, done.stderr) == (1, "[Errno 28] No space left on device\n")


@pytest.mark.parametrize(("steps", "words"), [(10**13, "save_every"), (10**30, "less than or equal")])
def test_more_states_than_memory(steps: int, words: str, nonholo: Command) -> None:
    """A run that could never be held on the disk is refused in words."""
    result = assert_ends(nonholo("simulate", "sleigh", "--no-plot", "--steps", steps), 2, words)
    assert result.exception is None or isinstance(result.exception, SystemExit)


@pytest.mark.parametrize(
    ("seconds", "written"),
    [(83.0, "83 s"), (1.0, "1 s"), (0.25, "250 ms"), (1.5e-3, "1.5 ms"), (7e-6, "7 us"), (4.2e-8, "42 ns")],
)
def test_durations_have_a_unit_that_suits_them(seconds: float, written: str) -> None:
    """A duration is written in the largest unit that it fills, to three digits."""
    assert duration(seconds) == written


SLEIGH = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1)


@pytest.mark.parametrize(
    ("kind", "message"),
    [
        ("top", "there is no kind 'top'. Did you mean suslov or veselova?"),
        ("slei", "Did you mean sleigh?"),
        ("rigid", "Did you mean rigid_body"),
        ("zebra", "Known: suslov, sleigh, multidimensional_sleigh,"),
    ],
)
def test_unknown_templates_name_the_nearest(kind: str, message: str, nonholo: Command) -> None:
    """A kind that is none is refused in our own words, with the nearest ones."""
    assert "Value error" not in words_of(assert_ends(nonholo("new", kind), 2, message))


@pytest.mark.profile("faults", keep=["png"])
@pytest.mark.parametrize("suffix", ["png", "gif"])
def test_pictures_at_a_path_of_ones_own_are_kept(suffix: str, nonholo: Command) -> None:
    """`plot -o` refuses what is there unless told to replace it; the picture beside the store is drawn anew."""
    nh.simulate(SLEIGH, body_velocity=(0.3, -1.0, 0.0), steps=20, store="a.zarr")
    mine = Path(f"mine.{suffix}")
    mine.write_text("mine")
    command = ["plot", "a.zarr", "-o", mine] + (["--gif"] if suffix == "gif" else [])
    assert_ends(nonholo(*command), 2, f"must be new. Got '{mine}', which exists.", "--overwrite")
    assert mine.read_text() == "mine"
    assert nonholo(*command, "--overwrite").exit_code == 0
    assert mine.read_bytes() != b"mine"
    again = [argument for argument in command if argument not in ("-o", mine)]
    assert [nonholo(*again).exit_code for _ in range(2)] == [0, 0]


@pytest.mark.parametrize("command", [("simulate", "sleigh"), ("sweep", "my.toml")], ids=" ".join)
def test_a_store_is_no_netcdf_file(command: tuple[str, str], nonholo: Command) -> None:
    """A store under the suffix of another format is refused before anything is run."""
    Path("my.toml").write_text(nonholo("new", "sweep").stdout)
    ended = nonholo(*command, "-o", "mine.nc")
    assert_ends(ended, 2, "must be the path of a Zarr store, usually *.zarr. Got 'mine.nc'")
    assert not Path("mine.nc").exists()
