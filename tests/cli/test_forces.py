"""Forces in scenarios: the same motion as in Python, the same text again, and refusals with their key."""

import itertools
import json
import re
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from commands import Command, assert_ends, scenario_of
from comparisons import assert_same
from matplotlib.text import Text

import nonholo as nh
from nonholo.cli.scenario.bodies import SHORT
from nonholo.cli.scenario.files import built_in, effective_text, load_scenario, parse_setting
from nonholo.cli.scenario.motion import rows_of
from nonholo.cli.scenario.sections import ScenarioError

TABLE = [[0.5, 0.25, 0.0], [-0.1, 0.3, 1.0], [0.0, 1e-3, 0.0]]
RUN = """
[start]
restricted_velocity = [0.3, 0.4]
[run]
time_step = 0.05
steps = 3
"""
FORCES = """
[forces]
gravity = {force = [0.1, -1.0], point = [0.5, 0.1]}
friction = [[0.2, 0.1, 0], [-0.1, 0.3, 0], [0, 0, 0.1]]
table = "input/motor.csv"
"""
SLEIGH = '[body]\nkind = "sleigh"\nmass = 2.0\ninertia = 0.7\na = 0.4\n' + RUN


@pytest.fixture
def file() -> Path:
    """A scenario with every force, and its table beside it."""
    path = Path("study/my.toml")
    (path.parent / "input").mkdir(parents=True)
    path.write_text(SLEIGH + FORCES)
    np.savetxt(path.parent / "input/motor.csv", TABLE, delimiter=",", header="omega,v1,v2", comments="")
    return path


def _forced(**forces: Any) -> nh.Forced:
    return nh.Forced(nh.ChaplyginSleigh(2.0, 0.7, 0.4), **forces)


GRAVITY, FRICTION = nh.Gravity([0.1, -1.0], [0.5, 0.1]), nh.Friction([[0.2, 0.1, 0], [-0.1, 0.3, 0], [0, 0, 0.1]])


@pytest.mark.parametrize(
    ("rows", "expected"),
    [
        ((), None),
        (("gravity",), {"potential": GRAVITY}),
        (("friction",), {"force": FRICTION}),
        (("table",), {"force": np.array(TABLE)}),
        (("gravity", "friction", "table"), {"potential": GRAVITY, "force": (FRICTION, np.array(TABLE))}),
    ],
    ids=["none", "gravity", "friction", "table", "all"],
)
def test_the_motion_is_that_of_python(file: Path, rows: tuple[str, ...], expected: Any) -> None:
    """A body under forces of a file moves as `Forced`, to the last bit; without any it is the body itself."""
    lines = FORCES.splitlines(keepends=True)
    file.write_text(SLEIGH + "".join(line for line in lines if line[0] in "[\n" or line.split(" ")[0] in rows))
    scenario = load_scenario(str(file), []).scenario
    system = _forced(**expected) if expected else nh.ChaplyginSleigh(2.0, 0.7, 0.4)
    assert scenario.system().is_forced == bool(expected)
    orbit = nh.simulate(scenario.discretization(), **scenario.options() | {"steps": 3})
    other = nh.simulate(nh.discretize(system, 0.05), restricted_velocity=(0.3, 0.4), steps=3)
    assert_same(orbit, other, "momentum", "configuration", "energy")


def test_a_blade_of_a_scenario_yields(file: Path) -> None:
    """`forces.slip` is `nh.Slip`, also beside other forces; a store of it has the bits of Python."""
    settings = ["slip={rows=[[0, 0, 1]], grip=0.1, viscous=0.2}", "gravity={force=[0.1, -1], point=[0.5, 0.1]}"]
    arguments = [parse_setting("forces={}"), *(parse_setting(f"forces.{each}") for each in settings)]
    arguments.append(parse_setting("start={body_velocity=[0.3, 0.4, 0.0]}"))
    scenario = load_scenario(str(file), arguments).scenario
    orbit = nh.simulate(scenario.discretization(), **scenario.options() | {"steps": 9})
    forced = _forced(potential=GRAVITY, force=nh.Slip([[0.0, 0.0, 1.0]], 0.1, 0.2))
    other = nh.simulate(nh.discretize(forced, 0.05), body_velocity=(0.3, 0.4, 0.0), steps=9)
    assert orbit.body_velocity[:, 2].any()
    assert_same(orbit, other, "momentum", "configuration", "energy")


