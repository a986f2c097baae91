"""Every kind of body: its built-in scenario, its store, its refusals."""

import functools
import tomllib
from pathlib import Path

import numpy as np
import pytest
from commands import Command, Figures, assert_ends, assert_shows, json_of, problems_of, scenario_of

import nonholo as nh
from nonholo.cli.scenario.bodies import SHORT, body_table, own_kinds
from nonholo.cli.scenario.files import built_in, effective_text, load_scenario
from nonholo.systems import SYSTEMS, ArrowheadSleigh, ArrowheadTop

EXACT = {"suslov", "sleigh", "multidimensional_sleigh", "rigid_body", "left_invariant"}
HEISENBERG = "{basis = [[[0,1,0],[0,0,0],[0,0,0]], [[0,0,0],[0,0,1],[0,0,0]], [[0,0,1],[0,0,0],[0,0,0]]]}"
OWN = f"""
[body]
kind = "left_invariant"
group = {HEISENBERG}
inertia_operator = [[2, 0, 0], [0, 1, 0], [0, 0, 1]]
annihilator = [[0, 0, 1]]
[start]
restricted_velocity = [0.5, 0.2]
[run]
time_step = 0.1
steps = 3
"""

_problems = functools.partial(problems_of, load_scenario)


def test_kinds_are_the_same_everywhere() -> None:
    """Every system is a kind by the name of its class; those with a word of their own have a built-in scenario.

    Arrowheads have none: they are made for more dimensions than one writes into a file.
    """
    assert set(SHORT) == set(built_in())
    assert {tomllib.loads(text)["body"]["kind"] for text in built_in().values()} == set(SHORT)
    assert {type(load_scenario(kind, []).scenario.body.creation) for kind in SHORT} == (
        set(SYSTEMS) - {ArrowheadTop, ArrowheadSleigh}
    )
    assert {body_table(kind).make for kind in own_kinds()} == set(SYSTEMS)
    assert all(body_table(each.__name__).make is each for each in SYSTEMS)


@pytest.mark.profile("routes", keep=["suslov", "right_invariant"])
@pytest.mark.parametrize("kind", SHORT)
def test_built_in_scenario(kind: str, figures: Figures, nonholo: Command) -> None:
    """Each runs to its end, conserves what it says, and its store is shown and drawn again."""
    report = figures(kind, "-o", "a.zarr")
    assert report["outcome"] == "successful"
    assert report["energy_is_exact"] == (kind in EXACT)
    assert (report["energy_drift"] < 1e-13) == (kind in EXACT)  # the others oscillate by 1e-5 and more
    for name in ("constraint_residual", "group_residual", "reversal_defect"):
        assert report[name] < 1e-13, name
    again = json_of(nonholo("info", "a.zarr", "--json"))
    assert again["energy_drift"] == report["energy_drift"]
    assert again["body"] == report["body"]
    assert nonholo("plot", "a.zarr").stderr == ""
    assert Path("a.png").stat().st_size > 10_000


@pytest.mark.parametrize("kind", SHORT)
def test_template(kind: str, nonholo: Command) -> None:
    """What `new` writes is the built-in scenario with its comments, and every key of a run is in it."""
    written = nonholo("new", kind).stdout
    assert written == built_in()[kind]
    assert written.count("#") > 8
    assert [line for line in written.splitlines() if len(line) > 120] == []
    for key in ("title", "time_step", "steps", "save_every", "difference", "constraint", "branch", "plot", "gif"):
        assert f"\n{key} = " in written, key


def test_systems_lists_every_kind(nonholo: Command) -> None:
    """`systems` names each kind and each title."""
    titles = [tomllib.loads(text)["title"] for text in built_in().values()]
    assert_shows(nonholo("systems"), *built_in(), *(title.split()[0] for title in titles))


def test_the_free_body_tumbles(figures: Figures) -> None:
    """Body axis 3 goes over to the opposite side and back, as the title says."""
    height = nh.load_orbit(figures("rigid_body")["store"]).body_velocity[:, 2]
    assert np.count_nonzero(np.diff(np.sign(height))) == 2
    assert height.min() < -0.99


@pytest.mark.parametrize("kind", ["multidimensional_sleigh", "left_invariant"])
def test_bodies_in_space_turn_round(kind: str, figures: Figures) -> None:
    """The sleigh and the dart start backwards and end forwards, their reference point moving along body axis 1."""
    orbit = nh.load_orbit(figures(kind)["store"])
    along = orbit.body_velocity[:, 3]
    assert along[0] < -0.9
    assert along[-1] > 0.9
    assert np.abs(orbit.body_velocity[:, 4:]).max() < 1e-15


def test_the_plate_turns_as_it_passes(figures: Figures) -> None:
    """What is over the blade moves along it; the plate comes from the left, turns and leaves to the right."""
    orbit = nh.load_orbit(figures("right_invariant")["store"])
    carried = np.einsum(
        "kij,kjl,klm->kim", orbit.configuration, nh.SE(2).hat(orbit.body_velocity), np.linalg.inv(orbit.configuration)
    )
    assert np.abs(carried[:, 1, 2]).max() < 1e-14
    assert orbit.position[0, 0] < -1 < 1 < orbit.position[-1, 0]
    assert np.ptp(orbit.heading) > 0.5


def test_table_says_what_to_expect_of_the_energy(nonholo: Command) -> None:
    """The row of the energy drift says whether a theorem makes it exact, for runs and for stores."""
    assert_shows(nonholo("simulate", "suslov", "--no-plot", "--steps", 20), "exact by theorem")
    other = nonholo("simulate", "veselova", "--no-plot", "--steps", 20)
    for text in (other, nonholo("info", "runs/veselova-001.zarr")):
        assert_shows(text, "not exact for this discretization")


