"""Maps of sweeps: cells stand where the values are, and members that failed are not drawn as data."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray
from matplotlib.colors import BoundaryNorm, LogNorm, Normalize, to_rgba

import nonholo as nh
from nonholo.plot._sweep_map import borders, is_geometric

A, B = np.array([1.0, 2.0, 4.0]), np.array([0.0, 1.0, 2.0, 3.0])


def _numbers(block: nh.MemberBlock) -> dict[str, Any]:
    """Two numbers of each member; those with b = 2 end as no_real_branch, those with b = 3 as raised ones do."""
    b = block["b"]
    value = block["a"] + 10 * b
    ended = np.where(b == 2, 1, np.where(b == 3, 2, 0))
    report = {"long_name": "a number", "units": "rad"}
    return {"value": ((), value, report), "many": (("part",), value[:, None] * [1, 2]), "outcome": ended}


@pytest.fixture(scope="module")
def plane(tmp_path_factory: pytest.TempPathFactory) -> xarray.Dataset:
    """A grid of three by four members."""
    return nh.sweep(_numbers, nh.Grid({"a": A, "b": B}), tmp_path_factory.mktemp("plane") / "s.zarr").load()


def _drawn(block: nh.MemberBlock) -> dict[str, Any]:
    """Ones and twos, a wide number, and the outcome of the first function."""
    a, b = block["a"], block["b"]
    return {"whole": np.where(a > 3, 2, 1), "wide": 10**a, "outcome": np.where(b > 2, 1, 0)}


@pytest.fixture(scope="module")
def draws(tmp_path_factory: pytest.TempPathFactory) -> xarray.Dataset:
    """Four hundred random members."""
    design = nh.RandomDesign(400, {"a": nh.Uniform(0, 4), "b": nh.Uniform(0, 3)}, rng=2)
    return nh.sweep(_drawn, design, tmp_path_factory.mktemp("draws") / "s.zarr").load()


def _legend(picture: Any) -> list[str]:
    legend = picture.axes.get_legend()
    return [] if legend is None else [text.get_text() for text in legend.get_texts()]


def test_borders_of_a_geometric_axis() -> None:
    """Values with one quotient lie in the geometric middle of their cells, evenly spaced ones in the middle."""
    assert np.allclose(borders(A), np.sqrt(2) ** np.array([-1, 1, 3, 5]), rtol=1e-15)
    assert borders(B).tolist() == [-0.5, 0.5, 1.5, 2.5, 3.5]
    assert borders(np.array([7.0])).tolist() == [6.5, 7.5]


@pytest.mark.parametrize(("values", "message"), [(A, True), (B, False), (A[:2], False), (-A, False), (B + 1, False)])
def test_geometric_axes(values: np.ndarray, message: bool) -> None:
    """An axis is geometric if its values are positive with one quotient and without one difference."""
    assert is_geometric(values) is message


def test_each_value_is_in_its_cell(plane: xarray.Dataset) -> None:
    """The color of a cell is the value of the member in it; the cells of members that failed are empty."""
    picture = nh.plot.sweep_map(plane, "value")
    values = picture.drawn.get_array()
    assert values.shape == (4, 3)
    expected = A + 10 * B[:, None]
    assert np.array_equal(values[:2], expected[:2])
    assert values.mask[2:].all()
    corners = picture.drawn.get_coordinates()
    assert np.allclose(corners[0, :, 0], borders(A))
    assert np.allclose(corners[:, 0, 1], borders(B))
    assert (picture.axes.get_xscale(), picture.axes.get_yscale()) == ("log", "linear")


def test_members_that_failed_are_named_and_counted(plane: xarray.Dataset) -> None:
    """Each outcome but success has cells of its own, and a line in the legend with its count."""
    picture = nh.plot.sweep_map(plane, "value")
    assert _legend(picture) == ["no real branch (3)", "branch unverified (3)"]
    rows = [np.flatnonzero(~mesh.get_array().mask.all(axis=1)).tolist() for mesh in picture.ended]
    assert rows == [[2], [3]]
    colors = [mesh.get_cmap()(0) for mesh in picture.ended]
    assert colors[0] == to_rgba("#cfd3da")
    assert colors[0] != colors[1]


def test_labels_and_units(plane: xarray.Dataset) -> None:
    """Title, axes and key bear the names, with units where there are any."""
    picture = nh.plot.sweep_map(plane, "value")
    assert picture.axes.get_title(loc="left") == "A number"
    assert (picture.axes.get_xlabel(), picture.axes.get_ylabel()) == ("a", "b")
    assert picture.colorbar is not None
    assert picture.colorbar.ax.get_ylabel() == "value  [rad]"
    default = nh.plot.sweep_map(plane)  # the first quantity with one number for each member, not the outcome
    assert default.axes.get_title(loc="left") == "A number"


def test_axes_can_be_exchanged(plane: xarray.Dataset) -> None:
    """With y given the other axis runs across, and the values are transposed."""
    one, other = nh.plot.sweep_map(plane, "value"), nh.plot.sweep_map(plane, "value", y="a")
    assert other.axes.get_xlabel() == "b"
    assert np.array_equal(one.drawn.get_array().filled(0), other.drawn.get_array().filled(0).T)


def test_descending_values_are_sorted(tmp_path: Path) -> None:
    """The order of the values of a design does not change the picture."""
    result = nh.sweep(_numbers, nh.Grid({"a": A[::-1], "b": B}), tmp_path / "s.zarr")
    assert np.array_equal(nh.plot.sweep_map(result, "value").drawn.get_array()[0], A)


def test_outcomes_as_a_map(plane: xarray.Dataset) -> None:
    """The quantity "outcome" shows success too, without a key of colors."""
    picture = nh.plot.sweep_map(plane, "outcome")
    assert _legend(picture) == ["successful (6)", "no real branch (3)", "branch unverified (3)"]
    assert picture.colorbar is None


def test_curve_along_one_axis(plane: xarray.Dataset) -> None:
    """With one axis the quantity is a curve; members that failed are marked below; the rest is in the title."""
    picture = nh.plot.sweep_map(plane.sel(a=2.0), "value")
    x, y = picture.drawn.get_data()
    assert np.array_equal(x, B)
    assert np.array_equal(y, [2.0, 12.0, np.nan, np.nan], equal_nan=True)
    assert [mark.get_offsets()[:, 0].tolist() for mark in picture.ended] == [[2.0], [3.0]]
    assert picture.axes.get_title(loc="left") == "A number, a = 2"
    assert picture.axes.get_xlim()[1] >= 3.0


def test_histogram(draws: xarray.Dataset) -> None:
    """Without x and y the members that succeeded are counted; all of them are in some bar."""
    picture = nh.plot.sweep_map(draws, "wide")
    good = int((draws["outcome"] == 0).sum())
    assert sum(bar.get_height() for bar in picture.drawn) == good
    assert _legend(picture) == [f"no real branch ({400 - good})"]
    assert picture.axes.get_xscale() == "log"


def test_dots_over_one_number(draws: xarray.Dataset) -> None:
    """Over x alone the quantity runs up; members that failed are marked along the bottom."""
    picture = nh.plot.sweep_map(draws, "wide", x="a")
    good = (draws["outcome"] == 0).values
    assert np.allclose(picture.drawn.get_offsets(), np.c_[draws["a"], draws["wide"]][good])
    assert np.allclose(picture.ended[0].get_offsets()[:, 0], draws["a"].values[~good])


def test_colored_dots_over_two_numbers(draws: xarray.Dataset) -> None:
    """Over x and y the quantity is the color; few whole numbers have one color each."""
    picture = nh.plot.sweep_map(draws, "whole", x="a", y="b")
    good = (draws["outcome"] == 0).values
    assert np.array_equal(picture.drawn.get_array(), draws["whole"].values[good])
    assert isinstance(picture.drawn.norm, BoundaryNorm)
    assert picture.colorbar is not None
    assert [tick.get_text() for tick in picture.colorbar.ax.get_yticklabels()] == ["1", "2"]
    assert len(picture.ended[0].get_offsets()) == (~good).sum()


@pytest.mark.parametrize(("quantity", "scale"), [("wide", LogNorm), ("a", Normalize)])
def test_scale_of_the_colors(draws: xarray.Dataset, quantity: str, scale: type) -> None:
    """Positive numbers over orders of magnitude are colored by their logarithm, others evenly."""
    assert type(nh.plot.sweep_map(draws, quantity, x="a", y="b").drawn.norm) is scale


def test_bars_of_outcomes(draws: xarray.Dataset) -> None:
    """The outcomes of draws are one bar each."""
    picture = nh.plot.sweep_map(draws, "outcome")
    good = int((draws["outcome"] == 0).sum())
    assert [bar.get_width() for bar in picture.drawn] == [good, 400 - good]


@pytest.mark.parametrize(
    ("result", "arguments", "message"),
    [
        ("space", {"quantity": "nothing"}, "must be one of 'value', 'many', 'outcome'|must be one of 'many'"),
        ("space", {"quantity": "many"}, "Pass result.isel\\(part=0\\)"),
        ("space", {"x": "d"}, "must be one of 'a', 'b', 'c'. Got 'd'"),
        ("space", {"quantity": "value"}, "must have at most two free axes. Got also c. Pass result.sel\\(c="),
        ("plane", {"quantity": "value", "x": "a", "y": "a"}, "Got 'a' twice"),
        ("draws", {"quantity": "wide", "y": "b"}, "must come with x"),
        ("draws", {"quantity": "wide", "x": "c"}, "must be one of .* Got 'c'. Choose one number of each member"),
        ("one member", {"quantity": "value"}, "Got one member"),
        ("nothing", {}, "Got Dataset. Pass what nh.sweep or nh.load_sweep returned"),
    ],
)
def test_what_is_refused(
    plane: xarray.Dataset, draws: xarray.Dataset, result: str, arguments: dict[str, str], message: str
) -> None:
    """A quantity or an axis that is not there, an axis twice or too many, no axes, and draws over y alone."""
    results = {"plane": plane, "draws": draws, "nothing": xarray.Dataset()}
    results |= {"one member": plane.isel(a=0, b=0), "space": plane.expand_dims(c=[5.0, 6.0], axis=2)}
    with pytest.raises(ValueError, match=message):
        nh.plot.sweep_map(results[result], **arguments)


def test_draws_that_all_failed(draws: xarray.Dataset) -> None:
    """Draws without success still have their marks, dots and counts."""
    lost = draws.isel(member=np.flatnonzero(draws["outcome"].values))
    for places in ({}, {"x": "a"}, {"x": "a", "y": "b"}):
        picture = nh.plot.sweep_map(lost, "wide", **places)
        assert _legend(picture) == [f"no real branch ({lost.sizes['member']})"]


def test_axis_of_vectors_is_numbered(tmp_path: Path) -> None:
    """Vectors along an axis of a grid have no place on it but their number."""
    design = nh.Grid({"v": [[1.0, 0.0], [0.0, 1.0], [1.0, 1.0]]})
    result = nh.sweep(lambda block: {"value": block["v"].sum(axis=1)}, design, tmp_path / "s.zarr")
    assert nh.plot.sweep_map(result, "value").drawn.get_xydata().tolist() == [[0, 1], [1, 1], [2, 2]]
