"""Pictures of every system: which panels the overview has, and what the pictures beyond tops and sleighs show."""

import inspect
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from groups.examples import HEISENBERG
from plot.runs import body_tensor, frames_of, made_up, run_of, sleigh_run, top_run
from refusals import refusals

import nonholo as nh
from nonholo.plot.motion.coordinates import momentum_track
from nonholo.plot.motion.time_series import velocity_names
from nonholo.systems import SYSTEMS

_PRODUCT = nh.ProductGroup(nh.SE(2), nh.Translations(1))
_FORBIDDEN, _AXIS, _POINT = "Forbidden body axis in space", "Body axis 3 in space", "Reference point"
_PORTRAIT, _SPHERE = "Phase portrait", "Momentum on its energy sphere"
_MOMENTUM, _SPATIAL = "Momentum along the constraint", "Spatial momentum along the constraint"
_VELOCITY, _ENERGY = "Body velocity", "Energy error"
_TRACK, _HEADING, START = "Track of the blade", "Heading and speed", (0.4, 0.9, 0.0)


def _left(group: object, rows: object) -> nh.LLSystem:
    tensor = body_tensor(2 if group == nh.SE(2) else 3)
    return nh.LLSystem(group, tensor[: group.size, : group.size], np.array(rows, dtype=float))


def _sleigh(n: int) -> nh.MultidimensionalSleigh:
    return nh.MultidimensionalSleigh(1.0, [0.5, 0.2, 0.1, 0.0][:n], body_tensor(n)[:n, :n])


def _plate(free: int) -> nh.LRSystem:
    return nh.LRSystem(nh.SE(2), body_tensor(2), np.eye(3)[:free])


def _any(group: object, free: int) -> nh.LLSystem:
    return nh.LLSystem(group, constraint_subspace=np.eye(group.dim)[:free], inertia_operator=np.eye(group.dim))


CASES: dict[str, tuple[Any, list[str]]] = {  # a system, which runs, or what makes an orbit
    "nothing moves": (_left(nh.SO(3), np.empty((0, 3))), [_AXIS, _VELOCITY, _ENERGY]),
    "one direction": (_left(nh.SO(3), [[1, 0, 0]]), [_AXIS, _MOMENTUM, _VELOCITY, _ENERGY]),
    "two": (_left(nh.SO(3), [[1, 0, 0.2], [0, 1, 0]]), [_FORBIDDEN, _PORTRAIT, _VELOCITY, _ENERGY]),
    "free top": (nh.RigidBody(np.diag([1.0, 3.0, 2.0])), [_AXIS, _SPHERE, _VELOCITY, _ENERGY]),
    "free in the plane": (nh.RigidBody(body_tensor(2), nh.SE(2)), [_POINT, _SPHERE, _VELOCITY, _ENERGY]),
    "free on SO(5)": (nh.RigidBody(body_tensor(5)[:5, :5]), [_MOMENTUM, _VELOCITY, _ENERGY]),
    "top of SO(4)": (nh.SuslovTop(body_tensor(4)[:4, :4]), [_SPHERE, _VELOCITY, _ENERGY]),
    "arrowhead of SO(1000)": (
        lambda: run_of(nh.SuslovTop.arrowhead(np.linspace(40, 80, 1000), np.ones(999)), speed=0.05, reconstruct=False),
        [f"{_MOMENTUM}, the 60 largest of 999", _ENERGY],
    ),
    "arrowhead of SO(4)": (nh.SuslovTop.arrowhead([1.0, 2, 3, 4], [0.1, 0.2, 0.3]), [_SPHERE, _VELOCITY, _ENERGY]),
    "arrowhead of SE(4)": (
        nh.MultidimensionalSleigh.arrowhead(1.0, [0.5, 0.2, 0.1, 0.0], [1.0, 2, 3, 4], [0.1, 0.2, 0.3]),
        [_POINT, _MOMENTUM, _VELOCITY, _ENERGY],
    ),
    "sleigh of SE(3)": (_sleigh(3), [_POINT, _SPHERE, _VELOCITY, _ENERGY]),
    "sleigh of SE(4)": (_sleigh(4), [_POINT, _MOMENTUM, _VELOCITY, _ENERGY]),
    "dart": (_left(nh.SE(3), np.eye(6)[:4]), [_POINT, _MOMENTUM, _VELOCITY, _ENERGY]),
    "Veselova": (nh.VeselovaTop(np.diag([1.0, 2.0, 3.0])), [_AXIS, _VELOCITY, _SPATIAL, _ENERGY]),
    "Veselova of SO(4)": (nh.VeselovaTop(np.diag([1.0, 2.0, 3.0, 4.0])), [_VELOCITY, _SPATIAL, _ENERGY]),
    "plate": (_plate(2), [_POINT, _VELOCITY, _SPATIAL, _ENERGY]),
    "plate that cannot move": (lambda: run_of(_plate(0), reconstruct=False), [_SPATIAL]),
    "Heisenberg": (lambda: made_up(_any(HEISENBERG, 2)), [_PORTRAIT, _VELOCITY, _ENERGY]),
    "product": (lambda: made_up(_any(_PRODUCT, 4)), [_MOMENTUM, _VELOCITY, _ENERGY]),
    "translations": (lambda: made_up(_any(nh.Translations(9), 9)), [_MOMENTUM, _VELOCITY, _ENERGY]),
    "no poses": (lambda: run_of(_left(nh.SE(3), np.eye(6)[:4]), reconstruct=False), [_MOMENTUM, _VELOCITY, _ENERGY]),
    "Veselova without poses": (lambda: run_of(nh.VeselovaTop(np.diag([1.0, 2.0, 3.0])), reconstruct=False), [_SPATIAL]),
    "top": (lambda: top_run(START, steps=40), [_FORBIDDEN, _PORTRAIT, _VELOCITY, _ENERGY]),
    "top without poses": (lambda: top_run(START, steps=20, reconstruct=False), [_PORTRAIT, _VELOCITY, _ENERGY]),
    "sleigh": (lambda: sleigh_run(START, steps=40), [_TRACK, _PORTRAIT, _HEADING, _ENERGY]),
    "sleigh without poses": (lambda: sleigh_run(START, steps=20, reconstruct=False), [_PORTRAIT, _VELOCITY, _ENERGY]),
    "one state": (lambda: run_of(_left(nh.SE(3), np.eye(6)[:4]))[:1], [_POINT, _MOMENTUM, _VELOCITY, _ENERGY]),
}


