"""`compare` and `invariants`: zero where they must be, as large as constructed, of order h^2, and at the edges."""

import dataclasses

import numpy as np
import pytest
from refusals import refusals

import nonholo as nh

SLEIGH = nh.ChaplyginSleigh(mass=1.0, inertia=0.75, a=0.5, b=0.2)
TOP = nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]])
FREE = nh.RigidBody(np.diag([1.0, 2.0, 3.0]))
VESELOVA = nh.VeselovaTop(np.diag([1.0, 2.0, 3.0]))
STARTS = {
    "sleigh": (SLEIGH, (1.0, 0.5, 0.0)),
    "top": (TOP, (0.4, 0.9, 0.0)),
    "free": (FREE, (0.4, 0.9, 0.3)),
    "veselova": (VESELOVA, (0.4, 0.9, 0.0)),
}


def run(name: str, h: float, duration: float = 4.0, **changes) -> nh.Orbit:  # noqa: ANN003
    """Return a discrete orbit of a body."""
    system, velocity = STARTS[name]
    return nh.simulate(nh.discretize(system, h), body_velocity=velocity, steps=round(duration / h), **changes)


def flow(name: str, *times: float, **changes) -> nh.Orbit:  # noqa: ANN003
    """Return a flow of a body."""
    system, velocity = STARTS[name]
    return nh.flow(system, body_velocity=velocity, times=times or (0.0, 4.0), **changes)


@pytest.mark.profile("routes", cases=["free", "veselova"])
@pytest.mark.parametrize("name", STARTS)
def test_errors_are_those_of_the_definition(name: str) -> None:
    """Computed state by state: norms of r - r', of g^-1 g' - I, and E - E'; the flow is asked at the orbit's times."""
    orbit = run(name, 0.1)
    other = flow(name, *orbit.time)
    D = np.linalg.inv(orbit.configuration) @ other.configuration
    momentum = np.linalg.norm(orbit.restricted_momentum - other.restricted_momentum, axis=1)
    wanted = momentum, np.linalg.norm(D - np.eye(3), axis=(1, 2)), orbit.energy - other.energy
    np.testing.assert_allclose(nh.compare(orbit, flow(name)).errors, wanted, rtol=0, atol=1e-12)


@pytest.mark.parametrize(("turn", "move"), [(0.3, 0.0), (np.pi, 0.0), (0.0, 2.5)])
def test_the_pose_error_of_a_known_displacement(turn: float, move: float) -> None:
    """A turn by alpha counts 2 sqrt 2 |sin(alpha/2)|, a translation its length, wherever the body is."""
    orbit = run("sleigh", 0.1)
    beside = orbit.beside(np.tile([turn, move * np.cos(1.1), move * np.sin(1.1)], (len(orbit), 1)))
    error = nh.compare(beside, orbit).pose
    assert np.abs(error - np.hypot(2 * np.sqrt(2) * np.sin(turn / 2), move)).max() <= 1e-13


@pytest.mark.profile("routes", cases=["free", "veselova"])
@pytest.mark.parametrize("name", STARTS)
def test_the_order_is_two(name: str) -> None:
    """Halving the time step divides the errors by four; where energy is exact its order is not a number."""
    study = nh.compare([run(name, h) for h in (0.05, 0.1, 0.2)], flow(name))
    assert study.time_step.tolist() == [0.2, 0.1, 0.05]
    assert abs(study.order.pose - 2.0) <= 0.05
    assert abs(study.order.momentum - 2.0) <= 0.05 or np.isnan(study.order.momentum)
    assert np.isnan(study.order.momentum) == (name == "veselova")  # whose spatial momenta are constant
    assert np.isnan(study.order.energy) == (name != "veselova")


