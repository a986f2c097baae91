"""Loci, sections, phase portraits: what is drawn is what was computed, and nothing else is touched."""

import numpy as np
import pytest
from matplotlib.collections import LineCollection
from matplotlib.colors import to_rgb
from refusals import refusals

import nonholo as nh
from nonholo.analysis import deltoid
from nonholo.plot.sheets import plane_inertia

TOP = nh.discretize(nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]]), 0.5)
BALANCED = nh.discretize(nh.SuslovTop(np.diag([1.0, 2.0, 3.0])), 0.5)
SLEIGH = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5, 0.3), 0.5)
BOTH = {"top": TOP, "sleigh": SLEIGH}


def run(discrete: nh.Discretization) -> nh.Orbit:
    """Run a short orbit."""
    return nh.simulate(discrete, restricted_velocity=(0.4, -0.8), steps=20)


def test_surface_and_singular_points_are_those_of_the_locus() -> None:
    """The dots are the pinch points and the triple point; there are three segments and six whiskers."""
    locus = nh.momentum_locus(TOP, 12)
    picture = nh.plot.momentum_locus(locus)
    assert np.allclose(np.stack(picture.pinch_points._offsets3d, axis=1), locus.pinch_points)
    assert np.allclose(np.stack(picture.triple_point._offsets3d, axis=1), locus.triple_point)
    assert (len(picture.double_lines), len(picture.whiskers)) == (3, 6)
    assert np.allclose(np.stack(picture.double_lines[1].get_data_3d(), axis=1), locus.double_lines[1])


def test_orbit_in_space_is_its_momentum() -> None:
    """Dots of a top are momenta; those of a sleigh p_1, p_2 and the angular momentum about the center of mass."""
    orbit = run(TOP)
    dots = nh.plot.momentum_locus(nh.momentum_locus(TOP, 12), orbit).orbit
    assert np.allclose(np.sort(np.stack(dots._offsets3d, axis=1), axis=0), np.sort(orbit.momentum, axis=0))
    orbit = run(SLEIGH)
    dots = nh.plot.momentum_locus(nh.momentum_locus(SLEIGH, 12), orbit).orbit
    p_theta, p_1, p_2 = orbit.momentum.T
    expected = np.stack([p_1, p_2, p_theta + 0.3 * p_1 - 0.5 * p_2], axis=1)
    assert np.allclose(np.sort(np.stack(dots._offsets3d, axis=1), axis=0), np.sort(expected, axis=0))


def test_curves_on_the_surface_are_those_of_one_energy() -> None:
    """Both components are drawn, point by point."""
    curve = nh.invariant_curve(TOP, 0.5, 50)
    drawn = nh.plot.momentum_locus(nh.momentum_locus(TOP, 8), curve=curve).curves
    for line, momentum in zip(drawn, curve.momentum, strict=True):
        assert np.allclose(np.stack(line.get_data_3d(), axis=1), momentum)


def test_section_points_are_on_plane_and_locus() -> None:
    """The polynomial vanishes along the drawn section, up to the grid; its crossings are zeros to rounding."""
    locus = nh.momentum_locus(TOP, 40)
    section = nh.plot.locus_section(locus, normal=(0.0, 0.0, 2.0), offset=0.4)
    values, sizes = [], []
    for path in section.curve.get_paths():
        P = path.vertices @ section.plane + [0.0, 0.0, 0.4]
        values.append(np.abs(locus.implicit(P)).max())
        sizes.append(np.abs(locus.implicit(P + 0.05)).max())
    assert max(values) < 1e-2 * max(sizes)
    crossings = np.asarray(section.crossings.get_offsets()) @ section.plane + [0.0, 0.0, 0.4]
    assert np.abs(locus.implicit(crossings)).max() < 1e-14


def test_section_shows_isolated_points() -> None:
    """Beyond the pinch point of the balanced top the line of the section's plane has an isolated zero, drawn empty."""
    locus = nh.momentum_locus(BALANCED, 40)
    beyond = 1.3 * locus.pinch_points[:, 2].max()
    section = nh.plot.locus_section(locus, offset=beyond)
    assert section.crossings is None
    assert np.allclose(section.isolated.get_offsets(), 0.0, atol=1e-12)
    assert np.allclose(section.isolated.get_facecolor()[0, :3], to_rgb("white"))


