"""Every ready example from the command line: run, page, sweep, picture, template; files of a user; data sets."""

import json
import re
import sys
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from commands import Command, assert_ends, json_of, output_of, scenario_of

import nonholo as nh
from nonholo.cli.scenario.bodies import examples
from nonholo.cli.scenario.files import load_scenario, parse_setting
from nonholo.ensembles import DEFINITIONS

NAMES = sorted(name for name in nh.examples.__all__ if name.islower())
QUICK = ["particle", "heavy_suslov_top"]  # in coordinates, and on a group
VARIED = {
    "chaotic_quartic_oscillator": ("start.body_velocity_1", [0.1, 0.2]),
    "non_reversible": ("body.turning", [2.5, 2.6]),
    "bicycle": ("body.speed", [4.6, 4.7]),
    "rattleback": ("body.spin", [4.0, 5.0]),
    "heavy_suslov_top": ("body.velocity_0", [0.5, 0.6]),
}
"""What a sweep varies where there is no mass; of the oscillators, whose start says their energy, one velocity."""


def test_they_are_the_public_ones() -> None:
    """The kinds of the command line are the functions of `nh.examples`."""
    assert examples() == {name: getattr(nh.examples, name) for name in NAMES}


@pytest.mark.profile("routes", keep=["*particle*"])
@pytest.mark.parametrize("name", NAMES)
def test_every_example(name: str, nonholo: Command) -> None:
    """It runs as in Python, from its own start; its store is shown and drawn; its page and a sweep of two are made."""
    orbit = getattr(nh.examples, name)().simulate(steps=6)
    report = json_of(nonholo("simulate", name, "--steps", 6, "-o", "a.zarr", "--json"))
    assert report["outcome"] == "successful"
    np.testing.assert_array_equal(nh.load_orbit("a.zarr").configuration, orbit.configuration)
    assert Path("a.png").stat().st_size > 5_000
    assert "successful" in output_of(nonholo("info", "a.zarr"))
    assert "a-overview.png" in output_of(nonholo("plot", "a.zarr", "--kind", "all", "--dpi", 30))
    assert output_of(nonholo("explore", name, "--steps", 6, "-o", "page.html", "--no-browser")) == "page.html\n"
    assert Path("page.html").stat().st_size > 50_000
    path, values = VARIED.get(name, ("body.mass", [1.0, 1.5]))
    design = f'[design]\nkind = "grid"\n[design.values]\n"{path}" = {values}'
    Path("many.toml").write_text(f'[body]\nkind = "{name}"\n[run]\nsteps = 6\n{design}')
    output_of(nonholo("sweep", "many.toml", "-o", "s.zarr", "-q"))
    assert (nh.load_sweep("s.zarr")["steps_done"].values == 6).all()


def test_another_speed_keeps_the_pose_of_the_example() -> None:
    """A start that says how fast alone begins at the pose of the example; one that says where, at its speed."""
    ready = nh.examples.snakeboard()
    for name in ("momentum", "body_velocity"):
        start = load_scenario("snakeboard", [parse_setting(f"start.{name}=[1.0, 0.0, 0.0, 0.0, 0.0]")]).scenario.start
        assert start.configuration == ready.configuration.tolist()
        assert start.model_dump(exclude_none=True).keys() == {name, "configuration"}
    start = load_scenario("snakeboard", [parse_setting("start.configuration=[0.0, 0.0, 0.0, 0.0, 0.5]")]).scenario.start
    assert (start.configuration[-1], start.body_velocity) == (0.5, ready.body_velocity.tolist())


@pytest.mark.profile("routes", keep=[f"*{name}*" for name in QUICK])
@pytest.mark.parametrize("name", NAMES)
def test_every_template(name: str, nonholo: Command) -> None:
    """What `new` writes has every argument with its meaning, and is the scenario that the bare name runs."""
    text = output_of(nonholo("new", name))
    assert max(map(len, text.splitlines())) <= 120
    body = tomllib.loads(text)["body"]
    named, written = load_scenario(name, []).scenario, scenario_of(load_scenario, text)
    assert (written.body, written.start, written.run) == (named.body, named.start, named.run)
    assert body.pop("kind") == name
    assert text.count("#") > len(body)


