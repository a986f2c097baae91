"""The overview: its panels for every kind of orbit, its files, and that no settings leak."""

import dataclasses
import errno
import functools
from pathlib import Path
from typing import Any, NamedTuple

import matplotlib as mpl
import numpy as np
import pytest
from bodies import elsewhere
from PIL import Image
from plot.runs import MASS_TENSOR, frames_of, top_run
from stopping import stopped_in

import nonholo as nh
from nonholo.plot.sheets import on_plane, plane_inertia, sheet_of


def test_series_are_the_velocities(top_orbit: nh.Orbit, sleigh_orbit: nh.Orbit) -> None:
    """The panels of velocity hold the free components; those of the sleigh its heading over pi and its speed."""
    lines = nh.plot.overview(top_orbit).axes[2].lines
    assert np.array_equal(lines[0].get_ydata(), top_orbit.body_velocity[:, 0])
    assert np.array_equal(lines[1].get_ydata(), top_orbit.body_velocity[:, 1])
    figure = nh.plot.overview(sleigh_orbit)
    heading = next(axes for axes in figure.axes if "heading" in axes.get_ylabel())
    speed = next(axes for axes in figure.axes if "speed" in axes.get_ylabel())
    assert np.allclose(heading.lines[0].get_ydata() * np.pi, sleigh_orbit.heading)
    assert np.array_equal(speed.lines[0].get_ydata(), sleigh_orbit.body_velocity[:, 1])


def test_words_name_system_step_and_outcome(sleigh_orbit: nh.Orbit) -> None:
    """The head of the figure tells the parameters, the number and size of steps, and why a run stopped."""
    words = " ".join(text.get_text() for text in nh.plot.overview(sleigh_orbit).texts)
    assert "Chaplygin sleigh" in words
    assert "$a$ = 0.5,  $b$ = 0.3" in words
    assert "200 steps of $h$ = 0.1" in words
    discrete = nh.discretize(nh.SuslovTop(MASS_TENSOR), 1.0)
    stopped = nh.simulate(discrete, body_velocity=(0.4, 0.9, 0.0), steps=40, throw=False)
    assert any("stopped: no_real_branch" in text.get_text() for text in nh.plot.overview(stopped).texts)


@pytest.mark.profile("paper", keep=["png"])
@pytest.mark.parametrize("suffix", ["png", "svg", "pdf"])
def test_files(suffix: str, sleigh_orbit: nh.Orbit, tmp_path: Path) -> None:
    """The suffix chooses the format, and `Orbit.plot` is the same picture."""
    path = tmp_path / f"picture.{suffix}"
    sleigh_orbit.plot(str(path))
    assert path.stat().st_size > 10_000
    if suffix == "png":
        with Image.open(path) as picture:
            assert picture.size == (1950, 1140)
    if suffix == "svg":
        assert ">Chaplygin sleigh</text>" in path.read_text()


@pytest.mark.parametrize(
    ("draw", "name"), [(nh.Orbit.plot, "a.png"), (functools.partial(nh.plot.animate, frames=2), "a.gif")]
)
def test_older_pictures_are_kept(draw: Any, name: str, sleigh_orbit: nh.Orbit, tmp_path: Path) -> None:
    """A picture at the path is kept unless it is to be replaced; a folder is never replaced."""
    path = tmp_path / name
    path.write_text("mine")
    with pytest.raises(FileExistsError, match=r"must be new\. Got .* or pass overwrite=True"):
        draw(sleigh_orbit, path)
    assert path.read_text() == "mine"
    draw(sleigh_orbit, path, overwrite=True)
    assert path.read_bytes() != b"mine"
    path.unlink()
    path.mkdir()
    with pytest.raises(FileExistsError, match="not a file"):
        draw(sleigh_orbit, path, overwrite=True)


def test_a_picture_that_fails_leaves_nothing(sleigh_orbit: nh.Orbit, tmp_path: Path) -> None:
    """On a full disk an older picture stays as it was, and no part of the new one is left."""
    path, full = tmp_path / "a.png", OSError(errno.ENOSPC, "No space left on device")
    path.write_text("mine")
    words = r"No space left on device\. Nothing at this path was changed"
    with stopped_in("matplotlib.figure.Figure.savefig", full, words):
        sleigh_orbit.plot(str(path), overwrite=True)
    assert [file.read_text() for file in tmp_path.iterdir()] == ["mine"]