def test_the_text_kept_repeats_the_run(file: Path, nonholo: Command) -> None:
    """A store holds the rows of the table, not its path; its scenario alone gives the run again."""
    scenario = load_scenario(str(file), []).scenario
    text = effective_text(scenario)
    assert tomllib.loads(text)["forces"]["table"] == TABLE
    assert scenario_of(load_scenario, text) == scenario
    for name, rows in ((file, "a.zarr"), ("my.toml", "b.zarr")):
        assert nonholo("simulate", name, "-o", rows, "--no-plot", "-q").exit_code == 0
    assert_same(nh.load_orbit("a.zarr"), nh.load_orbit("b.zarr"), "momentum")
    assert nonholo("info", "a.zarr").exit_code == 0
    assert nonholo("explore", file, "-o", "page.html", "--no-browser").exit_code == 0


def test_forces_of_the_command_line(file: Path) -> None:
    """A table that an option names stands where the command runs; an option may take a force away."""
    Path("own.csv").write_text("1,2,3\n" * 4)
    settings = [parse_setting('forces.table="own.csv"'), parse_setting("forces.friction=[1, 2, 3]")]
    forces = load_scenario(str(file), settings).scenario.forces
    assert (forces.table, forces.friction) == ([[1.0, 2.0, 3.0]] * 4, [1.0, 2.0, 3.0])
    assert load_scenario(str(file), [parse_setting("forces={}")]).scenario.system().is_forced is False


REFUSED = {
    "unknown key": ("forces.tables=[]", "forces.tables: is not a known key. Did you mean table?"),
    "key of a weight": ("forces.gravity={force=[1,2],pint=[1,2]}", "pint: is not a known key. Did you mean point"),
    "no point": ("forces.gravity={force=[1,2]}", "forces.gravity.point: is missing"),
    "no table": ("forces=1", "forces: must be a table. Got 1"),
    "formula": ('forces.friction="-v"', "forces.friction: must be a valid number. Got '-v'"),
    "shapes of a weight": ("forces.gravity.force=[1]", "forces.gravity.force: must have shape (2,). Got shape (1,)"),
    "space": ("forces.gravity={force=[1,2,3],point=[1,2,3]}", "gravity: must have points of SE(2). Got 3 numbers"),
    "few coefficients": ("forces.friction=[1]", "forces.friction: must have a coefficient for each of 3 directions"),
    "no coefficient": ("forces.friction=[]", "forces.friction: must have a coefficient for each direction"),
    "drive": ("forces.friction=[-1, 0, 0]", "forces.friction: must never add energy"),
    "rows of a matrix": ("forces.friction=[[1, 0], [0]]", "forces.friction: must"),
    "nan": ("forces.friction=[[1,0,0],[0,nan,0],[0,0,1]]", "forces.friction[1][1]: must be a finite number. Got nan"),
    "infinite": ("forces.gravity.point=[inf, 0]", "forces.gravity.point[0]: must be a finite number. Got inf"),
    "a slip without a grip": ("forces.slip={rows=[[0, 0, 1]]}", "forces.slip.grip: is missing"),
    "a slip along the blade": ("forces.slip={rows=[[0, 1, 0]], grip=1}", "forces.slip: must vanish on the constraint"),
    "a slip that drives": ("forces.slip={rows=[[0, 0, 1]], grip=-1}", "forces.slip.grip: must never add energy"),
    "no row": ("forces.table=[]", "forces.table: must have shape (any, 3)"),
    "short rows": ("forces.table=[[1,2],[1,2],[1,2]]", "forces.table: must have shape (any, 3). Got shape (3, 2)"),
    "uneven rows": ("forces.table=[[1,2],[1]]", "forces.table: must"),
    "few rows": ("run.steps=4", "forces.table: must have a row for each of 4 steps. Got 3"),
    "boolean": ("forces.table=[[true,0,0],[0,0,0],[0,0,0]]", "forces.table[0][0]: must be a valid number. Got True"),
    "device": ('forces.table="/dev/zero"', "Got '/dev/zero': it is a folder, a device or a pipe"),
    "no file": ('forces.table="none.csv"', "must be rows, or the path of a CSV file of numbers. Got 'none.csv'"),
    "nul": (r'forces.table="a\u0000b"', "must be rows, or the path of a CSV file of numbers"),
}