def _orbit(name: str) -> nh.Orbit:
    things = CASES[name][0]
    return things() if inspect.isfunction(things) else run_of(things)


def _titles(orbit: nh.Orbit, **options: object) -> list[str]:
    axes = nh.plot.overview(orbit, **options).axes
    return [title for one in axes if (title := one.get_title(loc="left"))]


_BRIEF = ["dart", "top", "sleigh of SE(3)", "Veselova", "nothing moves", "plate", "one direction", "two"]


@pytest.mark.profile("paper", keep=_BRIEF)
@pytest.mark.parametrize("name", CASES)
def test_panels(name: str) -> None:
    """Each orbit has the panels that are defined for it, the large one first, and none is a failure."""
    assert _titles(_orbit(name)) == CASES[name][1]


def test_every_system_is_tried() -> None:
    """No final system is missing."""
    assert {type(_orbit(name).system) for name in CASES} == set(SYSTEMS)


@pytest.mark.profile("paper", keep=["plate-*"])
@pytest.mark.parametrize("end", [4.0, -4.0])
@pytest.mark.parametrize("name", ["plate", "sleigh"])
def test_a_flow_beside_and_alone(name: str, end: float) -> None:
    """A flow, forwards and backwards in time, has the same panels, alone and beside the discrete orbit."""
    orbit, titles = _orbit(name), CASES[name][1]
    flow = nh.flow(orbit.system, restricted_velocity=0.6 * np.cos(np.arange(2)), times=np.linspace(0.0, end, 20))
    assert _titles(flow) == titles
    assert _titles(orbit, flow=flow) == titles
    assert nh.plot.energy_error(flow).expected.get_text() == "error of the solver"


@pytest.mark.parametrize(
    ("name", "words"), [("dart", "exact by theorem, up to rounding"), ("Veselova", "not exact for this discretization")]
)
def test_the_energy_panel_says_what_to_expect(name: str, words: str) -> None:
    """The panel says whether a theorem makes the energy exact, and the measured error agrees with it."""
    orbit = _orbit(name)
    assert nh.plot.energy_error(orbit).expected.get_text() == words
    assert (np.ptp(orbit.energy) < 1e-14) == words.startswith("exact")


def test_momentum_sphere_is_the_energy_level() -> None:
    """Points have the length of their energy, and their directions turned back are the momenta."""
    orbit = run_of(nh.RigidBody(np.diag([1.0, 3.0, 2.0])), steps=30)
    drawn = nh.plot.momentum_sphere(orbit)
    assert np.allclose(np.linalg.norm(drawn.points, axis=1), 1.0, atol=1e-14)
    back = np.sqrt(2 * orbit.energy[0]) * drawn.points * np.sqrt([5.0, 3.0, 4.0])  # principal moments
    assert np.allclose(back, orbit.momentum, atol=1e-13)
    assert drawn.stable is None


def test_momentum_sphere_ends_at_the_stable_equilibrium() -> None:
    """A long motion of a top of SO(4) ends where the filled dot is drawn, opposite to the empty one."""
    drawn = nh.plot.momentum_sphere(run_of(nh.SuslovTop(body_tensor(4)[:4, :4]), steps=2000))
    end = drawn.view(drawn.points[-1])[0]
    assert np.allclose(drawn.stable.get_offsets()[0], end, atol=1e-3)  # it approaches exponentially
    assert np.allclose(drawn.unstable.get_offsets(), -drawn.stable.get_offsets())