def test_global_settings_are_unchanged(sleigh_orbit: nh.Orbit, tmp_path: Path) -> None:
    """Drawing and saving leave matplotlib's settings as they were."""
    before = dict(mpl.rcParams)
    nh.plot.overview(sleigh_orbit, tmp_path / "picture.png")
    assert dict(mpl.rcParams) == before


def test_dots_are_relative_errors(top_orbit: nh.Orbit) -> None:
    """Each dot is (E_k - E_0) / E_0 in units of 1e-16, at its time."""
    drawn = nh.plot.energy_error(top_orbit)
    error = (top_orbit.energy - top_orbit.energy[0]) / top_orbit.energy[0]
    assert drawn.unit == 1e-16
    assert np.allclose(drawn.error.get_offsets(), np.stack([top_orbit.time, error / 1e-16], axis=1))
    low, high = drawn.rounding.get_extents().transformed(drawn.axes.transData.inverted()).intervaly
    assert np.allclose([low, high], [-2.220446049250313, 2.220446049250313])


def test_long_orbits_keep_their_extremes() -> None:
    """The band of a long orbit reaches from the least to the greatest error."""
    orbit = top_run((0.465, 0.75, 0.0), steps=5000)
    vertices = nh.plot.energy_error(orbit).error.get_paths()[0].vertices[:, 1]
    error = (orbit.energy - orbit.energy[0]) / orbit.energy[0] / 1e-16
    assert np.isclose(vertices.min(), error.min())
    assert np.isclose(vertices.max(), error.max())


def test_larger_errors_have_larger_units(top_orbit: nh.Orbit) -> None:
    """Where the energy is not kept, the unit on the axis says so."""
    growing = top_orbit.reduced_momentum * (1 + 1e-3 * np.arange(len(top_orbit)) / len(top_orbit))[:, None]
    drawn = nh.plot.energy_error(dataclasses.replace(top_orbit, reduced_momentum=growing))
    assert drawn.unit == 1e-3
    assert drawn.axes.get_legend() is None  # the band of rounding is too thin to be seen
    assert "10^{-3}" in drawn.axes.get_ylabel()


def test_at_rest_the_error_is_absolute() -> None:
    """A body at rest has no energy to compare with."""
    drawn = nh.plot.energy_error(top_run((0.0, 0.0, 0.0), steps=5))
    assert not np.any(drawn.error.get_offsets()[:, 1])
    assert "/E" not in drawn.axes.get_ylabel()


ARROW = np.array([[1.4, 0.0, 0.5], [0.0, 1.0, -0.3], [0.5, -0.3, 0.9]])
SLEIGH = nh.ChaplyginSleigh(1.0, 1.0, 0.5, 0.3)
BALANCED = nh.ChaplyginSleigh(2.0, 1.0, 0.0, 0.3)


class Pair(NamedTuple):
    """A system by name, and an equal one."""

    named: Any
    equal: Any

    def runs(self, step: float, steps: int) -> list[nh.Orbit]:
        """Run both from one start."""
        start = {"body_velocity": np.array([0.3, -0.8]) @ self.named.constraint_subspace, "steps": steps}
        return [nh.simulate(nh.discretize(system, step), **start) for system in self]


def _by_matrices(system: Any, rows: list[list[float]]) -> nh.LLSystem:
    return nh.LLSystem(system.group, system.homogeneous_mass_tensor, rows @ np.asarray(system.constraint_subspace))


TOP = nh.SuslovTop(MASS_TENSOR)
SAME_AXES = {
    "top": Pair(TOP, nh.LLSystem(nh.SO(3), MASS_TENSOR, annihilator=TOP.annihilator)),
    "arrowhead": Pair(nh.SuslovTop(ARROW), nh.SuslovTop.arrowhead(ARROW.diagonal(), ARROW[2, :2])),
    "sleigh": Pair(SLEIGH, _by_matrices(SLEIGH, [[0, 1], [1, 0]])),
    "balanced sleigh": Pair(BALANCED, _by_matrices(BALANCED, [[2.0, 1.0], [-0.5, 1.0]])),
}
TURNED_SLEIGH = Pair(SLEIGH, elsewhere(SLEIGH, np.random.default_rng(2)))
TURNED_TOP = Pair(TOP, elsewhere(TOP, np.random.default_rng(1)))
EVERY = SAME_AXES | {"turned top": TURNED_TOP, "turned sleigh": TURNED_SLEIGH}
by_pair = pytest.mark.parametrize("pair", SAME_AXES.values(), ids=SAME_AXES)


