"""What commands refuse so that nothing of the user's is lost or taken for something else, with the remedy."""

from pathlib import Path

import pytest
from commands import Command, assert_ends, words_of

import nonholo as nh

SLEIGH = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1)


@pytest.mark.parametrize(
    ("kind", "told"),
    [
        ("top", "there is no kind 'top'. Did you mean suslov or veselova?"),
        ("slei", "Did you mean sleigh?"),
        ("rigid", "Did you mean rigid_body"),
        ("zebra", "Known: suslov, sleigh, multidimensional_sleigh,"),
    ],
)
def test_unknown_templates_name_the_nearest(kind: str, told: str, nonholo: Command) -> None:
    """A kind that is none is refused in our own words, with the nearest ones."""
    refused = assert_ends(nonholo("new", kind), 2, told)
    assert "Value error" not in words_of(refused)


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


@pytest.mark.parametrize("command", ["simulate", "sweep"])
def test_a_store_is_no_netcdf_file(command: str, nonholo: Command) -> None:
    """A store under the suffix of another format is refused before anything is run."""
    scenario = "sleigh"
    if command == "sweep":
        scenario = "my.toml"
        Path(scenario).write_text(nonholo("new", "sweep").stdout)
    ended = nonholo(command, scenario, "-o", "mine.nc")
    assert_ends(ended, 2, "must be the path of a Zarr store, usually *.zarr. Got 'mine.nc'")
    assert not Path("mine.nc").exists()