@pytest.mark.parametrize(("setting", "text"), REFUSED.values(), ids=list(REFUSED))
def test_refusals(file: Path, setting: str, text: str) -> None:
    """What cannot act on the body is refused with its key and what to do, before anything runs."""
    with pytest.raises(ScenarioError) as caught:
        load_scenario(str(file), [parse_setting(setting)])
    (result,) = {str(problem) for problem in caught.value.problems if text in str(problem)}
    assert "a function" not in result  # no scenario holds one


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("", "it has no rows"),
        ("omega,v1,v2\n", "it has no rows"),
        ("O.1,O.2,O.3\n1,2,3\n", "motor.csv': line 1 is 'O.1,O.2,O.3', neither numbers nor the names omega,v1,v2"),
        ("\n# by hand\n1,2,3\n", "line 2 is '# by hand', neither numbers nor the names"),
        ("v1,v2,omega\n1,2,3\n", "line 1 is 'v1,v2,omega', neither"),
        ("1,2,3\n1,x,3\n", "could not convert string 'x'"),
        ("1,x,3\n1,2,3\n", "could not convert string 'x'"),
        ("1,2,3\n1,2\n", "number of columns changed"),
        ("\ufeff\x00", "line 1 is"),
    ],
)
def test_files_that_are_no_table(file: Path, text: str, reason: str) -> None:
    """A row that is not of numbers is never taken for names, nor left out."""
    (file.parent / "input/motor.csv").write_text(text)
    with pytest.raises(ScenarioError, match=re.escape(reason)):
        load_scenario(str(file), [])


def test_numbers_of_a_file_are_checked(file: Path) -> None:
    """What is not finite in a file is refused as in a scenario, with its row."""
    (file.parent / "input/motor.csv").write_text("1,2,3\n1,nan,3\n1,2,3\n")
    with pytest.raises(ScenarioError, match=re.escape("forces.table[1][1]: must be a finite number. Got nan")):
        load_scenario(str(file), [])


def test_rows_are_read_exactly() -> None:
    """Every digit of a number counts; blank lines and spaces do not."""
    rows = np.random.default_rng(0).normal(size=(5, 3)).tolist()
    text = "\r\n\r\n".join(" , ".join(map(repr, row)) for row in rows)
    names = ("f1", "f2", "f3")
    assert rows_of(f"f1, f2, f3\r\n{text}\r\n", names) == rows_of(text, names) == rows


@pytest.mark.parametrize("table", ["[[1,2,3],[1,2,3],[1,2,3]]", '"study/input/motor.csv"'])
def test_report_says_what_was_read(table: str, file: Path, nonholo: Command) -> None:
    """Rows and columns of a table stand in the report of a run, so that a row that was lost is seen."""
    result = nonholo("simulate", file, "--no-plot", "--set", f"forces.table={table}")
    assert re.search(r"table of forces +3 rows, columns omega, v1, v2", result.output), result.output


@pytest.mark.parametrize("kind", SHORT)
def test_forces_of_a_template(kind: str) -> None:
    """The forces that stand as comments in what `nonholo new` writes act on its body."""
    own = re.sub(r"^# (\[forces\]|gravity|friction)", r"\1", built_in()[kind], flags=re.MULTILINE)
    forces = scenario_of(load_scenario, own).system()
    assert (forces.gravity is not None, forces.friction is not None) == (True, True)


