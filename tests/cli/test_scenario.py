"""Scenarios: read within bounds; everything wrong is reported at once; ready ones have the motion of their title."""

import functools
import os
import time
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from commands import Command, Figures, assert_ends, problems_of, scenario_of
from hypothesis import given
from hypothesis import strategies as st

import nonholo as nh
from nonholo.cli.scenario.bodies import SHORT
from nonholo.cli.scenario.files import effective_text, load_scenario, parse_setting, parse_toml
from nonholo.cli.scenario.sections import ScenarioError

_GOOD = """
[body]
kind = "sleigh"
mass = 1
inertia = 1.0
a = 0.5
[start]
body_velocity = [0.1, 1, 0]
[run]
time_step = 0.1
steps = 3
"""


_problems = functools.partial(problems_of, load_scenario)


def test_all_problems_at_once() -> None:
    """Three mistakes in three tables are four problems, each with file, key path and what was got."""
    text = (
        _GOOD.replace("a = 0.5", "aa = 0.5")
        .replace("steps = 3", 'steps = "3"')
        .replace("[0.1, 1, 0]", "[0.1, true, 0]")
    )
    result = _problems(text)
    assert len(result) == 4
    assert "my.toml: body.a: is missing" in result
    assert "my.toml: body.aa: is not a known key. Did you mean a?" in result
    assert any(f.startswith("my.toml: start.body_velocity[1]: must be a valid number") for f in result)
    assert "my.toml: run.steps: must be a valid integer. Got '3'" in result


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('kind = "sleigh"', 'kind = "slegh"', "body: must have a known kind. Got 'slegh'. Did you mean s"),
        ('kind = "sleigh"', "", f"body: must have a known kind. Got none. Known: {', '.join(SHORT)}, "),
        ("[run]", "[outptu]\nplot = true\n[run]", "outptu: is not a known key. Did you mean output?"),
        ("[body]", "output = 1\n[body]", "output: must be a table. Got 1"),
        ("mass = 1", "mass = -1", "body.mass: must be positive. Got -1"),
        ("[run]", "momentum = [1, 2]\n[run]", "start: must hold exactly one of body_velocity, restricted_velocity"),
        ("[run]", "momentum = [1, 2]\n[run]", "Got body_velocity and momentum."),
        ("body_velocity = [0.1, 1, 0]", "", "Got none."),
        ("[body]", "[body", "is not valid TOML"),
        ("mass = 1", "mass = 1\nmass = 2", "is not valid TOML"),
    ],
)
def test_a_problem_is_told_with_its_place(old: str, new: str, message: str) -> None:
    """What is unknown, missing, double or refused by the library has its key path; what is no TOML its line."""
    (problem,) = _problems(_GOOD.replace(old, new))
    assert message in problem
    assert problem.startswith("my.toml: ")
    assert "line" in problem or "TOML" not in message


def test_unreadable_files(tmp_path: Path) -> None:
    """A missing file, a folder and bytes that are no text are refused; a near miss of a built-in name is suggested."""
    (tmp_path / "binary.toml").write_bytes(b"\xff\xfe\x00")
    for name, report in (("sleig", "Did you mean sleigh?"), (".", "cannot be read"), ("binary.toml", "cannot be read")):
        with pytest.raises(ScenarioError, match=report.replace("?", r"\?")):
            load_scenario(name, [])


def test_settings_name_their_option() -> None:
    """A wrong value or path from the command line is reported with the option, the rest with the file."""
    result = _problems(_GOOD.replace("mass = 1", "mass = -1"), "body.a=nan", "start.velocity=1")
    assert result[0] == "--set body.a=nan: body.a: must be a finite number. Got nan"
    assert result[1].startswith("--set start.velocity=1: start.velocity: is not a known key. Did you mean")
    assert "mass is a value, not a table" in _problems(_GOOD, "body.mass.x=1")[0]


