"""Ensembles: every member moves as it would alone, whatever the others do, however the work is cut."""

import dataclasses
from typing import Any

import numpy as np
import pytest
from bodies import GENERAL, mass_tensor

import nonholo as nh
from nonholo import kernels
from nonholo.kernels import suslov_body
from nonholo.kernels._ensemble import motion_product, quaternion_product
from nonholo.simulation.members import _ensemble, _executors
from nonholo.simulation.members._members import Members, ScalarMembers, in_lanes

J = np.array([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]])
TOP = nh.SuslovTop(J, axis=(0.6, 0.0, 0.8))
SLEIGH = nh.ChaplyginSleigh(1.0, 1.0, 0.5, 0.3)
BOTH = pytest.mark.parametrize("system", [TOP, SLEIGH], ids=["top", "sleigh"])
DECODED = ("momentum", "restricted_momentum", "energy", "body_velocity", "displacement", "configuration")


def _velocities(count: int, size: float = 1.0) -> np.ndarray:
    return size * np.random.default_rng(5).normal(size=(count, 2))


def _parameters(system: Any, count: int) -> dict[str, np.ndarray]:
    """Draw bodies and time steps."""
    rng = np.random.default_rng(6)
    step = rng.uniform(0.02, 0.1, count)
    if system is TOP:
        return {"mass_tensor": np.array([mass_tensor(nh.SO(3), rng) for _ in range(count)]), "time_step": step}
    drawn = {"mass": rng.uniform(1, 2, count), "inertia": rng.uniform(1, 2, count)}
    return {**drawn, "a": rng.normal(size=count), "b": rng.normal(size=count), "time_step": step}


def _assert_same_bits(found: nh.Ensemble, wanted: nh.Ensemble, part: slice = slice(None)) -> None:
    for name in ("reduced_momentum", "cayley", "canonical_pose", "outcome", "steps_done"):
        assert np.array_equal(getattr(found, name), getattr(wanted, name)[part], equal_nan=True), name


def _assert_close(found: np.ndarray, wanted: np.ndarray, tolerance: float) -> None:
    assert found.shape == wanted.shape
    assert np.abs(found - wanted).max() <= tolerance * np.abs(wanted).max()


@BOTH
def test_members_move_as_simulate_moves_them(system: Any) -> None:
    """Over 1000 steps states agree to rounding, and what is decoded from them; poses gather that of 1000 products."""
    discrete, velocities = nh.discretize(system, 0.1), _velocities(35)
    batch = nh.ensemble(discrete, restricted_velocity=velocities, steps=1000, save_every=250)
    assert batch.outcome.tolist() == [0] * 35
    for member in (0, 33):
        orbit = nh.simulate(discrete, restricted_velocity=velocities[member], steps=1000, save_every=250)
        assert np.array_equal(batch.time[member], orbit.time)
        for name in DECODED:
            _assert_close(getattr(batch, name)[member], getattr(orbit, name), 1e-14)


@BOTH
def test_last_state_is_that_of_the_history(system: Any) -> None:
    """By default the one state kept is the last one, at time N h."""
    discrete, velocities = nh.discretize(system, 0.1), _velocities(3)
    whole = nh.ensemble(discrete, restricted_velocity=velocities, steps=30, save_every=1)
    last = nh.ensemble(discrete, restricted_velocity=velocities, steps=30)
    assert np.array_equal(last.reduced_momentum[:, 0], whole.reduced_momentum[:, -1])
    assert np.array_equal(last.pose[:, 0], whole.pose[:, -1])
    assert np.array_equal(last.time[:, 0], whole.time[:, -1])


@BOTH
def test_starts_agree(system: Any) -> None:
    """Velocities, restricted velocities and both kinds of momenta name the same starts."""
    discrete, w = nh.discretize(system, 0.1), _velocities(4)
    first = nh.ensemble(discrete, restricted_velocity=w, steps=1, save_every=1)
    wanted = first.restricted_momentum[:, 1]
    for start in (
        {"body_velocity": w @ system.constraint_subspace},
        {"momentum": first.momentum[:, 0]},
        {"momentum": first.restricted_momentum[:, 0]},
    ):
        found = nh.ensemble(discrete, **start, steps=1)
        assert found.outcome.tolist() == [0] * 4
        _assert_close(found.restricted_momentum[:, 0], wanted, 1e-15)