def test_steps_that_take_no_forces(file: Path, nonholo: Command) -> None:
    """Kicks around a composition have no higher order: the run is refused, with what there is."""
    options = ("--set", 'run.difference="logarithmic"', "--set", "run.order=4")
    assert_ends(nonholo("simulate", file, *options), 2, "must be 2 where forces act at the nodes")


def test_thinned_run_under_a_table(file: Path, nonholo: Command) -> None:
    """What needs every step is left out of the table, the picture and the page, and the rest is there."""
    result = assert_ends(nonholo("simulate", file, "--set", "run.save_every=3", "-o", "a.zarr", "--json"), 0)
    report = json.loads(result.stdout)
    assert (report["work"], report["energy_drift"], report["outcome"]) == (None, None, "successful")
    assert report["constraint_residual"] < 1e-14
    assert "no picture" not in result.stderr
    assert nonholo("info", "a.zarr").exit_code == 0
    assert nonholo("explore", "a.zarr", "-o", "page.html", "--no-browser").exit_code == 0
    orbit = nh.load_orbit("a.zarr")
    assert nh.plot.energy_error(orbit).axes.get_title("left") == "Change of energy"
    assert "Chaplygin sleigh, under forces" in [text.get_text() for text in nh.plot.overview(orbit).findobj(Text)]


DESIGN = '[design]\nkind = "grid"\n[design.values]\n"start.restricted_velocity_0" = [0.1, 0.3]\n'


def test_sweep_over_numbers_of_forces(file: Path, nonholo: Command) -> None:
    """Members under other forces, and other bodies under them, end where `simulate` ends; a killed one is resumed."""
    own = '"body.a" = [0.1, 0.2]\n"forces.gravity.force_1" = [-2.0, -1.0]\n"forces.gravity.point" = [[0.5, 0.1]]\n'
    file.write_text(SLEIGH + FORCES.replace("friction", "# friction") + DESIGN + own)
    assert_ends(nonholo("sweep", file, "-o", "s.zarr", "--no-plot", "-q"), 0)
    swept = nh.load_sweep("s.zarr").load()
    for a, weight in itertools.product([0.1, 0.2], [-2.0, -1.0]):
        forced = nh.Forced(nh.ChaplyginSleigh(2.0, 0.7, a), nh.Gravity([0.1, weight], [0.5, 0.1]), np.array(TABLE))
        last = nh.simulate(nh.discretize(forced, 0.05), restricted_velocity=(0.3, 0.4), steps=3)
        member = swept.sel(a=a, gravity_force_1=weight, restricted_velocity_0=0.3).isel(gravity_point_number=0)
        np.testing.assert_array_equal(member["final_momentum"].values, last.restricted_momentum[-1])
    next(Path("s.zarr").rglob("[0-9]*.json")).unlink()
    assert nonholo("resume", "s.zarr").exit_code == 0  # without trust: nothing of somebody's own is named
    np.testing.assert_array_equal(nh.load_sweep("s.zarr")["final_momentum"], swept["final_momentum"])


@pytest.mark.parametrize(
    ("value", "message"),
    [
        ('"forces.gravity.wight" = [1]', "cannot be varied. Did you mean gravity_point?"),
        ('"forces.friction_7" = [1.0]', "must vary existing components. Got friction_7 of 3"),
        ('"forces.slip.grip" = [1.0]', "cannot be varied. Known: gravity_force, gravity_point, friction."),
    ],
)
def test_numbers_that_no_force_has(value: str, message: str, file: Path, nonholo: Command) -> None:
    """A sweep over what no force of the scenario has is refused with what there is."""
    forces = FORCES.replace("[[0.2, 0.1, 0], [-0.1, 0.3, 0], [0, 0, 0.1]]", "[1, 2, 3]")
    file.write_text(SLEIGH + forces + DESIGN + value)
    assert message in assert_ends(nonholo("sweep", file, "--no-plot"), 2).output
