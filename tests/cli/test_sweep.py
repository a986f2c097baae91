"""`nonholo sweep`, and `info`, `plot`, `resume` and `extend` of what it leaves."""

import errno
import functools
import itertools
import os
import re
import signal
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from commands import Command, assert_ends, assert_shows, json_of, problems_of, scenario_of
from ensembles.faults import HEED_CTRL_C
from stopping import failing_at
from waiting import wait_for

import nonholo as nh
from nonholo.cli.scenario.sweeps import files, load_sweep_scenario
from nonholo.ensembles import standing_of
from nonholo.io.places import write_lock

BODY = """
[body]
kind = "sleigh"
mass = 1.0
inertia = 1.0
a = 0.5
[start]
restricted_velocity = [0.3, -1.0]
[run]
time_step = 0.1
steps = 20
"""
GRID = f"""{BODY}
[design]
kind = "grid"
[design.values]
"body.a" = [0.3, 0.5]
"start.restricted_velocity[0]" = {{from = 0.1, to = 0.4, count = 4}}
[keep]
reductions = ["limit_angle", "energy_drift"]
[output]
color = "heading_turn"
x = "start.restricted_velocity[0]"
"""
RANDOM = f"""{BODY}
[design]
kind = "random"
members = 12
rng = 3
[design.values]
"body.a" = {{uniform = [0.2, 1.0]}}
"start.restricted_velocity" = {{direction = 1.0}}
"""


def _written(text: str) -> str:
    Path("my.toml").write_text(text)
    return "my.toml"


_problems = functools.partial(problems_of, load_sweep_scenario)


def test_the_branch_rule_reaches_the_members() -> None:
    """The scenario's key run.branch is the rule of the task."""
    scenario = scenario_of(load_sweep_scenario, GRID.replace("steps = 20", 'steps = 20\nbranch = "nearest"'))
    assert scenario.task().branch == "nearest"


def _design(text: str, *settings: str) -> nh.Grid | nh.RandomDesign:
    return scenario_of(load_sweep_scenario, text, *settings).design.design()


def test_the_former_word_for_random_numbers_is_read() -> None:
    """Scenarios that stores hold say `seed` where new ones say `rng`; both at once are refused."""
    assert _design(RANDOM.replace("rng = 3", "seed = 3")).seed == _design(RANDOM).seed == 3
    assert _problems(RANDOM.replace("rng = 3", "rng = 3\nseed = 3"))


def test_a_sweep_holds_the_orbits_of_simulate(nonholo: Command) -> None:
    """Each cell of a swept grid has the turn of the orbit that `simulate` runs for its values, to rounding."""
    report = json_of(nonholo("sweep", _written(GRID), "--json", "--no-plot"))
    assert report["store"] == "runs/my-001.zarr"
    assert report["outcomes"] == {"successful": 8}
    result = nh.load_sweep(report["store"])
    cell = result.isel({"a": 1, "restricted_velocity_0": 2})
    discrete = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1)
    orbit = nh.simulate(discrete, restricted_velocity=(float(cell["restricted_velocity_0"]), -1.0), steps=20)
    assert abs(float(cell["heading_turn"]) - orbit.heading[-1]) < 1e-14  # sums of 20 angles of some 0.03


def test_the_table_and_the_picture(nonholo: Command) -> None:
    """The table names members, outcomes, ranges and speed; a picture stands beside the store."""
    words = ("members", "8", "successful", "(100 %)", "heading_turn", "members/s", "size on disk")
    assert_shows(nonholo("sweep", _written(GRID), "-o", "study/first.zarr"), *words)
    assert Path("study/first.png").stat().st_size > 5000


def test_each_sweep_has_a_new_number(nonholo: Command) -> None:
    """Without -o nothing is overwritten, nor a picture that is left over, no gap filled; -q prints the path alone."""
    text = _written(RANDOM)
    Path("runs").mkdir()
    Path("runs/my-007.png").touch()
    stores = [nonholo("sweep", text, "-q", "--no-plot").stdout for _ in range(2)]
    assert stores == ["runs/my-008.zarr\n", "runs/my-009.zarr\n"]


def test_sweep_that_was_stopped_is_asked_again(nonholo: Command) -> None:
    """The same command does what a sweep lacks and draws it, and `resume` of one that is drawn has nothing to say."""
    command = ("sweep", _written(GRID), "-o", "s.zarr", "--scheduler", "synchronous")
    with failing_at(0, OSError(errno.ENOSPC, "No space left on device")):
        assert nonholo(*command).exit_code == 1
    assert nonholo(*command, "--set", "run.steps=30").exit_code == 2
    for missing in (None, "s.png"):
        if missing:
            Path(missing).unlink()
        assert_ends(nonholo(*command), 0)
        assert Path("s.png").exists()
    assert nonholo("resume", "s.zarr", "--scheduler", "synchronous").exit_code == 0
    assert nonholo(*command).exit_code == 2


