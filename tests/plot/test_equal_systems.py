"""A top or a sleigh that is given as another class has the pictures of the class with its name."""

from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
from PIL import Image
from plot.runs import MASS_TENSOR

import nonholo as nh
from nonholo.plot.sheets import blade_of_system, on_plane, plane_inertia, sheet_of

ARROW = np.array([[1.4, 0.0, 0.5], [0.0, 1.0, -0.3], [0.5, -0.3, 0.9]])
SLEIGH = nh.ChaplyginSleigh(1.0, 1.0, 0.5, 0.3)
BALANCED = nh.ChaplyginSleigh(2.0, 1.0, 0.0, 0.3)


def moved(system: Any, d: np.ndarray) -> nh.LLSystem:
    """Return the same body in body coordinates d x, with rows of the constraint that are mixed."""
    rows = np.array([[2.0, 1.0], [-0.5, 1.0]]) @ system.constraint_subspace @ system.group.adjoint(d).T
    return nh.LLSystem(system.group, d @ system.homogeneous_mass_tensor @ d.T, rows)


def _turn(angle: float, shift: float) -> np.ndarray:
    """Return coordinates of the plane with an origin so far along the blade, and turned."""
    turn, there = nh.SE(2).exp([angle, 0.0, 0.0]), np.eye(3)
    there[0, 2] = -shift
    return turn @ there


class Pair(NamedTuple):
    """A system by name, an equal one, and its body coordinates d x."""

    named: Any
    equal: Any
    d: np.ndarray

    def runs(self, step: float, steps: int) -> tuple[nh.Orbit, nh.Orbit]:
        """Run both from one start."""
        velocity = np.array([0.3, -0.8]) @ self.named.constraint_subspace
        starts = ((self.named, velocity), (self.equal, self.named.group.adjoint(self.d) @ velocity))
        one, other = (nh.simulate(nh.discretize(s, step), body_velocity=v, steps=steps) for s, v in starts)
        return one, other


TOP = nh.SuslovTop(MASS_TENSOR)
SAME_AXES = {
    "top": Pair(TOP, nh.LLSystem(nh.SO(3), MASS_TENSOR, annihilator=TOP.annihilator), np.eye(3)),
    "arrowhead": Pair(nh.SuslovTop(ARROW), nh.SuslovTop.arrowhead(ARROW.diagonal(), ARROW[2, :2]), np.eye(3)),
    "sleigh": Pair(SLEIGH, nh.LLSystem(nh.SE(2), SLEIGH.homogeneous_mass_tensor, [[0, 1, 0], [1, 0, 0]]), np.eye(3)),
    "balanced sleigh": Pair(BALANCED, moved(BALANCED, np.eye(3)), np.eye(3)),
}
TURNED_TOP = Pair(TOP, moved(TOP, nh.SO(3).exp([0.3, -0.7, 0.4])), nh.SO(3).exp([0.3, -0.7, 0.4]))
TURNED_SLEIGH = Pair(SLEIGH, moved(SLEIGH, _turn(0.6, 0.7)), _turn(0.6, 0.7))
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
        _same(
            *(nh.plot.branches(o.motion, displacement=one.displacement[1], plane=plane).principal for o in (one, other))
        )
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
        with Image.open(nh.plot.animate(orbit, tmp_path / f"{number}.gif", frames=2, title="one")) as movie:
            movie.seek(1)
            frames.append(np.asarray(movie.convert("RGB"), dtype=int))
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
    system, group = pair.equal, nh.SE(2)
    blade, tensor = blade_of_system(system), system.homogeneous_mass_tensor
    seen = system.constraint_subspace @ group.adjoint(group.inverse(blade.frame)).T
    assert np.allclose(seen[:, 2], 0.0, atol=1e-14)
    assert np.isclose(blade.frame[:2, 2] @ blade.frame[:2, 1], 0.0, atol=1e-14)
    assert np.allclose(blade.frame @ [*blade.center, 1.0], tensor[:, 2] / tensor[2, 2], atol=1e-14)


def test_orbits_of_another_body_are_refused() -> None:
    """A portrait takes the orbit of an equal system of another class, and none of another body of the same class."""
    pair = SAME_AXES["sleigh"]
    orbit = pair.runs(0.5, 3)[0]
    heavier = nh.ChaplyginSleigh(2.0, 1.0, 0.5, 0.3)
    with pytest.raises(ValueError, match=r"`phase_portrait\(orbit=...\)` must be an orbit of the system"):
        nh.plot.phase_portrait(heavier, orbit)
    same_rows = nh.LLSystem(nh.SE(2), SLEIGH.homogeneous_mass_tensor, SLEIGH.constraint_subspace)
    assert nh.plot.phase_portrait(same_rows, orbit).orbit is not None
