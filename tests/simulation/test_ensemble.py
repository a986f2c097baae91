"""Ensembles: every member moves as it would alone, whatever the others do, however the work is cut."""

import dataclasses
from typing import Any

import numpy as np
import pytest
from bodies import GENERAL, mass_tensor
from comparisons import assert_member, assert_same
from refusals import refusals
from simulation.forces import HEAVY, RUB, SLEIGH, drive

import nonholo as nh
from nonholo import kernels
from nonholo.kernels._ensemble import motion_product, quaternion_product
from nonholo.simulation.members import _ensemble, _executors
from nonholo.simulation.members._members import in_lanes

J = np.array([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]])
TOP = nh.SuslovTop(J, axis=(0.6, 0.0, 0.8))
BOTH = pytest.mark.parametrize("system", [TOP, SLEIGH], ids=["top", "sleigh"])
DECODED = ("momentum", "restricted_momentum", "energy", "body_velocity", "displacement", "configuration")
PLACED = {"top": TOP, "sleigh": SLEIGH, "suslov 4": GENERAL["suslov 4"][0], "veselova 3": GENERAL["veselova 3"][0]}
PLACED["plane blade"] = nh.LLSystem(nh.SE(2), SLEIGH.homogeneous_mass_tensor, np.eye(3)[:2])


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


def _assert_same_bits(result: nh.Ensemble, wanted: nh.Ensemble, part: slice = slice(None)) -> None:
    for name in ("reduced_momentum", "cayley", "canonical_pose", "outcome", "steps_done"):
        assert np.array_equal(getattr(result, name), getattr(wanted, name)[part], equal_nan=True), name


def _assert_close(result: np.ndarray, wanted: np.ndarray, tolerance: float) -> None:
    assert result.shape == wanted.shape
    assert np.abs(result - wanted).max() <= tolerance * np.abs(wanted).max()


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