ROBOT = '''
"""A robot of mine."""
import types

import jax.numpy as jnp
import nonholo as nh


def cart(mass: float = 1.0, speed: float = 0.5):
    """A cart that moves along x alone.

    Args:
        mass: m, of the cart.
        speed: x' at the start.
    """
    system = nh.LagrangeDAlembert(
        lambda q, v, p: 0.5 * p["mass"] * (v @ v) - 0.5 * q @ q,
        lambda q, p: jnp.array([[0.0, 1.0]]),
        dimension=2,
        coordinates=("x", "y"),
        parameters={"mass": mass},
    )
    start = {"configuration": [0.3, 0.0], "body_velocity": [speed, 0.0]}
    return types.SimpleNamespace(system=system, time_step=0.1, steps=8, **start)


def plank(mass: float):
    """A sleigh of this mass [/kg]."""
    return nh.ChaplyginSleigh(mass, 1.0, 0.3)


def bare(mass: float):
    return nh.ChaplyginSleigh(mass, 1.0, 0.3)
'''
SWEEP = """
[body]
kind = "cart"
[design]
kind = "random"
members = 4
[design.values]
"body.mass" = {uniform = [1.0, 2.0]}
"body.speed" = {normal = [0.5, 0.1]}
"""


@pytest.fixture
def robot(monkeypatch: pytest.MonkeyPatch) -> Path:
    """A file of a user's own, forgotten after the test."""
    monkeypatch.setattr(sys, "path", [*sys.path])
    monkeypatch.delitem(sys.modules, "cart_of_mine", raising=False)
    path = Path("cart_of_mine.py")
    path.write_text(ROBOT)
    return path


def test_a_body_of_ones_own(robot: Path, nonholo: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    """Functions of a file that is named are kinds of bodies: run, listed, a template, a page, a run."""
    own = ("--module", robot)
    monkeypatch.setenv("COLUMNS", "200")
    listed = output_of(nonholo("systems", *own))
    assert re.findall(r"^│ (cart|plank|bare) +│ (.*?) +│", listed, re.MULTILINE) == [
        ("cart", "A cart that moves along x alone."),
        ("plank", "A sleigh of this mass [/kg]."),
        ("bare", ""),
    ]
    Path("cart.toml").write_text(output_of(nonholo("new", "cart", *own)))
    assert "mass = 1.0  # m, of the cart." in Path("cart.toml").read_text()
    report = json_of(nonholo("simulate", "cart.toml", *own, "--json", "-o", "c.zarr", "--set", "body.mass=2.0"))
    assert (report["steps"], report["outcome"]) == (8, "successful")
    orbit = nh.load_orbit("c.zarr")
    system = sys.modules["cart_of_mine"].cart(mass=2.0).system
    again = nh.simulate(nh.discretize(system, 0.1), configuration=[0.3, 0.0], body_velocity=[0.5, 0.0], steps=8)
    np.testing.assert_array_equal(orbit.configuration, again.configuration)
    output_of(nonholo("explore", "cart", *own, "-o", "page.html", "--no-browser"))
    start = "start={restricted_velocity=[0.1, 1.0]}"
    run = ("--set", "run.time_step=0.1", "--steps", 4)
    output_of(nonholo("simulate", "plank", *own, *run, "--set", "body.mass=2.0", "--set", start, "--no-plot"))


@pytest.mark.profile("routes", instead="test_a_function_in_a_file_is_a_data_set")
def test_a_sweep_over_a_body_of_ones_own(robot: Path, nonholo: Command) -> None:
    """Members are those of the file's function; the store is resumed with the file, and not without."""
    Path("many.toml").write_text(SWEEP)
    output_of(nonholo("sweep", "many.toml", "--module", robot, "-o", "s.zarr", "--no-plot", "-q"))
    swept = nh.load_sweep("s.zarr").load()
    member = sys.modules["cart_of_mine"].cart(float(swept["mass"][2]), float(swept["speed"][2]))
    start = {"configuration": member.configuration, "body_velocity": member.body_velocity}
    orbit = nh.simulate(nh.discretize(member.system, 0.1), **start, steps=8)
    np.testing.assert_array_equal(swept["final_configuration"][2], orbit.configuration[-1])
    assert nonholo("resume", "s.zarr").exit_code == 2  # it names what it would run
    output_of(nonholo("resume", "s.zarr", "--module", robot))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("simulate", "cart"), "there is no such file, and no built-in scenario of this name"),
        (("simulate", "LLSystem"), "`nonholo new LLSystem` writes one."),
        (("simulate", "cart", "--module", "none.py"), "must be the path of a Python file. Got 'none.py'"),
        (("simulate", "cart", "--module", "json.py"), "but there is a module json at"),
        (("simulate", "cart", "--module", "broken.py"), "cannot be used. SyntaxError"),
        (("simulate", "cart", "--module", "leaving.py"), "cannot be used. SystemExit: 3"),
        (("simulate", "cart", "--module", "cart_of_mine.py", "--set", "body.mas=1"), "Did you mean mass?"),
        (("simulate", "snakebord"), "Did you mean snakeboard or snake? Your own functions are kinds with --module"),
        (("simulate", "particle", "--set", "body.mass=-1"), "body.mass: must be positive. Got -1"),
        (("simulate", "particle", "--set", "body.planar_velocity=[1]"), "body.planar_velocity: must have shape (2,)"),
        (("new", "snakebord"), "Did you mean snakeboard or snake?"),
        (("examples", "snakbord"), "Did you mean snakeboard?"),
    ],
)
@pytest.mark.usefixtures("robot")
def test_refusals(arguments: tuple[str, ...], message: str, nonholo: Command) -> None:
    """A file is never imported unasked; what is wrong with one, or with the numbers of an example, is said."""
    Path("json.py").write_text("")
    Path("broken.py").write_text("def cart(:")
    Path("leaving.py").write_text("raise SystemExit(3)")
    assert_ends(nonholo(*arguments), 2, message)