def test_saved_states_are_matched_by_time() -> None:
    """Of two discrete orbits those at equal times up to rounding are compared, in whatever order they are."""
    fine, coarse = run("top", 0.05), run("top", 0.2)
    against = nh.compare(coarse, fine)
    assert np.array_equal(against.time, coarse.time)
    backward = fine.chosen(np.arange(len(fine))[::-1])
    assert np.array_equal(nh.compare(coarse, backward).pose, against.pose)
    assert len(nh.compare(run("top", 0.1), run("top", 0.15, 3.0))) == 11


def test_only_times_of_the_flow_count() -> None:
    """A flow that ends earlier is compared as far as it goes, up to the rounding of its last time."""
    orbit = run("sleigh", 0.1)
    assert nh.compare(orbit, flow("sleigh", 0.0, 2.0)).time[-1] == 2.0
    assert len(nh.compare(orbit, flow("sleigh", 0.0, np.nextafter(2.0, 0.0)))) == 21
    assert len(nh.compare(flow("sleigh", 0.0, 2.0), orbit)) == 21


def test_without_poses_momenta_and_energies_remain() -> None:
    """What needs poses is None: the pose itself, and the energy of a right-invariant constraint."""
    against = nh.compare(run("sleigh", 0.1, reconstruct=False), flow("sleigh"))
    assert against.pose is None
    assert against.largest.energy < 1e-14
    assert nh.compare(run("veselova", 0.1, reconstruct=False), flow("veselova")).errors[1:] == (None, None)


ARROWHEAD = nh.SuslovTop.arrowhead([1.0, 2.0, 3.0, 4.0], [0.3, 0.2, 0.1])
TURNED = nh.LLSystem(nh.SO(4), ARROWHEAD.dense.mass_tensor, ARROWHEAD.constraint_subspace[[1, 0, 2]])


def wide(system: nh.LLSystem | nh.SuslovTop) -> nh.Orbit:
    """Return a step in four dimensions."""
    return nh.simulate(nh.discretize(system, 0.1), restricted_velocity=(0.3, 0.5, -0.4), steps=1)


# Each message names the argument and what it must be.
test_what_cannot_be_compared_is_refused = refusals(
    (lambda: nh.compare(5, flow("top")), r"compare\(orbit=...\)` must be an orbit"),
    (lambda: nh.compare(run("top", 0.1), None), r"compare\(flow=...\)` must be an orbit"),
    (lambda: nh.compare(run("top", 0.1), flow("sleigh")), r"must move in SO\(3\). Got SE\(2\)"),
    (lambda: nh.compare(run("top", 0.1), flow("free")), "the constraint of the orbit"),
    (lambda: nh.compare(wide(ARROWHEAD), wide(TURNED)), "the constraint of the orbit"),
    (lambda: nh.compare(run("top", 0.1), flow("top", 5.0, 6.0)), "a time in common"),
    (lambda: nh.compare(run("top", 0.1)[:0], run("top", 0.1)), "a time in common"),
    (lambda: nh.compare([run("top", 0.1)], flow("top")), "different time steps"),
    (lambda: nh.compare([run("top", 0.1)] * 2, flow("top")), "different time steps"),
    (lambda: nh.compare([flow("top")] * 2, flow("top")), "different time steps"),
    (lambda: nh.compare([1.0], flow("top")), r"compare\(orbit=...\)\[0\]"),
    (lambda: nh.invariants(run("top", 0.1)[:0]), r"at least one state.*outcome"),
    (lambda: nh.plot.comparison(5), "be a comparison"),
    (lambda: nh.plot.convergence(5), "be a convergence"),
)


def test_pictures_draw_the_errors() -> None:
    """The panels hold the errors in units of a power of ten, the rings the largest ones; slopes are written."""
    against = nh.compare(run("sleigh", 0.1), flow("sleigh"))
    pose, momentum, energy = against.plot().axes
    assert np.allclose(pose.lines[0].get_ydata() * 1e-3, against.pose, rtol=1e-12, atol=0.0)
    assert momentum.collections[0].get_offsets()[0, 0] == against.time[against.momentum.argmax()]
    assert energy.get_title(loc="left") == "Energy"
    labels = nh.compare([run("sleigh", h) for h in (0.2, 0.1)], flow("sleigh")).plot().axes[0].get_legend().get_texts()
    assert [text.get_text()[:12] for text in labels] == ["pose: order ", "momentum: or", "energy: roun"]