@pytest.mark.parametrize("name", ["top", "suslov 4", "any d on SE(3)", "flow", "rule"])
def test_little_work_starts_no_threads(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Members that are soon done run in the calling thread, all others beside it, where Ctrl-C ends them."""
    system, w = GENERAL.get(name, (TOP, np.ones(2)))
    run: dict[str, Any] = {"restricted_velocity": 0.1 * w * np.ones((10, 1))}
    motion: Any = system if name == "flow" else nh.discretize(system, 0.1)
    little, much = ({"times": (0, 1)}, {"times": (0, 1e3)}) if name == "flow" else ({"steps": 10}, {"steps": 10**5})
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


@pytest.mark.profile("routes", keep=["top", "oblique blade"])
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
            result = getattr(batch, quantity)[member, : len(orbit)]
            assert np.array_equal(result, getattr(orbit, quantity)), quantity
        assert batch.outcome[member] == orbit.outcome


@pytest.mark.parametrize("name", ["top", "sleigh", "suslov 4"])
@pytest.mark.parametrize("every", [None, 1], ids=["last", "history"])
def test_a_failed_member_ends_as_in_simulate(name: str, every: int | None) -> None:
    """Outcome, good steps and last good state of each member are those of its own run; later rows are NaN."""
    discrete = nh.discretize(PLACED[name], 0.7)
    velocities = 2.0 * np.random.default_rng(5).normal(size=(40, discrete.system.rank))
    batch = nh.ensemble(discrete, restricted_velocity=velocities, steps=30, save_every=every)
    assert set(batch.outcome) > {0}
    for member in range(40):
        orbit = nh.simulate(discrete, restricted_velocity=velocities[member], steps=30, throw=False)
        own = batch.orbit(member)
        assert (batch.outcome[member], own.outcome) == (orbit.outcome, orbit.outcome)
        assert batch.steps_done[member] == max(0, len(orbit) - 1)
        assert_same(own, orbit if every else orbit[-1:])
        if every:
            assert np.array_equal(np.isfinite(batch.energy[member]), np.arange(31) < len(orbit))


def _poses(system: Any, count: int) -> np.ndarray:
    return system.group.exp(np.random.default_rng(9).normal(size=(count, system.group.dim)))


STARTS = "restricted_velocity", "body_velocity", "displacement", "momentum", "restricted_momentum"


@pytest.mark.parametrize("start", STARTS)
@pytest.mark.parametrize("name", PLACED)
def test_members_start_where_they_are_put(name: str, start: str) -> None:
    """From poses of their own, and one of all, members have the bits of `simulate`, whatever names their starts."""
    system, poses = PLACED[name], _poses(PLACED[name], 3)
    discrete, w = nh.discretize(system, 0.1), 0.2 * np.random.default_rng(2).normal(size=(3, system.rank))
    moved = [
        nh.simulate(discrete, restricted_velocity=v, configuration=g, steps=1) for v, g in zip(w, poses, strict=True)
    ]
    rows = w if start == "restricted_velocity" else np.array([getattr(orbit, start)[0] for orbit in moved])
    options, run = start.replace("restricted_momentum", "momentum"), {"steps": 20, "save_every": 5}
    batch = nh.ensemble(discrete, **{options: rows}, configuration=poses, **run)
    assert batch.outcome.tolist() == [0, 0, 0]
    for member in range(3):
        orbit = nh.simulate(discrete, **{options: rows[member]}, configuration=poses[member], **run)
        for quantity in ("reduced_momentum", "cayley", "canonical_pose", *DECODED):
            error = 1e-14 if start == "body_velocity" else 0.0  # which a product of matrices restricts
            _assert_close(getattr(batch, quantity)[member], getattr(orbit, quantity), error)
        assert batch.first_energy[member] == pytest.approx(orbit.energy[0], rel=1e-14)
    shared = nh.ensemble(discrete, **{options: rows[0]}, configuration=poses[:1], **run)
    assert np.array_equal(shared.configuration[0], batch.configuration[0])


DRIVEN: dict[str, tuple[Any, Any, Any, dict[str, Any]]] = {  # body, potential, force, parameters
    "heavy tops": (TOP, HEAVY, None, {"mass_tensor": J * np.array([1.0, 1.2, 0.9])[:, None, None]}),
    "sleighs that rub": (SLEIGH, None, RUB, {"a": [0.2, 0.5, -0.3], "mass": [1, 2, 3]}),
    "sleighs that are pushed": (SLEIGH, None, drive, {"b": [0.1, 0.2, 0.3]}),
    "a table": (SLEIGH, None, np.ones((20, 3)), {"inertia": [1.0, 2.0, 3.0], "time_step": [0.05, 0.1, 0.02]}),
}


@pytest.mark.parametrize("name", DRIVEN)
def test_bodies_on_which_forces_act_have_parameters(name: str) -> None:
    """Each member has the bits of the run of the body with its own numbers under the same forces, from its own pose."""
    inside, *forces, parameters = DRIVEN[name]
    discrete, w, poses = nh.discretize(nh.Forced(inside, *forces), 0.1), _velocities(3, 0.5), _poses(inside, 3)
    run: dict[str, Any] = {"steps": 20, "save_every": 4}
    batch = nh.ensemble(discrete, restricted_velocity=w, configuration=poses, parameters=parameters, **run)
    for member, (velocity, pose) in enumerate(zip(w, poses, strict=True)):
        own = {key: values[member] for key, values in parameters.items()}
        step = own.pop("time_step", 0.1)
        body = nh.SuslovTop(**own, axis=TOP.axis) if inside is TOP else dataclasses.replace(SLEIGH, **own)
        discrete = nh.discretize(nh.Forced(body, *forces), step)
        orbit = nh.simulate(discrete, restricted_velocity=velocity, configuration=pose, **run)
        assert_member(batch, member, orbit, "time", "reduced_momentum", "canonical_pose", "energy")
        assert batch.first_energy[member] == pytest.approx(orbit.energy[0], rel=1e-14)


@pytest.mark.parametrize("name", ["top", "sleigh", "suslov 4"])
def test_a_start_that_is_none_spoils_its_member_alone(name: str) -> None:
    """A displacement off the principal branch and a momentum of no displacement give an outcome and NaN."""
    system = PLACED[name]
    discrete = nh.discretize(system, 0.5)
    orbit = nh.simulate(discrete, restricted_velocity=np.full(system.rank, 0.3), steps=1)
    other = system.group.exp(3.0 * system.constraint_subspace[0])
    off = orbit.momentum[0] + 0.5 * np.asarray(system.annihilator)[0]
    for start, outcome in (
        ({"displacement": [orbit.displacement[0], other]}, nh.Outcome.branch_unverified),
        ({"momentum": [orbit.momentum[0], off]}, nh.Outcome.off_momentum_locus),
    ):
        batch = nh.ensemble(discrete, **start, steps=5, save_every=1)
        assert batch.outcome.tolist() == [0, outcome]
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
    result = nh.ensemble(discrete, **arguments, backend="jax")
    assert set(wanted.outcome) > {0}
    assert_same(result, wanted, "outcome", "steps_done")
    for name in ("reduced_momentum", "cayley", "canonical_pose"):
        good = ~np.isnan(getattr(wanted, name))
        assert np.array_equal(good, ~np.isnan(getattr(result, name)))
        _assert_close(getattr(result, name)[good], getattr(wanted, name)[good], 1e-12)


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
    result = nh.ensemble(discrete, **arguments, reduce=reduction)
    assert sizes[1:] == [21, 21, 8]
    for name, values in wanted.items():
        assert np.array_equal(result[name], values)


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
    run: dict[str, Any] = {"restricted_velocity": (0.4, 0.9), "steps": 6, "save_every": 3}
    tensors = {"mass_tensor": J * np.array([1.0, 1.1])[:, None, None]}
    result = nh.ensemble(nh.discretize(TOP, 0.1), **run, parameters=tensors).to_dataset()
    sizes = {"member": 2, "step": 3, "component": 2, "quaternion_component": 4, "row": 3, "column": 3}
    assert dict(result.sizes) == sizes
    assert result.mass_tensor.dims == ("member", "row", "column")
    assert result.outcome.values.tolist() == [0, 0]
    assert result.attrs["format"] == "nonholo.ensemble"


def test_without_poses_what_needs_them_is_refused() -> None:
    """With reconstruct=False momenta and energies exist, poses are refused with the remedy."""
    batch = nh.ensemble(nh.discretize(SLEIGH, 0.1), restricted_velocity=_velocities(2), steps=3, reconstruct=False)
    assert np.isfinite(batch.energy).all()
    for name in ("configuration", "position", "heading"):
        with pytest.raises(ValueError, match="reconstruct=True"):
            getattr(batch, name)


ONE = {"restricted_velocity": (0.3, 1.0)}
_ASIDE = nh.SE(2).exp(np.array([0.0, 0.0, 1.0]))
_HUGE = {"mass": [1, 1e100], "inertia": [1, 1e100]}


# Each bad argument is named, with what was got and what to do.
test_bad_arguments_are_refused = refusals(
    ({"restricted_velocity": [[1, 0]], "configuration": [np.ones((3, 3))]}, "lie in SE.*This is member 0"),
    ({"restricted_velocity": np.ones((2, 2)), "configuration": np.eye(3)[None]}, "1 of configuration"),
    ({"displacement": [np.eye(3), _ASIDE]}, "lie on the displacement variety.*This is member 1"),
    ({}, "exactly one of"),
    ({**ONE, "momentum": [[1, 0]]}, "restricted_velocity and momentum"),
    (ONE, "`simulate` runs a single one"),
    ({"restricted_velocity": np.empty((0, 2))}, "Pass at least one row"),
    ({"body_velocity": np.ones((2, 4))}, r"must have shape \(any, 3\)"),
    ({"restricted_velocity": [[0.1, np.nan]]}, "must be finite"),
    ({"body_velocity": [[1, 1, 0], [1, 0, 1]]}, "satisfy the constraint.*This is member 1"),
    ({"restricted_velocity": [[1, 1], [1e150, 0]], "parameters": _HUGE}, "finite energy.*This is member 1"),
    ({**ONE, "parameters": {"a": [1, 2], "b": [1]}}, "one number of rows. Got 2 of a, 1 of b"),
    ({"momentum": [[1, 0]], "parameters": {"a": [1, 2]}}, "Got 2 of a, 1 of momentum"),
    ({**ONE, "parameters": {"c": [1, 2]}}, "has mass, inertia, a, b, time_step"),
    ({**ONE, "parameters": [1.0]}, "be a mapping"),
    ({**ONE, "parameters": {"a": [1, np.nan]}}, "must be finite"),
    ({**ONE, "parameters": {"a": 1.0}}, r"must have shape \(any,\)"),
    ({**ONE, "parameters": {"mass": [1, 1, -1]}}, r"`ChaplyginSleigh\(mass=.*This is member 2"),
    ({**ONE, "parameters": {"time_step": [0.1, 0]}}, "be positive. Got 0.0.*This is member 1"),
    ({"restricted_velocity": [[1, 0]], "save_every": 0}, r"`ensemble\(save_every=...\)` must be"),
    ({"restricted_velocity": [[1, 0]], "steps": 0}, r"`ensemble\(steps=...\)` must be"),
    ({"restricted_velocity": [[1, 0]], "backend": "c"}, "must be one of 'auto'"),
    ({"restricted_velocity": [[1, 0]], "reduce": lambda _: 1.0}, "leading member axis"),
    ({"restricted_velocity": np.eye(2), "reduce": lambda _: [[1.0], [1.0, 2.0]]}, "return arrays. Got setting an arr"),
    ask=lambda arguments: nh.ensemble(nh.discretize(SLEIGH, 0.1), **{"steps": 5, **arguments}),
)
test_rows_and_columns_that_are_not_there_are_refused = refusals(
    (lambda batch: batch.constraint_residual, "be read from systems in coordinates"),
    (lambda batch: batch.orbit(0).chosen(np.array([6])), "an array of integers, of 6 rows"),
    (lambda batch: batch.orbit(0).chosen(np.array([True])), "a mask or an array of integers, of 6 rows"),
    ask=lambda question: question(nh.ensemble(nh.discretize(SLEIGH, 0.1), momentum=[[1, 0]], steps=5, save_every=1)),
)


_WIDE = nh.SuslovTop.arrowhead(np.ones(40_000), np.zeros(39_999))
# Tensors that are not symmetric or positive, by member; a backend without a closed form; poses beyond the memory.
test_ensembles_that_cannot_be_are_refused = refusals(
    ((TOP, {**ONE, "parameters": {"mass_tensor": [J, J + np.triu(np.ones((3, 3)), 1)]}}), "symmetric.*is member 1"),
    ((TOP, {**ONE, "parameters": {"mass_tensor": [J, -J]}}), "positive definite.*This is member 1"),
    ((SLEIGH, {"restricted_velocity": [[0.1, 1.0]], "backend": "numba"}), "closed form of the step"),
    ((_WIDE, {"restricted_velocity": np.ones((2, 39_999))}), r"`ensemble\(reconstruct=.*reconstruct=False"),
    ask=lambda case: nh.ensemble(
        nh.discretize(case[0], 0.1, "logarithmic" if "backend" in case[1] else "matrix"), steps=3, **case[1]
    ),
)


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


PRODUCTS = {"quaternions": (quaternion_product, nh.SO(3)), "motions": (motion_product, nh.SE(2))}


@pytest.mark.parametrize("kind", PRODUCTS)
def test_rows_are_turned_as_the_group_multiplies(kind: str) -> None:
    """The product of poses in the kernel has the bits of the group's, for large, small and half turns, and NaN."""
    (product, group), rng = PRODUCTS[kind], np.random.default_rng(8)
    one, other = (group.pose_from_matrix(group.exp(rng.normal(size=(200, 3)) * scale)) for scale in (3.0, 1e-9))
    back = group.pose_from_matrix(group.inverse(group.matrix_from_pose(one)))
    for poses, turns in ((one, other), (other, one), (one, one[::-1]), (one, back), (-one, one), (one * np.nan, one)):
        result = [product(*pair) for pair in zip(poses.tolist(), turns.tolist(), strict=True)]
        assert np.array_equal(result, group.pose_product(poses, turns), equal_nan=True)


def test_tables_of_members_and_branches() -> None:
    """Below each other by member and time, none of a member that cannot start; a row for each value of the map."""
    sleigh = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1)
    batch = nh.ensemble(sleigh, restricted_velocity=[[1, 0], [9, -9], [0, 1]], steps=4, save_every=2)
    table = batch.to_pandas()
    assert list(table.index.names) == ["member", "time"]
    assert sorted(set(table.index.get_level_values(0))) == [0, 2]
    assert table.loc[2].equals(batch.orbit(2).to_pandas())
    result = nh.branches(sleigh, momentum=(1.0, 0.5))
    assert np.array_equal(result.to_pandas().filter(like="momentum"), result.momentum)