def _same(one: Any, other: Any) -> None:
    """Compare places of dots in the plane."""
    assert (one is None) == (other is None)
    if one is not None:
        assert len(one.get_offsets()) > 0
        assert np.allclose(one.get_offsets(), other.get_offsets(), atol=1e-9)


@pytest.mark.profile("paper", keep=["sleigh", "arrowhead"])
@by_pair
def test_values(pair: Pair) -> None:
    """All values of the map, on displacements and, where there is a deltoid, on momenta; trees; counts."""
    one, other = pair.runs(0.5, 3)
    for plane in ("displacements", "momenta")[: 1 + sheet_of(pair.named).has_deltoid]:
        options = {"displacement": one.displacement[1], "plane": plane}
        _same(*(nh.plot.branches(each.motion, **options).principal for each in (one, other)))
    trees = [nh.plot.branch_tree(o.motion, nh.branch_tree(o.motion, o.displacement[1], 2)) for o in (one, other)]
    assert np.array_equal(trees[0].counts.get_ydata(), trees[1].counts.get_ydata())
    _same(trees[0].images[1], trees[1].images[1])
    if sheet_of(pair.named).has_deltoid:
        _same(*(nh.plot.branch_counts(o.motion, o).cusps for o in (one, other)))


@pytest.mark.profile("paper", keep=["arrowhead"])
@by_pair
def test_overviews(pair: Pair, tmp_path: Path) -> None:
    """The overview has the same panels and parameters, and says what an LLSystem is; the same frames of animations."""
    orbits = pair.runs(0.1, 30)
    one, other = (nh.plot.overview(orbit) for orbit in orbits)
    assert [axes.get_title(loc="left") for axes in one.axes] == [axes.get_title(loc="left") for axes in other.axes]
    (name, *facts), (recognized, *others) = ([text.get_text() for text in figure.texts] for figure in (one, other))
    assert facts == others
    assert recognized.startswith("LLSystem, a " if type(orbits[1].system) is nh.LLSystem else name)
    assert name.split()[-1] in recognized
    frames = []
    for number, orbit in enumerate(orbits):
        frames.append(frames_of(nh.plot.animate(orbit, tmp_path / f"{number}.gif", frames=2, title="one"))[1])
    assert np.mean(np.abs(frames[0] - frames[1]).max(axis=-1) > 8) < 1e-3  # shades of a palette may differ


@pytest.mark.parametrize("pair", EVERY.values(), ids=EVERY)
def test_ellipses_are_levels_of_the_energy(pair: Pair) -> None:
    """Momenta of one energy, taken along the user's rows by their definition, are on the drawn ellipse."""
    momentum = np.random.default_rng(3).normal(size=(20, 2))
    drawn = on_plane(pair.equal, momentum)
    energy = np.einsum("ki,ki->k", drawn, np.linalg.solve(plane_inertia(pair.equal), drawn.T).T) / 2
    assert np.allclose(energy, pair.equal.constrained_energy(momentum), rtol=1e-12)


@pytest.mark.parametrize("pair", [SAME_AXES["balanced sleigh"], TURNED_SLEIGH], ids=["balanced", "turned"])
def test_blades_by_their_definition(pair: Pair) -> None:
    """Admissible velocities are along the blade, the contact point is next to the origin, the mass where it is."""
    system, group, sheet = pair.equal, nh.SE(2), sheet_of(pair.equal)
    blade, tensor = sheet.variety.blade, system.homogeneous_mass_tensor
    velocities = system.constraint_subspace @ group.adjoint(group.inverse(blade)).T
    assert np.allclose(velocities[:, 2], 0.0, atol=1e-14)
    assert np.isclose(blade[:2, 2] @ blade[:2, 1], 0.0, atol=1e-14)
    assert np.allclose(blade @ [*sheet.center, 1.0], tensor[:, 2] / tensor[2, 2], atol=1e-14)


def test_a_portrait_takes_orbits_of_an_equal_system() -> None:
    """Its class may be another one; orbits of another body are refused: see test_look."""
    same_rows = _by_matrices(SLEIGH, [[1, 0], [0, 1]])
    assert nh.plot.phase_portrait(same_rows, SAME_AXES["sleigh"].runs(0.5, 3)[0]).orbit is not None