@pytest.mark.parametrize("form", ['"body.a" = [0.1, 0.2]', "body.a = [0.1, 0.2]", "body = {a = [0.1, 0.2]}"])
def test_key_paths_with_and_without_quotes(form: str) -> None:
    """A key path of a design may be quoted, dotted or a table."""
    design = _design(f'{BODY}\n[design]\nkind = "grid"\n[design.values]\n{form}')
    assert {name: values.tolist() for name, values in design.axes.items()} == {"a": [0.1, 0.2]}


def test_settings_change_a_design() -> None:
    """`--set` reaches values of the design by the same key paths."""
    design = _design(GRID, "design.values.body.a={from=0.1, to=10, count=3, spacing='logarithmic'}")
    assert np.allclose(design.axes["a"], [0.1, 1.0, 10.0], rtol=1e-15)
    assert _design(GRID, "design.values.start.restricted_velocity[0].count=7").members == 14


def test_members_scale_the_ranges_of_a_grid() -> None:
    """How many are asked for multiplies the counts of ranges by one factor; lists stay as they are."""
    ranges = GRID.replace("[0.3, 0.5]", "{from = 0.1, to = 1.0, count = 2}")
    assert list(_design(ranges, "design.members=800").sizes.values()) == [20, 40]
    assert list(_design(GRID, "design.members=2000").sizes.values()) == [2, 1000]


def test_members_of_a_random_design(nonholo: Command) -> None:
    """`--members 1e2` draws this many, of which the first are those of a smaller design."""
    few, many = (json_of(nonholo("sweep", _written(RANDOM), "--members", n, "--json", "--no-plot")) for n in (5, "1e2"))
    assert (few["members"], many["members"]) == (5, 100)
    first, second = (nh.load_sweep(report["store"]) for report in (few, many))
    assert first.equals(second.isel(member=slice(5)))


def test_members_of_lists_are_refused() -> None:
    """A grid of lists has no count to scale."""
    text = GRID.replace("{from = 0.1, to = 0.4, count = 4}", "[0.1, 0.2]")
    report = _problems(text, "design.members=100")
    assert report == ["--set design.members=100: design.members: needs a range with a count to scale"]


@pytest.mark.parametrize(
    ("values", "kind"),
    [
        ("{uniform = [0.1, 0.2]}", nh.Uniform(0.1, 0.2)),
        ("{log_uniform = [0.1, 10]}", nh.LogUniform(0.1, 10)),
        ("{normal = [1.0, 0.1]}", nh.Normal(1.0, 0.1)),
        ("{choice = [0.5, 1.0]}", nh.Choice([0.5, 1.0])),
    ],
)
def test_distributions(values: str, kind: Any) -> None:
    """Each spelling is the distribution of that name; a direction has the length of the start that it replaces."""
    design = _design(RANDOM.replace("{uniform = [0.2, 1.0]}", values))
    assert design.distributions == {"a": kind, "restricted_velocity": nh.Direction(2, 1.0)}


def test_what_varies_may_be_left_out(nonholo: Command) -> None:
    """A key that the design varies need not stand in its own table."""
    text = GRID.replace("a = 0.5\n", "", 1)
    result = nh.load_sweep(json_of(nonholo("sweep", _written(text), "--json", "--no-plot"))["store"])
    assert result["a"].values.tolist() == [0.3, 0.5]