def test_every_data_set_is_listed(nonholo: Command) -> None:
    """The list has each name and what moves."""
    text = nonholo("dataset", "--list").stdout
    assert all(name in text for name in DEFINITIONS)


def _written(nonholo: Command, *arguments: str) -> dict[str, Any]:
    """Write a data set, return its record, and write the same numbers again by the command of that."""
    output_of(nonholo("dataset", *arguments, "-o", "first"))
    record = json.loads(Path("first/metadata.json").read_text())
    command = record["command"].split()[1:]
    command[command.index("-o") + 1] = "again"
    output_of(nonholo(*command))
    assert json.loads(Path("again/metadata.json").read_text())["fields"] == record["fields"]
    return record


def test_it_writes_what_python_writes(nonholo: Command) -> None:
    """The command and the function have the same numbers; the command of the record writes them again."""
    small = ("--orbits", "5", "--steps", "3", "--noise", "0.1", "--split", "0.6/0.2/0.2", "--rng", "2")
    record = _written(nonholo, "sleigh", *small)
    nh.dataset("sleigh", "python", orbits=5, steps=3, noise=0.1, split=(0.6, 0.2, 0.2), rng=2)
    assert json.loads(Path("python/metadata.json").read_text())["fields"] == record["fields"]
    assert output_of(nonholo("dataset", "sleigh", "-o", "quiet", *small, "-q")) == "quiet\n"


def test_a_function_in_a_file_is_a_data_set(nonholo: Command) -> None:
    """The record names the file; its command writes the same numbers again."""
    lines = ("from types import SimpleNamespace", "import numpy as np", "import nonholo as nh")
    lines += ("def blades(speed=nh.Uniform(0.5, 1.0), a=nh.Uniform(0.1, 0.4)):",)
    lines += ("    start = {'configuration': np.eye(3), 'body_velocity': [0.2, speed, 0.0]}",)
    lines += ("    return SimpleNamespace(system=nh.ChaplyginSleigh(1.0, 1.0, a), **start)",)
    Path("own_blades.py").write_text("\n".join(lines))
    record = _written(nonholo, "blades", "--module", "own_blades.py", "--orbits", "4", "--steps", "3")
    assert "own_blades.py" in record["command"]


def test_errors_are_sentences(nonholo: Command) -> None:
    """A name, a folder or fractions that are missing or wrong leave with a sentence and code 2."""
    Path(".cache").mkdir()
    Path("mine.txt").touch()
    for arguments, said in {
        (): "--list",
        ("sleigh",): "-o FOLDER",
        ("slegh", "-o", "new"): "'sleigh'",
        ("sleigh", "-o", "new", "--split", "a/b"): "0.8/0.1/0.1",
        ("sleigh", "-o", "new", "--module", "none.py"): "path of a Python file",
        ("sleigh", "-o", ".cache/..", "--orbits", "2"): "must be new",
    }.items():
        assert_ends(nonholo("dataset", *arguments), 2, said)