def test_point_track_shows_the_positions() -> None:
    """The track is the path of the reference point; of SE(4) the three largest coordinates are shown."""
    plane = _orbit("plate")
    assert np.array_equal(nh.plot.point_track(plane).points, plane.position)
    four = _orbit("sleigh of SE(4)")
    drawn = nh.plot.point_track(four)
    left_out = set(range(4)) - set(drawn.coordinates)
    assert left_out == {int(np.argmin(np.ptp(four.position, axis=0)))}
    assert np.array_equal(drawn.points, four.position[:, drawn.coordinates])


def _flat_track(orbit: nh.Orbit) -> object:
    return nh.plot.point_track(orbit, axes=nh.plot.energy_error(orbit).axes)


# What a picture cannot show is refused in words, with what to do or to draw instead.
test_refusals = refusals(
    (nh.plot.energy_error, "Veselova without poses", r"`energy_error\(orbit=...\)` must have poses.* reconstruct=True"),
    (nh.plot.momentum_sphere, "two", r"three-dimensional constraint subspace. Got dimension 2. Use `phase_portr"),
    (nh.plot.momentum_sphere, "Veselova of SO(4)", r"must have a left-invariant constraint. .* draw `overview`"),
    (nh.plot.point_track, "top", r"must be an orbit on SE\(n\). Got SO\(3\). Use `body_axis_track`"),
    (nh.plot.point_track, "no poses", "must have poses"),
    (_flat_track, "dart", r"must be axes of dimension 3. .* projection=\"3d\""),
    ask=lambda draw, name: draw(_orbit(name)),
)


def test_axis_of_the_constraint_is_marked() -> None:
    """For a Veselova top the vertical is marked; for a free body its spatial momentum, the same in every state."""
    assert nh.plot.body_axis_track(_orbit("Veselova")).fixed_axis.tolist() == [0.0, 0.0, 1.0]
    free = _orbit("free top")
    axis = nh.plot.body_axis_track(free).fixed_axis
    last = free.spatial_momentum[-1]
    assert np.allclose(axis, last / np.linalg.norm(last), atol=1e-14)


def test_any_body_axis() -> None:
    """A body axis of the user's choice is scaled to length one and carried along; a zero vector is refused."""
    orbit = _orbit("free top")
    assert np.allclose(nh.plot.body_axis_track(orbit, body_axis=(0, 2, 0)).points, orbit.configuration[:, :, 1])
    with pytest.raises(ValueError, match=r"`body_axis_track\(body_axis=...\)` must have a direction"):
        nh.plot.body_axis_track(orbit, body_axis=(0, 0, 0))


def test_portraits_of_any_plane() -> None:
    """A plane of a general system has levels, orbit and the line of equilibria; right-invariant ones are refused."""
    operator = np.eye(3) + 0.3 * (np.eye(3, k=2) + np.eye(3, k=-2))  # the center of the group moves the momenta
    system = nh.LLSystem(HEISENBERG, constraint_subspace=np.eye(3)[:2], inertia_operator=operator)
    drawn = nh.plot.phase_portrait(system, made_up(system))
    assert len(drawn.levels) == 4
    assert drawn.neutral is None
    assert np.abs(drawn.stable.get_offsets()[:, 0]).max() < 1e-15  # momenta in d move where the first is not zero
    assert len(drawn.arrows) == 8
    with pytest.raises(ValueError, match=r"must have a left-invariant constraint"):
        nh.plot.phase_portrait(_orbit("plate").system)


@pytest.mark.profile("paper", keep=["translations"])
@pytest.mark.parametrize("name", ["top of SO(4)", "sleigh of SE(4)", "translations"])
def test_other_systems_move_in_a_plane_of_momenta(name: str, tmp_path: Path) -> None:
    """A film of no body shows a point in the plane of the two largest momenta, or one momentum against time."""
    orbit = _orbit(name)
    track = momentum_track(orbit)
    size = np.abs(orbit.restricted_momentum).max(axis=0)
    column = size.argmax()
    assert any(np.array_equal(orbit.restricted_momentum[:, column], values) for values in track.points(orbit).T)
    film = nh.plot.animate(orbit, tmp_path / "a.gif", frames=3, flow=orbit)
    assert len(frames_of(film)) == min(3, len(orbit))


@pytest.mark.parametrize("group", [nh.SO(2), nh.SO(3), nh.SO(12), nh.SE(2), nh.SE(3), nh.SE(4), _PRODUCT], ids=repr)
def test_one_name_for_each_component(group: object) -> None:
    """Every component of a velocity has its own name."""
    assert len(set(velocity_names(group))) == group.dim