def test_all_problems_at_once_are_refused() -> None:
    """Mistakes in five tables are reported together, each with its key path."""
    text = (
        GRID.replace("mass = 1.0", "mass = true")
        .replace("[0.3, 0.5]", "[0.3, true]")
        .replace("count = 4", "count = 0")
        .replace('"energy_drift"', '"energy_drfit"')
        .replace("color =", "colour =")
    )
    result = _problems(text)
    assert len(result) == 5
    assert "my.toml: body.mass: must be a valid number. Got True" in result
    assert any(f.startswith("my.toml: design.values.body.a: must be a list of numbers") for f in result)
    where = "my.toml: design.values.start.restricted_velocity[0]"
    assert f"{where}.count: must be greater than 0. Got 0" in result
    assert any(f.startswith("my.toml: keep.reductions[1]: must be 'final_state', ") for f in result)
    assert "my.toml: output.colour: is not a known key. Did you mean color?" in result


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('"body.a"', '"body.kind"', "design.values.body.kind: cannot be varied. Known: mass, inertia, a, b."),
        ('"body.a"', '"run.steps"', "design.values.run.steps: cannot be varied. Known: time_step."),
        ('"body.a"', '"bdy.a"', "design.values.bdy: is not a known key. Did you mean body?"),
        ('"body.a"', '"start.momentum[0]"', "start.momentum: is missing: momentum[0] is varied"),
        ('kind = "grid"', 'kind = "gird"', "design: must have a known kind. Got 'gird'. Did you mean grid?"),
        ('kind = "grid"', 'kind = "random"', "design.members: is missing"),
        ('"body.a" = [0.3, 0.5]', '"body.b" = 3', "design.values.body.b: must be a list of numbers"),
        ("[0.3, 0.5]", "{from = 0.1, to = 1}", "body.a.count: is missing"),
        ("[0.3, 0.5]", "{uniform = [0, 1]}", "body.a.uniform: is not a known key. Known: from, to, count, spacing."),
        ("[0.3, 0.5]", "{from = -1, to = 1, count = 3, spacing = 'logarithmic'}", "must have positive bounds"),
        ("[0.3, 0.5]", "{from = 0, to = 1, count = 3, spacing = 'log'}", "body.a.spacing: must be 'linear' or"),
        ("steps = 20", 'steps = 20\nbranch = "next"', "run.branch: must be 'principal', 'nearest', "),
        ("steps = 20", "steps = 20\nsave_every = 2", "run.save_every: is not for sweeps"),
        ("[keep]", "[kep]", "kep: is not a known key. Did you mean keep?"),
    ],
)
def test_what_is_refused(old: str, new: str, message: str) -> None:
    """What a sweep cannot do is reported with its key path and what there is instead."""
    assert any(message in problem for problem in _problems(GRID.replace(old, new)))


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ("{unifrom = [0, 1]}", "must hold one of uniform, log_uniform, normal, direction, mass_tensor, choice"),
        ("{uniform = 1}", "must be uniform = [low, high]. Got 1"),
        ("{uniform = [2, 1]}", "uniform: must not be below `low`. Got 1"),
        ("{uniform = [0, 1], size = 2}", "Got a table with size"),
        ("{log_uniform = [0, 1]}", "log_uniform: must be positive"),
        ("{mass_tensor = [0.5, 2.0]}", "needs size = ..., the length of the matrices"),
    ],
)
def test_distributions_that_are_refused(values: str, message: str) -> None:
    """A distribution that cannot be drawn is reported with its key path."""
    (problem,) = _problems(RANDOM.replace("{uniform = [0.2, 1.0]}", values))
    assert problem.startswith("my.toml: design.values.body.a: ")
    assert message in problem


def test_the_stored_scenario_repeats_the_sweep(nonholo: Command) -> None:
    """`info --scenario` is a scenario with all values in force, counts too, and gives the same bits."""
    first = json_of(nonholo("sweep", _written(GRID), "--members", 30, "--json", "--no-plot"))
    text = nonholo("info", first["store"], "--scenario").stdout
    assert tomllib.loads(text)["design"]["values"]["start.restricted_velocity[0]"]["count"] == 15
    again = json_of(nonholo("sweep", _written(text), "--json", "--no-plot"))
    assert nh.load_sweep(first["store"]).equals(nh.load_sweep(again["store"]))


def test_effective_text_is_stable() -> None:
    """The text of a scenario is read as that scenario."""
    scenario = scenario_of(load_sweep_scenario, RANDOM)
    assert scenario_of(load_sweep_scenario, files.effective_text(scenario)) == scenario


def test_info_of_a_sweep(nonholo: Command) -> None:
    """`info` tells members, outcomes, ranges, the design and the versions, as a table and as JSON."""
    store = json_of(nonholo("sweep", _written(GRID), "--json", "--no-plot"))["store"]
    words = ("ChaplyginSleigh", "Grid, seed 0", "successful", "heading_turn", "members/s", "sha256", "numba")
    assert_shows(nonholo("info", store), *words)
    report = json_of(nonholo("info", store, "--json"))
    assert report["done"] == report["members"] == 8
    assert report["state"] == "finished"
    assert report["provenance"]["task"]["steps"] == 20