@pytest.mark.parametrize("text", ["body.a", "=1", "body..a=1", "body.a=x", "body.a=1\nb=2", "body.a="])
def test_malformed_settings(text: str) -> None:
    """A setting that is not KEY=VALUE with a TOML value is refused with an example."""
    with pytest.raises(ScenarioError, match=r"must (be KEY=VALUE|have a TOML value)"):
        parse_setting(text)


def test_setting_replaces_a_table() -> None:
    """An inline table replaces a whole table, so that the start can be of another sort."""
    scenario = scenario_of(load_scenario, _GOOD, "start={momentum=[0.1, 1.0]}")
    assert scenario.start.momentum == [0.1, 1.0]


@given(
    mass=st.floats(min_value=1e-150, max_value=1e150),
    a=st.floats(min_value=-1e150, max_value=1e150),
    steps=st.integers(1, 10**15),
    title=st.text(st.characters(exclude_categories=["Cs", "Cc"])),
)
def test_effective_text_repeats_the_scenario(mass: float, a: float, steps: int, title: str) -> None:
    """The text kept in a store, read again, is the same scenario, exact in every number."""
    scenario = scenario_of(load_scenario, _GOOD, f"body.mass={mass!r}", f"body.a={a!r}", f"run.steps={steps}")
    scenario = scenario.model_copy(update={"title": title})
    assert type(scenario).model_validate(tomllib.loads(effective_text(scenario))) == scenario


BOMBS = {
    "deep arrays": ("a = " + "[" * 200_000, "nested deeper than 32"),
    "arrays": ("a = " + "[" * 40 + "]" * 40, "nested deeper than 32"),
    "tables": ("[" + ".".join("a" * 50) + "]", "nested deeper than 32"),
    "integer": ("a = " + "9" * 1_000_000, "Exceeds the limit"),
    "size": ("# " + "x" * (1 << 22), "it has more than 4.19 MB"),
    "bytes": ("a = 1\ud800", "cannot be read as a text file"),
}


@pytest.mark.parametrize("command", ["simulate", "sweep"])
@pytest.mark.parametrize("name", BOMBS)
def test_bombs_are_refused(name: str, command: str, nonholo: Command) -> None:
    """What would fill memory or stack is reported as a problem of the scenario."""
    text, report = BOMBS[name]
    Path("bomb.toml").write_bytes(text.encode(errors="surrogatepass"))
    assert_ends(nonholo(command, "bomb.toml"), 2, report)


@pytest.mark.parametrize("name", ["/dev/zero", "pipe", ".", "x" * 5000])
def test_files_that_do_not_end_are_refused(name: str, nonholo: Command) -> None:
    """Devices, pipes and folders are refused at once, a name that is too long as well."""
    os.mkfifo("pipe")
    begun = time.monotonic()
    assert_ends(nonholo("simulate", name), 2, "too long" if len(name) > 99 else "a folder, a device or a pipe")
    assert time.monotonic() - begun < 5


def test_a_setting_may_be_a_bomb(nonholo: Command) -> None:
    """A value of the command line is no better than a file."""
    assert nonholo("simulate", "sleigh", "--set", "run.steps=" + "9" * 10_000).exit_code == 2


def test_what_is_nested_a_little_is_read() -> None:
    """The limit is far from what scenarios need."""
    assert parse_toml("a = " + "[" * 20 + "]" * 20)


_FOLDER = Path(__file__).parents[2] / "scenarios"
_FILES = sorted(path for path in _FOLDER.glob("*.toml") if not path.stem.endswith("_sweep"))


@pytest.mark.profile("routes", keep=["suslov*", "*sleigh", "long_run", "tilted_axis", "four_steps"])
@pytest.mark.parametrize("path", _FILES, ids=lambda path: path.stem)
def test_example_runs(path: Path, figures: Figures) -> None:
    """Each example succeeds, with energy kept to rounding where the discretization promises it; not under forces."""
    report = figures(path, *(["--steps", 20] if path.stem == "logarithmic_difference" else []))
    assert report["outcome"] == "successful"
    drifts = {"logarithmic_difference": 1e-3, "hanging_top": 1e-3, "twisted_sleigh": 1e-2}
    assert report["energy_drift"] < drifts.get(path.stem, 1e-12)
    assert report["constraint_residual"] < 1e-14