@BOTH
@pytest.mark.parametrize("varied", [False, True], ids=["one body", "many bodies"])
def test_bits_do_not_depend_on_the_company(system: Any, varied: bool) -> None:
    """A member alone, a chunk and the whole ensemble have the same bits, some members failing."""
    discrete, velocities = nh.discretize(system, 0.6), _velocities(70, 1.5)
    parameters = _parameters(system, 70) if varied else {}
    parameters.pop("time_step", None)

    def run(part: slice) -> nh.Ensemble:
        own = {name: values[part] for name, values in parameters.items()}
        return nh.ensemble(discrete, restricted_velocity=velocities[part], parameters=own, steps=40, save_every=20)

    whole = run(slice(None))
    assert set(whole.outcome) > {0}
    for part in (slice(41, 42), slice(17, 60)):
        _assert_same_bits(run(part), whole, part)


@BOTH
def test_bits_do_not_depend_on_threads(system: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """One thread, two and seven give the same bits, also of fast members, some of which fail."""
    runs = []
    for threads in (1, 2, 7):
        monkeypatch.setattr(_executors, "threads_to_use", lambda threads=threads: threads)
        discrete = nh.discretize(system, 1.0)
        runs.append(nh.ensemble(discrete, restricted_velocity=_velocities(700, 2.0), steps=100, save_every=50))
    assert {0} < set(runs[0].outcome)
    for run in runs[1:]:
        _assert_same_bits(run, runs[0])


@pytest.mark.parametrize("members", [1, 2])
def test_no_array_of_a_run_is_read_only(members: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """One member runs by the code of many: a read-only array would have the kernels compiled again."""
    writeable = []

    def noted(*arguments: Any) -> None:
        writeable.extend(x.flags.writeable for x in arguments if isinstance(x, np.ndarray))
        run(*arguments)

    run = kernels.advance_members
    monkeypatch.setattr(kernels, "advance_members", noted)
    nh.ensemble(nh.discretize(TOP, 0.1), restricted_velocity=_velocities(members), steps=1)
    assert len(writeable) == 3
    assert all(writeable)


@BOTH
def test_bits_of_simulate(system: Any) -> None:
    """From the same momenta a member has the bits of `simulate`, up to where it fails: arithmetic is strict."""
    discrete = nh.discretize(system, 0.5)
    started = nh.ensemble(discrete, restricted_velocity=_velocities(60, 2.0), steps=1, save_every=1)
    momenta = started.restricted_momentum[started.steps_done > 0, 0]
    batch = nh.ensemble(discrete, momentum=momenta, steps=100, save_every=1)
    for member, momentum in enumerate(momenta):
        orbit = nh.simulate(discrete, momentum=momentum, steps=100, throw=False)
        for name in ("reduced_momentum", "cayley", "canonical_pose"):
            assert np.array_equal(getattr(orbit, name), getattr(batch, name)[member, : len(orbit)]), (member, name)


@BOTH
@pytest.mark.parametrize("every", [None, 1], ids=["last", "history"])
def test_a_failed_member_ends_as_in_simulate(system: Any, every: int | None) -> None:
    """Outcome, number of good steps and last good state of each member are those of its own run."""
    discrete, velocities = nh.discretize(system, 0.7), _velocities(40, 2.0)
    batch = nh.ensemble(discrete, restricted_velocity=velocities, steps=30, save_every=every)
    assert set(batch.outcome) > {0}
    for member in range(40):
        orbit = nh.simulate(discrete, restricted_velocity=velocities[member], steps=30, throw=False)
        own = batch.orbit(member)
        assert (batch.outcome[member], own.outcome) == (orbit.outcome, orbit.outcome)
        assert batch.steps_done[member] == max(0, len(orbit) - 1)
        if every:
            assert len(own) == len(orbit)
        if len(orbit):
            assert own.time[-1] == pytest.approx(orbit.time[-1], rel=1e-15)
            _assert_close(own.momentum[-1], orbit.momentum[-1], 1e-14)


@BOTH
def test_later_rows_of_a_failed_member_are_nan(system: Any) -> None:
    """After its end, and from the start if there is no first root, a member has NaN; others have numbers."""
    discrete = nh.discretize(system, 0.7)
    batch = nh.ensemble(discrete, restricted_velocity=_velocities(40, 2.0), steps=30, save_every=3)
    good = np.isfinite(batch.energy).sum(axis=1)
    failed = batch.outcome != 0
    assert (good[~failed] == 11).all()
    begun = good[failed] > 0
    assert (good[failed][begun] == 1 + batch.steps_done[failed][begun] // 3).all()
    assert (batch.steps_done[failed][~begun] == 0).all()


@BOTH
def test_parameters_vary_by_member(system: Any) -> None:
    """Each member moves as the system with its own parameters and time step does."""
    discrete, velocities, parameters = nh.discretize(system, 0.1), _velocities(33), _parameters(system, 33)
    batch = nh.ensemble(discrete, restricted_velocity=velocities, parameters=parameters, steps=100, save_every=50)
    for member in (0, 32):
        own = {name: values[member] for name, values in parameters.items() if name != "time_step"}
        body = nh.SuslovTop(**own, axis=TOP.axis) if system is TOP else nh.ChaplyginSleigh(**own)
        alone = nh.discretize(body, parameters["time_step"][member])
        orbit = nh.simulate(alone, restricted_velocity=velocities[member], steps=100, save_every=50)
        assert np.array_equal(batch.time[member], orbit.time)
        for name in DECODED:
            _assert_close(getattr(batch, name)[member], getattr(orbit, name), 1e-14)


@BOTH
def test_numbers_of_all_members_are_those_of_each(system: Any) -> None:
    """Inertia, map to the canonical frame, first pose and fields, made in one go, are those of the systems."""
    members = Members(nh.discretize(system, 0.1), _parameters(system, 5), 5)
    scalar = ScalarMembers(members)
    for member in range(5):
        own = members.of(member).system
        _assert_close(scalar.inertia[member], own.canonical.constrained_inertia, 1e-15)
        frame_map = np.broadcast_to(scalar.frame_map, (5, 2, 2))
        assert np.array_equal(frame_map[member], own.frame_map)
        pose = np.broadcast_to(scalar.pose, (5, 4))
        assert np.array_equal(pose[member], own.group.pose_from_matrix(own.frame))
        if system is TOP:
            body = suslov_body(own.canonical.constrained_inertia, own.canonical.coupling)
            assert np.allclose(scalar.fields[:, member], body, rtol=1e-14, atol=0)
        else:
            assert scalar.fields[:, member].tolist() == [own.mass, own.inertia, own.a]


@pytest.mark.parametrize("name", ["top", "suslov 4", "any d on SE(3)", "flow", "rule"])
def test_little_work_starts_no_threads(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Members that are soon done run in the calling thread, all others beside it, where Ctrl-C ends them."""
    system, w = GENERAL.get(name, (TOP, np.ones(2)))
    run: dict[str, Any] = {"restricted_velocity": 0.1 * w * np.ones((10, 1))}
    motion: Any = system if name == "flow" else nh.discretize(system, 0.1)
    little, much = (
        ({"times": (0.0, 1.0)}, {"times": (0.0, 1e3)}) if name == "flow" else ({"steps": 10}, {"steps": 10**5})
    )
    run |= {"branch": "nearest"} if name == "rule" else {}

    def refused(*_: Any) -> None:
        raise RuntimeError

    monkeypatch.setattr(_executors, "ThreadPoolExecutor", refused)
    assert nh.ensemble(motion, **run, **little).outcome.tolist() == [0] * 10
    if name != "rule":  # of which Ctrl-C is answered between its steps
        with pytest.raises(RuntimeError):
            nh.ensemble(motion, **run, **much)


BY_MATRICES = {
    "top": nh.LLSystem(nh.SO(3), J, annihilator=[[0.0, 0.0, 1.0]]),
    "oblique top": nh.LLSystem(nh.SO(3), J, annihilator=[[0.6, -0.2, 0.8]]),
    "plane blade": nh.LLSystem(nh.SE(2), SLEIGH.homogeneous_mass_tensor, np.eye(3)[:2]),
    "oblique blade": nh.LLSystem(nh.SE(2), SLEIGH.homogeneous_mass_tensor, annihilator=[[0.2, 0.3, 1.0]]),
}


@pytest.mark.parametrize("name", BY_MATRICES)
def test_bodies_by_matrices_run_side_by_side(name: str) -> None:
    """Tops and sleighs are known by their closed form, whatever their class; members have the bits of `simulate`."""
    system, rng = BY_MATRICES[name], np.random.default_rng(3)
    tensors = np.asarray(system.mass_tensor) + 0.1 * np.array([x @ x.T for x in rng.normal(size=(5, 3, 3))])
    own = {"mass_tensor": tensors, "time_step": [0.05, 0.1, 0.2, 0.1, 0.9]}
    run = {"restricted_velocity": _velocities(5), "configuration": _poses(system, 1)[0]}
    batch = nh.ensemble(nh.discretize(system, 0.1), **run, parameters=own, steps=40, save_every=8)
    assert in_lanes(batch.members)
    for member in range(5):
        each = run | {"restricted_velocity": run["restricted_velocity"][member]}
        orbit = nh.simulate(batch.members.of(member), **each, steps=40, save_every=8, throw=False)
        for quantity in ("reduced_momentum", "cayley", "canonical_pose", *DECODED):
            found = getattr(batch, quantity)[member, : len(orbit)]
            assert np.array_equal(found, getattr(orbit, quantity)), quantity
        assert batch.outcome[member] == orbit.outcome


@pytest.mark.parametrize("name", ["suslov 4", "any d on SE(3)", "veselova 3"])
def test_other_systems_run_member_by_member(name: str) -> None:
    """States of systems without a scalar kernel have the bits of `simulate`, with parameters that vary too.

    What is decoded agrees to rounding: BLAS may add in another order where there are more rows.
    """
    system, w = GENERAL[name]
    velocities = w * np.array([[1.0], [0.5], [0.2]])
    tensors = np.asarray(system.mass_tensor) * np.array([1.0, 1.2, 0.9])[:, None, None]
    discrete = nh.discretize(system, 0.1)
    for parameters in ({}, {"mass_tensor": tensors}):
        batch = nh.ensemble(discrete, restricted_velocity=velocities, parameters=parameters, steps=20)
        orbit = nh.simulate(batch.members.of(1), restricted_velocity=velocities[1], steps=20)
        for state in ("reduced_momentum", "cayley", "canonical_pose"):
            assert np.array_equal(getattr(batch, state)[1, 0], getattr(orbit, state)[-1])
        for quantity in DECODED:
            _assert_close(getattr(batch, quantity)[1, 0], getattr(orbit, quantity)[-1], 1e-14)


def test_a_member_of_another_system_keeps_its_last_good_state() -> None:
    """Where members run one by one a failed one still has the state before its end."""
    system, w = GENERAL["suslov 4"]
    discrete = nh.discretize(system, 1.0)
    velocities = w * np.array([[0.1], [2.3], [40.0]])
    batch = nh.ensemble(discrete, restricted_velocity=velocities, steps=50)
    assert batch.outcome[0] == 0
    assert batch.outcome[2] != 0
    for member in range(3):
        orbit = nh.simulate(discrete, restricted_velocity=velocities[member], steps=50, throw=False)
        assert (batch.outcome[member], len(batch.orbit(member))) == (orbit.outcome, min(1, len(orbit)))
        assert batch.steps_done[member] == max(0, len(orbit) - 1)
        if len(orbit):
            assert np.array_equal(batch.reduced_momentum[member, 0], orbit.reduced_momentum[-1])


@BOTH
def test_a_momentum_off_the_locus_spoils_its_member_alone(system: Any) -> None:
    """A full momentum that no displacement has gives the outcome off_momentum_locus and NaN."""
    discrete = nh.discretize(system, 0.1)
    momenta = nh.ensemble(discrete, restricted_velocity=_velocities(3), steps=1, save_every=1).momentum[:, 0].copy()
    momenta[1] += 0.1 * system.annihilator[0]
    batch = nh.ensemble(discrete, momentum=momenta, steps=5)
    assert batch.outcome.tolist() == [0, nh.Outcome.off_momentum_locus, 0]
    assert np.isnan(batch.energy[:, 0]).tolist() == [False, True, False]


PLACED = {"top": TOP, "sleigh": SLEIGH, "suslov 4": GENERAL["suslov 4"][0], "veselova 3": GENERAL["veselova 3"][0]}
PLACED["plane blade"] = nh.LLSystem(nh.SE(2), SLEIGH.homogeneous_mass_tensor, np.eye(3)[:2])


def _poses(system: Any, count: int) -> np.ndarray:
    return system.group.exp(np.random.default_rng(9).normal(size=(count, system.group.dim)))


@pytest.mark.parametrize("start", ["restricted_velocity", "displacement"])
@pytest.mark.parametrize("name", PLACED)
def test_members_start_where_they_are_put(name: str, start: str) -> None:
    """From poses of their own and one of all members move as `simulate` does, from velocities and displacements."""
    system, poses = PLACED[name], _poses(PLACED[name], 3)
    discrete, w = nh.discretize(system, 0.1), 0.2 * np.random.default_rng(2).normal(size=(3, system.rank))
    moved = [
        nh.simulate(discrete, restricted_velocity=v, configuration=g, steps=1) for v, g in zip(w, poses, strict=True)
    ]
    rows = w if start == "restricted_velocity" else np.array([orbit.displacement[0] for orbit in moved])
    batch = nh.ensemble(discrete, **{start: rows}, configuration=poses, steps=20, save_every=5)
    assert batch.outcome.tolist() == [0, 0, 0]
    for member in range(3):
        own: dict[str, Any] = {start: rows[member], "configuration": poses[member]}
        orbit = nh.simulate(discrete, **own, steps=20, save_every=5)
        for quantity in ("configuration", "restricted_momentum", "displacement", "energy"):
            _assert_close(getattr(batch, quantity)[member], getattr(orbit, quantity), 1e-14)
        assert batch.first_energy[member] == pytest.approx(orbit.energy[0], rel=1e-14)
    shared = nh.ensemble(discrete, **{start: rows[0]}, configuration=poses[:1], steps=20, save_every=5)
    assert np.array_equal(shared.configuration[0], batch.configuration[0])


@pytest.mark.parametrize("name", PLACED)
def test_flows_start_where_they_are_put(name: str) -> None:
    """Members of flows start at their poses, as `flow` does."""
    system, poses = PLACED[name], _poses(PLACED[name], 3)
    w, times = np.random.default_rng(2).normal(size=(3, system.rank)), (0.0, 0.5, 2.0)
    batch = nh.ensemble(system, restricted_velocity=w, configuration=poses, times=times)
    for member in range(3):
        alone = nh.flow(system, restricted_velocity=w[member], configuration=poses[member], times=times)
        for quantity in ("configuration", "restricted_momentum", "body_velocity"):
            _assert_close(getattr(batch, quantity)[member], getattr(alone, quantity), 1e-13)
        assert batch.first_energy[member] == pytest.approx(alone.energy[0], rel=1e-14)


def test_members_in_the_air_start_with_their_potential_energy() -> None:
    """The first energy of members under forces is that at their own poses."""
    heavy = nh.Forced(TOP, nh.Gravity(force=[0.0, 0.0, -9.81], point=[0.0, 0.0, 0.3]))
    discrete, poses = nh.discretize(heavy, 0.01), _poses(TOP, 3)
    batch = nh.ensemble(discrete, restricted_velocity=np.ones((3, 2)), configuration=poses, steps=4, save_every=1)
    assert np.ptp(batch.first_energy) > 0.1
    assert np.array_equal(batch.first_energy, batch.energy[:, 0])


DRIVEN: dict[str, tuple[Any, dict[str, Any], dict[str, Any]]] = {
    "heavy tops": (
        TOP,
        {"potential": nh.Gravity(force=[0.0, 0.0, -9.81], point=[0.0, 0.0, 0.3])},
        {"mass_tensor": J * np.array([1.0, 1.2, 0.9])[:, None, None]},
    ),
    "sleighs that rub": (
        SLEIGH,
        {"force": nh.Friction(0.1 * np.eye(3))},
        {"a": [0.2, 0.5, -0.3], "mass": [1.0, 2.0, 3.0]},
    ),
    "sleighs that are pushed": (
        SLEIGH,
        {"force": lambda t, g, w: np.array([np.cos(t), g[0, 0], -w[1]])},
        {"b": [0.1, 0.2, 0.3]},
    ),
    "a table": (SLEIGH, {"force": np.ones((20, 3))}, {"inertia": [1.0, 2.0, 3.0], "time_step": [0.05, 0.1, 0.02]}),
}


@pytest.mark.parametrize("name", DRIVEN)
def test_bodies_on_which_forces_act_have_parameters(name: str) -> None:
    """Each member has the bits of the run of the body with its own numbers under the same forces."""
    inside, forces, parameters = DRIVEN[name]
    system, w = nh.Forced(inside, **forces), _velocities(3, 0.5)
    batch = nh.ensemble(
        nh.discretize(system, 0.1), restricted_velocity=w, parameters=parameters, steps=20, save_every=4
    )
    for member in range(3):
        own = {key: values[member] for key, values in parameters.items()}
        step = own.pop("time_step", 0.1)
        body = nh.SuslovTop(**own, axis=TOP.axis) if inside is TOP else dataclasses.replace(SLEIGH, **own)
        orbit = nh.simulate(
            nh.discretize(nh.Forced(body, **forces), step), restricted_velocity=w[member], steps=20, save_every=4
        )
        for state in ("time", "reduced_momentum", "canonical_pose", "energy"):
            assert np.array_equal(getattr(batch, state)[member], getattr(orbit, state)), state


def test_flows_under_forces_have_parameters() -> None:
    """Each member is the flow of its own body."""
    _, forces, parameters = DRIVEN["sleighs that rub"]
    batch = nh.ensemble(
        nh.Forced(SLEIGH, **forces), body_velocity=(1.0, 0.5, 0.0), parameters=parameters, times=(0.0, 1.0)
    )
    for member, (a, mass) in enumerate(zip(*parameters.values(), strict=True)):
        body = dataclasses.replace(SLEIGH, a=a, mass=mass)
        alone = nh.flow(nh.Forced(body, **forces), body_velocity=(1.0, 0.5, 0.0), times=(0.0, 1.0))
        assert np.array_equal(batch.reduced_momentum[member], alone.reduced_momentum)
        assert np.array_equal(batch.heading[member], alone.heading)


@pytest.mark.parametrize("name", ["top", "sleigh", "suslov 4"])
def test_a_displacement_of_another_branch_spoils_its_member_alone(name: str) -> None:
    """A member that would not start on the principal branch has outcome branch_unverified and NaN."""
    system = PLACED[name]
    discrete = nh.discretize(system, 0.5)
    orbit = nh.simulate(discrete, restricted_velocity=np.full(system.rank, 0.3), steps=1)
    bad = system.group.exp(3.0 * system.constraint_subspace[0])
    batch = nh.ensemble(discrete, displacement=[orbit.displacement[0], bad], steps=5, save_every=1)
    assert batch.outcome.tolist() == [0, nh.Outcome.branch_unverified]
    assert batch.steps_done.tolist() == [5, 0]
    assert np.isnan(batch.energy[1]).all()
    assert len(batch.orbit(1)) == 0


@BOTH
def test_jax_agrees_with_the_compiled_loop(system: Any) -> None:
    """States agree to 1e-12 and outcomes exactly, with bodies that differ and members that fail."""
    parameters = _parameters(system, 40)
    arguments: dict[str, Any] = {"restricted_velocity": _velocities(40, 2.0), "steps": 50, "save_every": 20}
    arguments["parameters"] = parameters | {"time_step": np.linspace(0.05, 0.9, 40)}
    discrete = nh.discretize(system, 0.1)
    wanted = nh.ensemble(discrete, **arguments)
    found = nh.ensemble(discrete, **arguments, backend="jax")
    assert set(wanted.outcome) > {0}
    assert np.array_equal(found.outcome, wanted.outcome)
    assert np.array_equal(found.steps_done, wanted.steps_done)
    for name in ("reduced_momentum", "cayley", "canonical_pose"):
        good = ~np.isnan(getattr(wanted, name))
        assert np.array_equal(good, ~np.isnan(getattr(found, name)))
        _assert_close(getattr(found, name)[good], getattr(wanted, name)[good], 1e-12)


def test_a_reduction_sees_the_members_in_blocks(monkeypatch: pytest.MonkeyPatch) -> None:
    """A function of blocks gives what the same function of all members gives, to the bit."""
    discrete, velocities = nh.discretize(SLEIGH, 0.1), _velocities(50)
    parameters = {"a": np.linspace(-1, 1, 50)}
    sizes = []

    def reduction(block: nh.Ensemble) -> dict[str, np.ndarray]:
        sizes.append(len(block))
        return {"energy": block.energy[:, -1], "end": block.position[:, -1], "turn": np.ptp(block.heading, axis=1)}

    arguments = {"restricted_velocity": velocities, "parameters": parameters, "steps": 60, "save_every": 20}
    wanted = reduction(nh.ensemble(discrete, **arguments))
    monkeypatch.setattr(_ensemble, "_BLOCK", 700)
    found = nh.ensemble(discrete, **arguments, reduce=reduction)
    assert sizes[1:] == [21, 21, 8]
    for name, values in wanted.items():
        assert np.array_equal(found[name], values)


def test_headings_are_unwrapped_along_each_member() -> None:
    """The heading of a thinned history counts full turns, member by member."""
    discrete = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.0), 0.1)
    batch = nh.ensemble(discrete, restricted_velocity=[[2.0, 0.0], [-1.0, 0.0]], steps=100, save_every=2)
    for member, velocity in enumerate((2.0, -1.0)):
        orbit = nh.simulate(discrete, restricted_velocity=(velocity, 0.0), steps=100, save_every=2)
        assert np.abs(batch.heading[member] - orbit.heading).max() < 1e-13
        assert abs(batch.heading[member, -1]) > 9


def test_a_dataset_has_members_steps_and_parameters() -> None:
    """The labeled dataset has the dimensions member and step, outcomes and the parameters that vary."""
    discrete = nh.discretize(TOP, 0.1)
    found = nh.ensemble(
        discrete,
        restricted_velocity=(0.4, 0.9),
        parameters={"mass_tensor": J * np.array([1.0, 1.1])[:, None, None]},
        steps=6,
        save_every=3,
    ).to_dataset()
    assert dict(found.sizes) == {
        "member": 2, "step": 3, "component": 2, "quaternion_component": 4, "row": 3, "column": 3,
    }  # fmt: skip
    assert found.mass_tensor.dims == ("member", "row", "column")
    assert found.outcome.values.tolist() == [0, 0]
    assert found.attrs["format"] == "nonholo.ensemble"


def test_without_poses_what_needs_them_is_refused() -> None:
    """With reconstruct=False momenta and energies exist, poses are refused with the remedy."""
    batch = nh.ensemble(nh.discretize(SLEIGH, 0.1), restricted_velocity=_velocities(2), steps=3, reconstruct=False)
    assert np.isfinite(batch.energy).all()
    for name in ("configuration", "position", "heading"):
        with pytest.raises(ValueError, match="reconstruct=True"):
            getattr(batch, name)


ONE = {"restricted_velocity": (0.3, 1.0)}
REFUSED: dict[str, tuple[dict[str, Any], str]] = {
    "a pose that is none": (
        {"restricted_velocity": [[1, 0]], "configuration": [np.ones((3, 3))]},
        "lie in SE.*This is member 0",
    ),
    "poses of others": (
        {"restricted_velocity": np.ones((2, 2)), "configuration": np.eye(3)[None]},
        "1 of configuration",
    ),
    "a displacement off the variety": (
        {"displacement": [np.eye(3), nh.SE(2).exp(np.array([0.0, 0.0, 1.0]))]},
        "lie on the displacement variety.*This is member 1",
    ),
    "no start": ({}, "exactly one of"),
    "two starts": ({**ONE, "momentum": [[1, 0]]}, "restricted_velocity and momentum"),
    "one row without parameters": (ONE, "`simulate` runs a single one"),
    "no rows": ({"restricted_velocity": np.empty((0, 2))}, "Pass at least one row"),
    "wrong width": ({"body_velocity": np.ones((2, 4))}, r"must have shape \(any, 3\)"),
    "nan": ({"restricted_velocity": [[0.1, np.nan]]}, "must be finite"),
    "forbidden velocity": ({"body_velocity": [[1, 1, 0], [1, 0, 1]]}, "satisfy the constraint.*This is member 1"),
    "infinite energy": (
        {"restricted_velocity": [[1, 1], [1e150, 0]], "parameters": {"mass": [1, 1e100], "inertia": [1, 1e100]}},
        "finite energy.*This is member 1",
    ),
    "lengths of parameters": ({**ONE, "parameters": {"a": [1, 2], "b": [1]}}, "one number of rows. Got 2 of a, 1 of b"),
    "lengths of starts": ({"momentum": [[1, 0]], "parameters": {"a": [1, 2]}}, "Got 2 of a, 1 of momentum"),
    "unknown parameter": ({**ONE, "parameters": {"c": [1, 2]}}, "has mass, inertia, a, b, time_step"),
    "no mapping": ({**ONE, "parameters": [1.0]}, "be a mapping"),
    "nan parameter": ({**ONE, "parameters": {"a": [1, np.nan]}}, "must be finite"),
    "shape of a parameter": ({**ONE, "parameters": {"a": 1.0}}, r"must have shape \(any,\)"),
    "no system": ({**ONE, "parameters": {"mass": [1, 1, -1]}}, r"`ChaplyginSleigh\(mass=.*This is member 2"),
    "time step": ({**ONE, "parameters": {"time_step": [0.1, 0]}}, "be positive. Got 0.0.*This is member 1"),
    "save_every": ({"restricted_velocity": [[1, 0]], "save_every": 0}, r"`ensemble\(save_every=...\)` must be"),
    "steps": ({"restricted_velocity": [[1, 0]], "steps": 0}, r"`ensemble\(steps=...\)` must be"),
    "backend": ({"restricted_velocity": [[1, 0]], "backend": "c"}, "must be one of 'auto'"),
    "reduction": ({"restricted_velocity": [[1, 0]], "reduce": lambda _: 1.0}, "leading member axis"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_bad_arguments_are_refused(case: str) -> None:
    """Each bad argument is named, with what was got and what to do."""
    arguments, words = REFUSED[case]
    with pytest.raises(ValueError, match=words):
        nh.ensemble(nh.discretize(SLEIGH, 0.1), **{"steps": 5, **arguments})


def test_mass_tensors_of_no_top_are_refused() -> None:
    """A tensor that is not symmetric, and one without positive inertia along the constraint, are named by member."""
    discrete = nh.discretize(TOP, 0.1)
    for bad, words in ((J + np.triu(np.ones((3, 3)), 1), "be symmetric"), (-J, "positive definite")):
        with pytest.raises(ValueError, match=f"{words}.*This is member 1"):
            nh.ensemble(discrete, **ONE, parameters={"mass_tensor": [J, bad]}, steps=5)


def test_numba_without_closed_form_is_refused() -> None:
    """A discretization that only its definition can run refuses the compiled backend."""
    discrete = nh.discretize(SLEIGH, 0.1, difference="logarithmic")
    with pytest.raises(ValueError, match="closed form of the step"):
        nh.ensemble(discrete, restricted_velocity=[[0.1, 1.0]], steps=3, backend="numba")


def test_poses_that_fill_the_memory_are_refused() -> None:
    """Poses of a top in very many dimensions are refused before anything runs, with the remedy."""
    top = nh.SuslovTop.arrowhead(np.ones(40_000), np.zeros(39_999))
    with pytest.raises(ValueError, match=r"`ensemble\(reconstruct=.*reconstruct=False"):
        nh.ensemble(nh.discretize(top, 0.1), restricted_velocity=np.ones((2, 39_999)), steps=3)


@pytest.mark.parametrize("size", [5e-324, 1e-200, 1e200])
@pytest.mark.parametrize("members", [2, 32])
def test_members_that_cannot_begin_have_no_states(size: float, members: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without the check of sizes bodies whose squares under- or overflow end with no good step and NaN.

    Nothing is written behind them.
    """
    monkeypatch.setattr("nonholo.base.checks.LARGEST", np.inf)
    monkeypatch.setattr("nonholo.base.checks._SMALLEST", 0.0)
    discrete = nh.discretize(nh.SuslovTop(J), 0.5)
    tensors = np.array([J] * (members - 1) + [np.array(J) * size])
    with np.errstate(all="ignore"):
        batch = nh.ensemble(discrete, restricted_velocity=(0.1, 0.2), steps=7, parameters={"mass_tensor": tensors})
    assert batch.outcome.tolist()[:-1] == [0] * (members - 1)
    assert batch.outcome[-1] in (nh.Outcome.not_converged, nh.Outcome.nonfinite)
    assert batch.steps_done.tolist() == [7] * (members - 1) + [0]
    assert np.isnan(batch.reduced_momentum[-1]).all()


@pytest.mark.parametrize(
    ("product", "group"), [(quaternion_product, nh.SO(3)), (motion_product, nh.SE(2))], ids=["quaternions", "motions"]
)
def test_rows_are_turned_as_the_group_multiplies(product: Any, group: nh.MatrixGroup) -> None:
    """The product of poses in the kernel has the bits of the group's, for large, small and half turns, and NaN."""
    rng = np.random.default_rng(8)
    one, other = (group.pose_from_matrix(group.exp(rng.normal(size=(200, 3)) * scale)) for scale in (3.0, 1e-9))
    back = group.pose_from_matrix(group.inverse(group.matrix_from_pose(one)))
    for poses, turns in ((one, other), (other, one), (one, one[::-1]), (one, back), (-one, one), (one * np.nan, one)):
        found = [product(*pair) for pair in zip(poses.tolist(), turns.tolist(), strict=True)]
        assert np.array_equal(found, group.pose_product(poses, turns), equal_nan=True)