@pytest.mark.parametrize("discrete", BOTH.values(), ids=BOTH)
def test_orbit_dots_lie_on_the_own_curve(discrete: nh.Discretization) -> None:
    """Every dot is within the spacing of the drawn curve of the orbit's energy."""
    picture = nh.plot.invariant_curves(discrete, run(discrete))
    curve = np.concatenate(picture.own.get_segments())
    for dot in picture.orbit.get_offsets():
        assert np.linalg.norm(curve - dot, axis=1).min() < 0.03


@pytest.mark.parametrize("discrete", BOTH.values(), ids=BOTH)
def test_equilibria_on_the_curves(discrete: nh.Discretization) -> None:
    """Stable points are filled, unstable ones empty and opposite; a start on a stable one stays there."""
    picture = nh.plot.invariant_curves(discrete, energies=[0.3])
    stable, unstable = (np.asarray(dots.get_offsets()) for dots in (picture.stable, picture.unstable))
    assert np.allclose(unstable, -stable)
    assert np.allclose(picture.unstable.get_facecolor()[0, :3], to_rgb("white"))
    attracting = discrete.system.equilibria().attracting
    start = attracting * np.sqrt(0.6 / (attracting @ discrete.system.inertia_operator @ attracting))
    orbit = nh.simulate(discrete, body_velocity=start, steps=3)
    dots = nh.plot.invariant_curves(discrete, orbit, energies=[0.3]).orbit.get_offsets()
    assert np.linalg.norm(stable - dots[-1], axis=1).min() < 1e-9


def test_balanced_systems_have_no_equilibria_on_the_curves() -> None:
    """Where every displacement repeats itself none is marked; the pictures of balanced systems are drawn."""
    tops = [nh.SuslovTop(np.diag(moments)) for moments in ([1.0, 1.0, 3.0], [1.0, 2.0, 3.0])]
    for system in (*tops, nh.ChaplyginSleigh(1.0, 1.0, 0.0)):
        discrete = nh.discretize(system, 0.5)
        assert nh.plot.invariant_curves(discrete).stable is None
        nh.plot.momentum_locus(nh.momentum_locus(discrete, 8)).axes.figure.canvas.draw()


def test_curves_do_not_cross_the_rim() -> None:
    """Runs are cut at the rim of the disc and at the edges of the strip: no piece is longer than its spacing allows."""
    for discrete, energies, edge in ((TOP, [0.3, 1.0], 1.0), (SLEIGH, [2.1, 9.0], np.pi)):
        for level in nh.plot.invariant_curves(discrete, energies=energies).levels:
            for run_of_points in level.get_segments():
                assert np.abs(run_of_points[:, 0]).max() <= edge + 1e-12
                assert np.linalg.norm(np.diff(run_of_points, axis=0), axis=1).max() < 0.2


@pytest.mark.parametrize("discrete", BOTH.values(), ids=BOTH)
def test_a_map_or_what_was_computed_of_it(discrete: nh.Discretization) -> None:
    """Pictures of loci and of curves take both, and draw the same points."""
    for draw in (nh.plot.momentum_locus, nh.plot.locus_section):
        one, other = (draw(arguments).axes for arguments in (discrete, nh.momentum_locus(discrete)))
        for line, same in zip(one.lines, other.lines, strict=True):
            assert np.array_equal(line.get_data(), same.get_data())
    energies = [0.3, 0.4]
    curves = [nh.invariant_curve(discrete, energy, 300) for energy in energies]
    one, other = nh.plot.invariant_curves(discrete, energies=energies), nh.plot.invariant_curves(curves)
    assert np.array_equal(one.stable.get_offsets(), other.stable.get_offsets())
    assert all(map(np.array_equal, one.levels[1].get_segments(), other.levels[1].get_segments()))