def test_balanced_sleigh_moves_on_a_circle(figures: Figures) -> None:
    """The balanced sleigh keeps one distance from one point."""
    position = nh.load_orbit(figures(_FOLDER / "balanced_sleigh.toml")["store"]).position
    x, y = position.T
    center = np.linalg.lstsq(np.column_stack([2 * x, 2 * y, np.ones_like(x)]), x**2 + y**2, rcond=None)[0][:2]
    assert np.ptp(np.linalg.norm(position - center, axis=1)) < 1e-12


def test_hanging_top_comes_to_rest(figures: Figures) -> None:
    """Its center of mass ends below the fixed point, and what it falls short of the lowest energy is small."""
    orbit = nh.load_orbit(figures(_FOLDER / "hanging_top.toml")["store"])
    assert orbit.configuration[-1, 2, 2] > 0.999
    assert 0 < orbit.energy[-1] + 9.81 * 0.3 < 1e-3 * (orbit.energy[0] - orbit.energy[-1])


def test_twisting_drives_a_sleigh(figures: Figures) -> None:
    """From rest it gets under way, always forwards, while it swings about; its energy is the work done on it."""
    orbit = nh.load_orbit(figures(_FOLDER / "twisted_sleigh.toml")["store"])
    turning, speed, _ = orbit.body_velocity.T
    assert (speed[0], speed[1:].min() > 0, speed[300:].min() > 0.8) == (0, True, True)
    assert np.count_nonzero(np.diff(np.sign(turning))) >= 10
    assert orbit.energy[-1] == pytest.approx(orbit.work[-1], rel=5e-3)


def _swept(nonholo: Command, name: str, members: int) -> Any:
    assert_ends(nonholo("sweep", _FOLDER / f"{name}.toml", "--members", members, "-o", "s.zarr", "-q"), 0)
    assert Path("s.png").exists()
    return nh.load_sweep("s.zarr").load()


@pytest.mark.profile("routes", instead="test_deviation_of_one_orbit")
def test_turning_sweep_shows_the_closed_form(nonholo: Command) -> None:
    """The lowest row deviates by h^2 J / (24 (1 + J)^2); below the bound no member is lost, most are above."""
    result = _swept(nonholo, "sleigh_turning_sweep", 400)
    J, h = result["inertia"].values, result["time_step"].values
    row = result["turning_deviation"].values[:, 0] / (h[0] ** 2 * J / (24 * (1 + J) ** 2))
    assert np.abs(row - 1).max() < 0.01  # 0.3 h^2, with h = 0.1
    sleighs = [nh.discretize(nh.ChaplyginSleigh(1.0, inertia, 1.0), 1.0) for inertia in J]
    bound = np.sqrt([2 * nh.single_valued_region(sleigh).principal_energy for sleigh in sleighs])
    lost = result["outcome"].values != 0
    below = h < bound[:, None]
    assert not lost[below].any()
    assert lost[~below].mean() > 0.5


@pytest.mark.profile("problems", instead="test_deviation_of_one_orbit")
def test_random_tops_keep_their_branch_below_the_saddle(nonholo: Command) -> None:
    """No top whose energy is below its saddle loses its branch; of those above twice that, none keeps it."""
    result = _swept(nonholo, "random_tops_sweep", 100)
    tops = [nh.discretize(nh.SuslovTop(J), 1.0) for J in result["mass_tensor"].values]
    momenta = np.stack([result["momentum_0"], result["momentum_1"]], axis=1)
    saddles = [nh.critical_energies(top).saddle for top in tops]
    energies = [float(top.system.constrained_energy(p)) for top, p in zip(tops, momenta, strict=True)]
    part, successful = np.array(energies) / np.array(saddles, dtype=float), result["outcome"].values == 0
    assert successful[part < 1].all()
    assert not successful[part > 2].any()
    assert 10 < (part < 1).sum() < 90
    assert np.nanmax(result["energy_drift"]) < 2e-15
