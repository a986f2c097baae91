"""Phase portraits: levels, equilibria and their stability, the direction of motion, the orbit."""

import numpy as np
import pytest
from matplotlib.collections import LineCollection
from matplotlib.colors import to_rgb

import nonholo as nh
from nonholo.plot.sheets import plane_inertia

SYSTEMS = {
    "top": nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]]),
    "tilted": nh.SuslovTop.from_inertia(np.diag([3.0, 2.0, 1.5]), axis=np.array([2.0, 1.0, 2.0]) / 3),
    "sleigh": nh.ChaplyginSleigh(mass=2.0, inertia=1.0, a=0.5, b=0.3),
    "backward sleigh": nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=-0.5, b=0.3),
}
BALANCED = {"top": nh.SuslovTop(np.diag([1.4, 1.0, 0.9])), "sleigh": nh.ChaplyginSleigh(1.0, 1.0, 0.0, 0.2)}


@pytest.mark.parametrize("system", SYSTEMS.values(), ids=SYSTEMS)
def test_levels_have_their_energy(system: nh.SuslovTop | nh.ChaplyginSleigh) -> None:
    """Every point of an ellipse has the energy it was asked for."""
    portrait = nh.plot.phase_portrait(system, energies=[0.5, 2.0])
    for level, energy in zip(portrait.levels, (0.5, 2.0), strict=True):
        assert np.allclose(system.canonical.constrained_energy(level.get_xydata()), energy, rtol=1e-13)


@pytest.mark.parametrize("system", SYSTEMS.values(), ids=SYSTEMS)
def test_stable_filled_unstable_empty(system: nh.SuslovTop | nh.ChaplyginSleigh) -> None:
    """Attracting equilibria are filled, repelling ones are empty, and each lies on its ellipse."""
    portrait = nh.plot.phase_portrait(system, energies=[0.5, 2.0])
    canonical = system.canonical
    attracting = canonical.restrict(canonical.inertia_operator @ canonical.equilibria().attracting)
    stable, unstable = (np.asarray(dots.get_offsets()) for dots in (portrait.stable, portrait.unstable))
    assert np.allclose(canonical.constrained_energy(stable), [0.5, 2.0])
    assert np.allclose(np.cross(np.pad(stable, ((0, 0), (0, 1))), [*attracting, 0.0]), 0.0, atol=1e-14)
    assert np.all(stable @ attracting > 0)
    assert np.allclose(unstable, -stable)
    assert np.allclose(portrait.unstable.get_facecolor()[0, :3], to_rgb("white"))
    assert np.allclose(portrait.stable.get_facecolor(), portrait.stable.get_edgecolor())


@pytest.mark.parametrize("system", SYSTEMS.values(), ids=SYSTEMS)
def test_arrows_point_to_the_stable_half(system: nh.SuslovTop | nh.ChaplyginSleigh) -> None:
    """Arrows lead along each ellipse, on both sides, from the unstable to the stable equilibrium."""
    portrait = nh.plot.phase_portrait(system, energies=[0.5, 2.0])
    assert len(portrait.arrows) == 4
    inverse = np.linalg.inv(system.canonical.constrained_inertia)
    toward = portrait.stable.get_offsets()[0]
    for arrow in portrait.arrows:
        tail, head = (np.asarray(point) for point in arrow._posA_posB)
        assert (head - tail) @ inverse @ toward > 0


@pytest.mark.parametrize("system", BALANCED.values(), ids=BALANCED)
def test_balanced_systems_have_no_direction(system: nh.SuslovTop | nh.ChaplyginSleigh) -> None:
    """Where every point is an equilibrium there are dots on each ellipse, none stable or unstable, and no arrows."""
    portrait = nh.plot.phase_portrait(system, energies=[0.5, 2.0])
    assert portrait.stable is None
    assert portrait.unstable is None
    assert portrait.arrows == ()
    energies = system.canonical.constrained_energy(np.asarray(portrait.neutral.get_offsets()))
    assert np.allclose(np.unique(energies.round(9)), [0.5, 2.0])


def test_orbit_dots_are_its_momenta(sleigh_orbit: nh.Orbit) -> None:
    """The dots are the canonical momenta of all states, colored by their times; one ellipse goes through them."""
    portrait = nh.plot.phase_portrait(sleigh_orbit.system, sleigh_orbit)
    assert np.array_equal(portrait.orbit.get_offsets(), sleigh_orbit.reduced_momentum)
    assert np.array_equal(portrait.orbit.get_array(), sleigh_orbit.time)
    energies = [sleigh_orbit.system.canonical.constrained_energy(line.get_xydata()[0]) for line in portrait.levels]
    assert np.isclose(energies, sleigh_orbit.energy[0], rtol=1e-12).any()


def test_a_flow_is_a_line(sleigh_orbit: nh.Orbit) -> None:
    """A continuous motion is drawn as a line through its momenta, with enough of them for a smooth curve."""
    flow = nh.flow(sleigh_orbit.system, body_velocity=(0.1, -1.0, 0.0), times=np.linspace(0.0, 20.0, 50))
    path = nh.plot.phase_portrait(flow.system, flow).orbit
    assert isinstance(path, LineCollection)
    drawn = np.array([segment[0] for segment in path.get_segments()])
    assert len(drawn) > 1000
    missed = np.linalg.norm(drawn[:, None] - flow.reduced_momentum[:-1], axis=2).min(axis=0)
    assert missed.max() < 1e-13
    energy = np.einsum("ki,ij,kj->k", drawn, np.linalg.inv(plane_inertia(flow.system)), drawn) / 2
    assert np.allclose(energy, flow.energy[0], rtol=1e-12)