def test_a_sweep_without_a_single_result_fails(nonholo: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    """`sweep` and `resume` end with 1 and say so in the last line if the task raised for every member."""
    run, calls = nh.EnsembleTask.__call__, itertools.count()

    def unlucky(task: nh.EnsembleTask, block: nh.MemberBlock) -> dict[str, Any]:
        if next(calls) < 2:  # the members that are tried
            return run(task, block)
        raise ValueError("no luck")

    monkeypatch.setattr(nh.EnsembleTask, "__call__", unlucky)
    for command in (("sweep", _written(GRID), "--no-plot", "-o", "a.zarr"), ("resume", "a.zarr")):
        result = assert_ends(nonholo(*command), 1)
        assert result.stderr.splitlines()[-1] == "Every member raised: ValueError: no luck"


def test_failed_members_are_told(nonholo: Command) -> None:
    """Members for which the task raises do not stop the rest; `info` repeats their first messages."""
    text = GRID.replace('"body.a" = [0.3, 0.5]', '"body.mass" = [1.0, -1.0]')
    store = json_of(nonholo("sweep", _written(text), "--json", "--no-plot"))["store"]
    assert json_of(nonholo("info", store, "--json"))["outcomes"] == {"successful": 4, "raised": 4}
    assert_shows(nonholo("info", store), "member 4 raised ValueError", "must be positive")


@pytest.fixture
def stopped(monkeypatch: pytest.MonkeyPatch, nonholo: Command) -> Path:
    """A sweep of 12 members, one a block, that Ctrl-C stopped after its first four blocks."""
    with monkeypatch.context() as patch, failing_at(4):
        patch.setattr(nh.EnsembleTask, "block", property(lambda _: 1))
        ended = nonholo("sweep", _written(RANDOM), "-o", "s.zarr", "--scheduler", "synchronous")
    assert_ends(ended, 1, "Stopped at 4 of 12 members", "Resume with: nonholo resume s.zarr")
    return Path("s.zarr")


def test_a_stopped_sweep_is_resumed(stopped: Path, nonholo: Command) -> None:
    """`info` says how far it came, how to resume and who writes; the rest gives the bits of a sweep in one piece."""
    assert_shows(nonholo("info", stopped), "4 of 12, 33.3 %", "resume with: nonholo resume s.zarr")
    with write_lock(stopped):
        assert_shows(nonholo("info", stopped), f"written by process {os.getpid()} on")
        assert_ends(nonholo("resume", stopped), 2, "is being written by process")
    assert json_of(nonholo("resume", stopped, "--workers", 1, "--json"))["done"] == 12
    whole = json_of(nonholo("sweep", _written(RANDOM), "--json", "--no-plot"))
    assert nh.load_sweep(stopped).equals(nh.load_sweep(whole["store"]))


def test_full_disk_does_not_hide_damage(stopped: Path, nonholo: Command) -> None:
    """Damaged chunks are named even if the disk is full before some block is written."""
    for chunk in (stopped / "final_time" / "c").iterdir():
        chunk.unlink()
    with failing_at(11, OSError(errno.ENOSPC, "No space left on device")):
        ended = nonholo("resume", stopped, "--scheduler", "synchronous")
    assert_ends(ended, 1, "No space left on device. The sweep stands at", "of the array final_time. Block")


def test_resume_of_a_damaged_sweep(nonholo: Command) -> None:
    """A lost chunk is named, and computed again; until then `info` says that the result is not sound."""
    store = Path(json_of(nonholo("sweep", _written(GRID), "--json", "--no-plot"))["store"])
    before = nh.load_sweep(store).load()
    next((store / "heading_turn" / "c").rglob("[0-9]*/[0-9]*")).unlink()
    assert_ends(nonholo("info", store), 1, "heading_turn")
    assert_ends(nonholo("resume", store), 0, "of the array heading_turn")
    assert nh.load_sweep(store).equals(before)


@pytest.mark.profile("faults", instead="test_a_stopped_sweep_is_resumed")
@pytest.mark.parametrize("name", ["SIGINT", "SIGTERM", "SIGHUP"])
def test_stopping_signals(name: str) -> None:
    """Ctrl-C, the end of a container and a closed terminal leave an unlocked store to resume, and exit code 1."""
    text = RANDOM.replace("members = 12", "members = 4000000").replace("steps = 20", "steps = 50")
    program = f"{HEED_CTRL_C}\nfrom nonholo.cli import main; main()"
    command = [sys.executable, "-c", program, "sweep", _written(text), "-o", "s.zarr"]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)  # noqa: S603
    wait_for(lambda: list(Path().glob("s.zarr/run/blocks/*.json")))
    process.send_signal(getattr(signal, name))
    report = process.communicate(timeout=120)[1]
    assert process.returncode == 1
    assert "Resume with: nonholo resume s.zarr" in report
    assert not list(Path("s.zarr/run").glob("lock*"))
    standing = standing_of("s.zarr")
    assert 0 < standing.done < standing.members


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("sweep", "--scheduler", "nix"), "must be one of threads, processes, synchronous or an address"),
        (("sweep", "--members", "2.5"), "--members 2.5: design.members: must be a valid integer"),
        (("sweep", "--members", "0"), "--members 0: design.members: must be greater than 0"),
        (("sweep", "--set", "design.kind='random'"), "my.toml: design.members: is missing"),
        (("simulate",), "nonholo sweep my.toml"),
    ],
)
def test_options_that_are_refused(words: tuple[str, ...], message: str, nonholo: Command) -> None:
    """A bad option, and a command for one motion, end with exit code 2 before there is a store."""
    assert_ends(nonholo(words[0], _written(GRID), *words[1:]), 2, message)
    assert not list(Path().glob("runs/*"))