DISCRETE = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1)
RUN = nh.simulate(DISCRETE, body_velocity=(0.1, 1.0, 0.0), steps=2)


def test_the_help_names_every_field() -> None:
    """`help(nh.invariants)` lists what it measures."""
    assert all(f"`{field.name}`" in str(nh.invariants.__doc__) for field in dataclasses.fields(nh.invariants(RUN)))


def test_rest() -> None:
    """A body at rest keeps everything."""
    result = nh.invariants(nh.simulate(DISCRETE, body_velocity=(0, 0, 0), steps=5))
    assert (result.energy_drift, result.reversal_defect, result.largest_step_angle) == (0.0, 0.0, 0.0)


def test_a_negative_energy() -> None:
    """On SO(2, 1) a turn may have one: its drift is a size all the same."""
    G = np.diag([1.0, 1.0, -1.0])
    lorentz, J = nh.MatrixGroup(G @ nh.SO(3).basis, form=G), np.diag([1.0, 2.0, 4.0]) @ G
    turning = nh.discretize(nh.LLSystem(lorentz, -J, annihilator=[[0.0, 0.3, 1.0]]), 0.2)
    orbit = nh.simulate(turning, restricted_velocity=(0.5, 0.4), steps=200)
    assert orbit.energy[0] < 0
    assert 0 < nh.invariants(orbit).energy_drift < 1e-13


@pytest.mark.parametrize("velocity", [(0.0, 0.0), (0.9, -0.4)], ids=["at rest", "one state"])
def test_edges_of_a_right_invariant_run(velocity: tuple[float, float]) -> None:
    """Its steps depend on the pose: none that moves, or a single saved state, is measured all the same."""
    discrete = nh.discretize(nh.VeselovaTop(np.diag([1.0, 2.0, 3.0])), 0.1)
    result = nh.invariants(nh.simulate(discrete, restricted_velocity=velocity, steps=3, save_every=4))
    assert (result.states, result.energy_drift) == (1, 0.0)
    assert 0 <= result.reversal_defect < 1e-14


@pytest.mark.profile("routes", instead="test_edges_of_a_right_invariant_run")
def test_undefined_quantities_are_none() -> None:
    """A flow has no displacements, a run without poses no group residual, another difference no reversal defect."""
    flow = nh.invariants(nh.flow(DISCRETE.system, body_velocity=(1, 0, 0), times=[0.0, 1.0]))
    assert flow.reversal_defect is flow.largest_step_angle is None
    bare = nh.invariants(nh.simulate(DISCRETE, body_velocity=(1, 0, 0), steps=5, reconstruct=False))
    assert bare.group_residual is None
    logarithmic = nh.discretize(DISCRETE.system, 0.1, difference="logarithmic")
    assert nh.invariants(nh.simulate(logarithmic, body_velocity=(1, 0, 0), steps=2)).reversal_defect is None


@pytest.mark.parametrize(
    ("field", "measure"),
    [("cayley", "reversal_defect"), ("reduced_momentum", "energy_drift"), ("canonical_pose", "group_residual")],
)
@pytest.mark.parametrize("name", ["sleigh", "top"])
def test_a_spoilt_orbit_is_seen(name: str, field: str, measure: str) -> None:
    """A relative change of 1e-9 in one state shows in what belongs to it."""
    orbit = run(name, 0.1)
    rows = getattr(orbit, field).copy()
    rows[20] *= 1 + 1e-9
    spoilt = nh.invariants(dataclasses.replace(orbit, **{field: rows}))
    assert getattr(nh.invariants(orbit), measure) < 1e-14
    assert getattr(spoilt, measure) > 1e-11