def test_group_and_large_matrices_in_the_table(nonholo: Command) -> None:
    """The table names the group; matrices too wide for it are described by their shape."""
    body = f"body={{kind='rigid_body', mass_tensor={np.diag([1.0, 2.0, 3.0, 4.0, 5.0]).tolist()}}}"
    settings = ("--set", body, "--set", f"start={{restricted_velocity={[0.1] * 10}}}")
    assert_shows(nonholo("simulate", "rigid_body", "--no-plot", "--steps", 3, *settings), "SO(5)", "10 x 10")


def test_own_group_is_read_and_written() -> None:
    """A group given by its basis survives the text that a store keeps, exactly."""
    scenario = scenario_of(load_scenario, OWN)
    assert scenario.body.creation.group == nh.MatrixGroup(tomllib.loads(OWN)["body"]["group"]["basis"])
    assert type(scenario).model_validate(tomllib.loads(effective_text(scenario))) == scenario


def test_a_form_makes_the_energy_exact() -> None:
    """With a form beside the basis a mass tensor is taken, and the discretization is that of the theorem."""
    lorentz = "{ basis = [[[0,0,0],[0,0,1],[0,1,0]],[[0,0,1],[0,0,0],[1,0,0]],[[0,1,0],[-1,0,0],[0,0,0]]] }"
    text = OWN.replace(str(HEISENBERG), lorentz.replace(" }", ", form = [[1,0,0],[0,1,0],[0,0,-1]] }"))
    mass = "mass_tensor = [[1, 0, -0.3], [0, 2, 0], [0.3, 0, -4]]"
    scenario = scenario_of(load_scenario, text.replace("inertia_operator = [[2, 0, 0], [0, 1, 0], [0, 0, 1]]", mass))
    discrete = scenario.discretization()
    assert (discrete.difference, discrete.constraint) == ("matrix", "skew")
    assert discrete.conserves_energy
    assert type(scenario).model_validate(tomllib.loads(effective_text(scenario))) == scenario
    assert _problems(text.replace("0,0,-1]] }", "0,0,1]] }"))


def test_defaults_are_those_of_the_library() -> None:
    """Without difference and constraint the library chooses, and what it chose is what a store keeps."""
    scenario = scenario_of(load_scenario, OWN)
    discrete = scenario.discretization()
    for chosen in (discrete, scenario.in_force(discrete).run):
        assert (chosen.difference, chosen.constraint) == ("logarithmic", "exponential")


def test_what_a_group_does_not_allow_is_told_with_its_key(nonholo: Command) -> None:
    """The matrix difference on a group of the user's own ends with the reason, the remedy and exit code 2."""
    Path("my.toml").write_text(OWN)
    ended = nonholo("simulate", "my.toml", "--set", 'run.difference="matrix"')
    assert_ends(ended, 2, "run.difference: must be defined for the system", "Pass 'logarithmic'")


@pytest.mark.parametrize(
    ("group", "message"),
    [
        ('"SO(1)"', "body.group: must be a name such as"),
        ('"GL(2)"', "Got 'GL(2)'"),
        ('"SE(2) x so(3)"', "Got 'so(3)'"),
        ("3", "body.group: must be a name such as"),
        ("{bassis = []}", "body.group.bassis: is not a known key. Did you mean basis?"),
        ("{basis = [[[0,1],[0,0]], [[0,0],[1,0]]]}", "body.group.basis: must span a Lie algebra"),
    ],
)
def test_groups_that_are_none(group: str, message: str) -> None:
    """A group that cannot be read is reported with its key path and what a group looks like."""
    result = _problems(OWN.replace(HEISENBERG, group))
    assert any(message in problem for problem in result), result


def test_one_energy_and_one_constraint() -> None:
    """Two ways to say the same that do not fit, and two energies, are refused by name."""
    both = _problems(OWN.replace("annihilator", "constraint_subspace = [[1, 0, 0]]\nannihilator"))
    assert both[0].startswith("my.toml: body.annihilator: must have 2 rows, the codimension")
    none = _problems(OWN.replace("inertia_operator", "mass_tensor = [[1]]\ninertia_operator"))
    assert "mass_tensor" in none[0]


@pytest.mark.parametrize(
    ("kind", "setting", "message"),
    [
        ("rigid_body", "body.mass_tensor=[[1,0],[0,1]]", "body.mass_tensor: must"),
        ("veselova", "body.mass_tensor=[[1,0,0],[0,0,0],[0,0,0]]", "body.mass_tensor: must make the inertia operator"),
        ("multidimensional_sleigh", "body.center_of_mass=[1,2]", "body.center_of_mass: must have at least 3"),
        ("left_invariant", "body.constraint_subspace=[[1,0,0,0,0,0],[2,0,0,0,0,0]]", "must have linearly independent"),
        ("right_invariant", "body.mass_tensor=[[1]]", "body.mass_tensor: must have shape (3, 3)"),
        ("suslov", "body.axis=[0,0,2]", "body.axis: must be a unit vector"),
        ("suslov", "body.mass_tensor=[[1,0,0.5],[0,1,0],[0,0,1]]", "must be symmetric. Got entries 0.5 and 0.0"),
    ],
)
def test_physical_refusals_have_key_paths(kind: str, setting: str, message: str) -> None:
    """What the library refuses about a body is reported with the option and the key that it came from."""
    result = _problems(built_in()[kind], setting)
    assert len(result) == 1
    assert result[0].startswith(f"--set {setting}: body")
    assert message in result[0]