@pytest.mark.parametrize("count", [10**15, 10**10])
def test_grids_that_fill_the_memory_are_refused(count: int, nonholo: Command) -> None:
    """A range is not made before it is known to fit, and nothing is left."""
    text = GRID.replace("count = 4", f"count = {count}")
    assert_ends(nonholo("sweep", _written(text), "-o", "a.zarr"), 2, "fit into memory")
    assert not Path("a.zarr").exists()


def test_plot_of_a_sweep(nonholo: Command) -> None:
    """`plot` draws what the scenario shows, or what is asked for, by key path or name; `extend` has nothing to add."""
    store = json_of(nonholo("sweep", _written(GRID), "--json", "--no-plot"))["store"]
    assert nonholo("plot", store, "-o", "own.png").exit_code == 0
    assert nonholo("plot", store, "-o", "other.svg", "--color", "energy_drift", "--x", "body.a").exit_code == 0
    assert Path("own.png").exists()
    assert "energy drift" in Path("other.svg").read_text()
    ended = nonholo("plot", store, "-o", "none.png", "--color", "nothing")
    assert_ends(ended, 1, "must be one of 'energy_drift', 'heading_turn', 'outcome'")
    assert_ends(nonholo("extend", store, "--steps", 10), 2, "--set run.steps")


def test_template_runs(nonholo: Command) -> None:
    """`nonholo new sweep` prints a scenario that runs as it is."""
    text = nonholo("new", "sweep").stdout
    report = json_of(nonholo("sweep", _written(text), "--members", 12, "--set", "run.steps=50", "--json"))
    assert report["outcomes"] == {"successful": 12}
    assert Path(report["picture"]).exists()


@pytest.mark.profile("routes", instead="test_template_runs")
def test_the_scenario_of_the_page(nonholo: Command) -> None:
    """Its scenario, with a body and a start, runs."""
    page = Path(__file__).parents[2] / "docs" / "how-to" / "run-a-sweep.md"
    (block,) = re.findall(r"```toml\n(.*?)```", page.read_text(), re.DOTALL)
    report = json_of(nonholo("sweep", _written(BODY + block), "--members", 12, "--json", "--no-plot"))
    assert report["members"] == 12


@pytest.mark.parametrize("values", ["", "restricted_velocity = [7.0, 7.0]\n"])
def test_a_start_that_is_varied_whole_need_not_be_given(values: str, nonholo: Command) -> None:
    """Where every component of the start is varied the scenario may leave it out; the result is the same."""
    varied = '"start.restricted_velocity[1]" = [-1.0, 0.5]\n[keep]'
    text = GRID.replace("restricted_velocity = [0.3, -1.0]\n", values).replace("[keep]", varied)
    result = nh.load_sweep(json_of(nonholo("sweep", _written(text), "--json", "--no-plot"))["store"])
    cell = result.sel(a=0.5, restricted_velocity_0=0.2, restricted_velocity_1=0.5)
    orbit = nh.simulate(nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1), restricted_velocity=(0.2, 0.5), steps=20)
    assert abs(float(cell.heading_turn) - orbit.heading[-1]) < 1e-14  # sums of 20 angles of some 0.03


def test_half_a_start_is_refused() -> None:
    """Where a component is neither varied nor given the scenario is refused with what is missing."""
    result = _problems(GRID.replace("restricted_velocity = [0.3, -1.0]\n", "").replace("velocity[0]", "velocity[1]"))
    assert any(problem.startswith("my.toml: start: ") for problem in result), result