def test_branch_counts_draw_the_deltoid() -> None:
    """Boundary and cusps are those of `deltoid` in the plane of pi and p_1; the orbit's dots are its momenta."""
    orbit = run(SLEIGH)
    picture = nh.plot.branch_counts(SLEIGH, orbit)
    result = deltoid(SLEIGH)
    expected = result.cusps + np.outer(0.3 * result.cusps[:, 1], [1.0, 0.0])
    assert np.allclose(picture.cusps.get_offsets(), expected)
    assert np.allclose(picture.boundary.get_xydata()[0], expected[0])
    assert np.allclose(orbit.system.canonical.constrained_energy(picture.level.get_xydata()), orbit.energy[0])
    assert np.allclose(np.sort(picture.orbit.get_offsets(), axis=0), np.sort(orbit.reduced_momentum, axis=0))


_CURVE, _LOCUS = nh.invariant_curve(TOP, 1.0), nh.momentum_locus(TOP, 8)
# Orbits of another system, no locus, a zero normal and energies below zero.
test_refuses_what_does_not_belong = refusals(
    (lambda: nh.plot.branch_counts(SLEIGH, run(TOP)), r"`plot.branch_counts\(orbit=...\)` must be an orbit of"),
    (lambda: nh.plot.momentum_locus(TOP.system), r"`plot.momentum_locus\(locus=...\)` must be a locus"),
    (lambda: nh.plot.invariant_curves([TOP]), r"`plot.invariant_curves\(discrete=...\)` must be curves of one"),
    (lambda: nh.plot.invariant_curves([_CURVE], energies=[1.0]), "must be left out beside curves"),
    (lambda: nh.plot.locus_section(_LOCUS, normal=(0, 0, 0)), r"`plot.locus_section\(normal=...\)` must not be zero"),
    (lambda: nh.plot.invariant_curves(TOP, energies=[-1.0]), r"`plot.invariant_curves\(energies=...\)` must be posit"),
)


ROUND = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.0), 0.1)


def _crossings(steps: int) -> nh.Crossings:
    event = nh.Event(lambda orbit: np.sin(orbit.heading), name="east")
    return nh.simulate(ROUND, body_velocity=(4.0, 1.0, 0.0), steps=steps, events=[event]).events["east"]


def test_dots_are_the_quantities_at_the_crossings() -> None:
    """Each dot is a crossing, with the two quantities, whose names the axes bear, as place, the time as color."""
    result, labels = _crossings(100), ("x", "heading")
    drawn = nh.plot.section(result, lambda states: states.position[:, 0], lambda states: states.heading, labels=labels)
    assert (drawn.axes.get_xlabel(), drawn.axes.get_ylabel()) == labels
    assert np.array_equal(drawn.points, np.stack([result.states.position[:, 0], result.states.heading], axis=1))
    assert np.array_equal(drawn.dots.get_offsets(), drawn.points)
    assert np.array_equal(drawn.dots.get_array(), result.time)


# A section needs a crossing; a quantity one number for each, and the error names which one has not.
test_refused_sections = refusals(
    (3, lambda states: states.time, "hold crossings"),
    (20, lambda states: states.position, r"section\(up=.*shape"),
    ask=lambda steps, up: nh.plot.section(_crossings(steps), lambda states: states.time, up),
)


SYSTEMS = {
    "top": TOP.system,
    "tilted": nh.SuslovTop.from_inertia(np.diag([3.0, 2.0, 1.5]), axis=np.array([2.0, 1.0, 2.0]) / 3),
    "sleigh": nh.ChaplyginSleigh(mass=2.0, inertia=1.0, a=0.5, b=0.3),
    "backward sleigh": nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=-0.5, b=0.3),
}
ROUND_ONES = {"top": nh.SuslovTop(np.diag([1.4, 1.0, 0.9])), "sleigh": nh.ChaplyginSleigh(1.0, 1.0, 0.0, 0.2)}


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


@pytest.mark.parametrize("system", ROUND_ONES.values(), ids=ROUND_ONES)
def test_balanced_systems_have_no_direction(system: nh.SuslovTop | nh.ChaplyginSleigh) -> None:
    """Where every point is an equilibrium there are dots on each ellipse, none stable or unstable, and no arrows."""
    portrait = nh.plot.phase_portrait(system, energies=[0.5, 2.0])
    assert portrait.stable is portrait.unstable is None
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
