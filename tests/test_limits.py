"""What is too much is refused before work, and nothing is left behind."""

import re
import shutil
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fuzz.calls import public_names

import nonholo as nh

TOP = nh.discretize(nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]]), 0.1)
SLEIGH = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1)
_MOST = 3e8  # bytes of a call that is refused; modules that it is the first to import are among them
START: dict[str, Any] = {"restricted_velocity": (0.1, 0.2)}
STORED = START | {"store": "a.zarr"}
MEMORY, DISK, COMPONENTS = "fit into memory", "fit on the disk", "have at most 100000 components"


def _sums(block: nh.MemberBlock) -> dict[str, np.ndarray]:
    return {"twice": 2 * block["x"]}


def _random(members: int, name: str = "x") -> nh.RandomDesign:
    return nh.RandomDesign(members, {name: nh.Uniform(0.5, 1.0)})


def _many(*shape: int) -> np.ndarray:
    """Return one number that is repeated: an array that takes no memory, and whose copy takes all."""
    return np.broadcast_to(0.1, shape)


def _starts(*shape: int) -> dict[str, np.ndarray]:
    return {"restricted_velocity": _many(*shape)}


def _arrowhead(n: int, coupling: float = 1e-4) -> nh.Discretization:
    return nh.discretize(nh.SuslovTop.arrowhead(np.arange(1.0, n + 1.0), np.full(n - 1, coupling)), 0.1)


def _kinetic(_: Any, v: Any) -> Any:
    return v @ v / 2


WIDE, BROAD = _arrowhead(100, 0.1), _arrowhead(10**6)
WIDEST, ALONG = BROAD.system, np.full(10**6 - 1, 1e-4)
EYE, SQUARE = np.eye(400), _many(10**6, 10**6)
MATRICES = nh.SO(400), EYE, np.eye(1, 400 * 399 // 2)
ACTION = nh.mass_tensor_lagrangian(nh.SE(2), np.eye(3))
PARTICLE = nh.discretize(nh.LagrangeDAlembert(_kinetic, None, dimension=2), 0.1)
FREE_BODY = nh.discretize(nh.GroupLagrangeDAlembert(nh.SE(2), ACTION, None), 0.1)
ROBOT = nh.examples.two_wheeled_robot().system
PUSHED: dict[str, Any] = {"body_velocity": (1.0, 0.0), "steps": 10**12}
LONG: dict[str, Any] = {"goal": {"configuration": np.array([[1.0, 0, 0], [0, 1, 1], [0, 0, 1]])}, "steps": 10**12}


def _wide_orbit() -> nh.Orbit:
    return nh.simulate(_arrowhead(10**5), restricted_velocity=np.full(10**5 - 1, 1e-4), steps=1, reconstruct=False)


def _fit() -> Any:
    record = {"t": [0.0, 1.0, 2.0], "x": [0.0, 1.0, 2.0], "y": [0.0, 0.1, 0.3]}
    return nh.fit(lambda p: nh.ChaplyginSleigh(1.0, p["inertia"], 0.4), record, {"inertia": 1.0}, time_step=1e-12)


def _peak() -> float:
    """Return the most memory that this process has had so far, in bytes; zero where that is not known."""
    if sys.platform == "win32":
        return 0.0
    import resource

    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * (1.0 if sys.platform == "darwin" else 1024.0)


def _extended() -> Any:
    nh.simulate(TOP, steps=5, **STORED)
    try:
        nh.extend("a.zarr", 10**15)
    finally:
        shutil.rmtree("a.zarr")


TOO_MUCH: dict[str, tuple[Callable[[], Any], str]] = {
    "simulate": (lambda: nh.simulate(TOP, steps=10**12, **START), "fit into memory. Got about 72 TB of"),
    "simulate, steps": (lambda: nh.simulate(TOP, steps=10**30, **START), "be at most 9007199254740992"),
    "simulate, disk": (lambda: nh.simulate(TOP, steps=10**15, **STORED), "fit on the disk. Got about"),
    "simulate, poses": (lambda: nh.simulate(WIDE, steps=10**7, **_starts(99)), "(reconstruct=...)"),
    "simulate, blocks": (lambda: nh.simulate(TOP, steps=10**6, **STORED, checkpoint_every=10**14), "point_every=...)"),
    "extend": (_extended, DISK),
    "iterate": (lambda: nh.iterate(TOP, steps=10**13, block_steps=10**12, **START), MEMORY),
    "simulate, in coordinates": (lambda: nh.simulate(PARTICLE, **PUSHED), "simulate(steps=...)"),
    "simulate, on a group": (lambda: nh.simulate(FREE_BODY, **PUSHED), "simulate(steps=...)"),
    "rollout": (lambda: nh.rollout(SLEIGH, steps=10**12, **START), "rollout(steps=...)"),
    "fit": (_fit, MEMORY),
    "flow": (lambda: nh.flow(SLEIGH.system, times=_many(10**12), **START), "flow(times=...)"),
    "ensemble": (lambda: nh.ensemble(TOP, steps=10**8, save_every=1, **_starts(1000, 2)), "(steps=...)"),
    "ensemble, poses": (
        lambda: nh.ensemble(WIDE, steps=10**9, save_every=1, **_starts(2, 99), reduce=lambda _: {}),
        "(reconstruct=...)",
    ),
    "ensemble, flows": (lambda: nh.ensemble(SLEIGH.system, times=np.arange(1e5), **_starts(10**5, 2)), "(times=...)"),
    "sweep": (lambda: nh.sweep(_sums, _random(10**15), "a.zarr"), "fit on the disk. Got about 21 PB"),
    "sweep, block": (lambda: nh.sweep(_sums, _random(10**12), "a.zarr", block=10**12), "sweep(block=...)"),
    "sweep, files": (lambda: nh.sweep(_sums, _random(10**11), "a.zarr", block=1), DISK),
    "EnsembleTask": (
        lambda: nh.sweep(nh.EnsembleTask(SLEIGH, steps=10, **START), _random(10**15, "a"), "a.zarr"),
        DISK,
    ),
    "Grid": (lambda: nh.sweep(_sums, nh.Grid({name: np.ones(10**4) for name in "xabc"}), "a.zarr"), DISK),
    "RandomDesign": (lambda: nh.sweep(_sums, _random(10**15), "b.zarr"), DISK),
    "dataset": (lambda: nh.dataset("top", "a", orbits=10**15), DISK),
    "Direction": (lambda: nh.Direction(10**14), "Direction(size=...)"),
    "Normal": (lambda: nh.Normal(size=10**14), "Normal(size=...)"),
    "Uniform": (lambda: nh.Uniform(_many(10**12), 1.0), "Uniform(low=...)"),
    "LogUniform": (lambda: nh.LogUniform(_many(10**12), 1.0), "LogUniform(low=...)"),
    "Choice": (lambda: nh.Choice(_many(10**12)), "Choice(values=...)"),
    "MassTensor": (lambda: nh.MassTensor(10**7, 1.0, 2.0), "MassTensor(n=...)"),
    "SO": (lambda: nh.SO(10**6).identity, "SO(1000000).identity` must fit into memory. Got about 8 TB"),
    "SO, basis": (lambda: nh.SO(1000).basis, "SO(1000).basis"),
    "SE": (lambda: nh.SE(10**6).identity, "identity"),
    "Translations": (lambda: nh.Translations(10**6).identity, "identity"),
    "ProductGroup": (lambda: nh.ProductGroup(nh.SO(10**6), nh.SO(3)).identity, "identity"),
    "MatrixGroup": (lambda: nh.MatrixGroup(_many(10**4, 10**4, 10**4)), "(basis=...)"),
    "SuslovTop": (lambda: nh.SuslovTop(EYE).inertia_operator, MEMORY),
    "VeselovaTop": (lambda: nh.VeselovaTop(EYE).inertia_operator, MEMORY),
    "RigidBody": (lambda: nh.RigidBody(EYE).inertia_operator, MEMORY),
    "MultidimensionalSleigh": (lambda: nh.MultidimensionalSleigh(1.0, np.ones(400), EYE).inertia_operator, MEMORY),
    "LLSystem": (lambda: nh.LLSystem(*MATRICES), "complement of a subspace in 79800 dimensions"),
    "LRSystem": (lambda: nh.LRSystem(*MATRICES), "complement of a subspace in 79800 dimensions"),
    "LagrangeDAlembert": (lambda: nh.LagrangeDAlembert(_kinetic, None, dimension=10**9), "(dimension=...)"),
    "mass_tensor_lagrangian": (lambda: nh.mass_tensor_lagrangian(nh.SO(10**6), SQUARE), MEMORY),
    "Linear": (lambda: nh.Linear(SQUARE), "Linear(matrix=...)"),
    "Spring": (lambda: nh.Spring(_many(10**12), _many(10**12), 1.0), "Spring(body_point=...)"),
    "Slip": (lambda: nh.Slip(SQUARE, 1.0), "Slip(rows=...)"),
    "Friction": (lambda: nh.Friction(np.ones(10**6)), "Friction(coefficients=...)"),
    "Forced": (lambda: nh.Forced(SLEIGH.system, None, _many(10**12, 3)), "Forced(force=...)"),
    "Gravity": (lambda: nh.Gravity(_many(10**12), _many(10**12)), "Gravity(point=...)"),
    "reference_point_subspace": (lambda: nh.reference_point_subspace(10**3, np.eye(10**3)[:1]), "(n=...)"),
    "is_symmetric_pair": (lambda: nh.is_symmetric_pair(nh.SO(400), MATRICES[2]), "is_symmetric_pair(group=...)"),
    "branches": (lambda: nh.branches(BROAD, momentum=ALONG), MEMORY),
    "displacements_over": (lambda: nh.displacements_over(BROAD, ALONG), MEMORY),
    "branch_tree": (lambda: nh.branch_tree(SLEIGH, np.eye(3), 10**12), "branch_tree(depth=...)"),
    "fold_distance": (lambda: nh.fold_distance(BROAD, np.eye(3)), MEMORY),
    "discrete_legendre": (lambda: nh.discrete_legendre(TOP, _many(10**11, 3, 3)), "(displacement=...)"),
    "inverse_discrete_legendre": (lambda: nh.inverse_discrete_legendre(BROAD, ALONG), MEMORY),
    "moser_veselov_displacement": (lambda: nh.moser_veselov_displacement(SQUARE, np.ones(3), 0.1), "(mass_tensor=...)"),
    "in_exp_d": (lambda: nh.in_exp_d(_many(10**11, 3, 3)), "in_exp_d(displacement=...)"),
    "trace_constraints": (lambda: nh.trace_constraints(_many(10**11, 3, 3), np.eye(3)), "(configuration=...)"),
    "euler_angle_discrete_lagrangian": (
        lambda: nh.euler_angle_discrete_lagrangian((1.0, 1.0, 1.0), _many(10**11, 3), np.zeros(3)),
        "(angles=...)",
    ),
    "step": (lambda: nh.step(BROAD, ALONG), COMPONENTS),
    "vector_field": (lambda: nh.vector_field(WIDEST), COMPONENTS),
    "conserved_momenta": (lambda: nh.conserved_momenta(WIDEST), COMPONENTS),
    "consistency_defect": (lambda: nh.consistency_defect(BROAD), COMPONENTS),
    "linearize": (lambda: nh.linearize(BROAD), COMPONENTS),
    "lyapunov_exponents": (lambda: nh.lyapunov_exponents(_wide_orbit()), COMPONENTS),
    "lyapunov_function": (lambda: nh.lyapunov_function(WIDEST), MEMORY),
    "invariant_measure": (lambda: nh.invariant_measure(WIDEST), MEMORY),
    "equilibria": (lambda: nh.equilibria(WIDEST), MEMORY),
    "asymptotics": (lambda: nh.asymptotics(WIDEST), MEMORY),
    "heteroclinic": (lambda: nh.heteroclinic(SLEIGH, energy=1e-20), "must settle within 1000000 steps"),
    "momentum_locus": (lambda: nh.momentum_locus(TOP, 10**6), "resolution=...)"),
    "invariant_curve": (lambda: nh.invariant_curve(TOP, 0.01, 10**12), "resolution=...)"),
    "flow_obstruction": (lambda: nh.flow_obstruction(SLEIGH, 0.1, samples=10**11), "samples=...)"),
    "accessibility": (lambda: nh.accessibility(ROBOT, np.zeros(5), depth=10**9), "(depth=...)` must be at most"),
    "steer": (lambda: nh.steer(SLEIGH, {}, **LONG), "steer(steps=...)"),
    "steer, ipopt": (lambda: nh.steer(SLEIGH, {}, **LONG, method="ipopt"), "steer(steps=...)"),
    "tracking_feedback": (lambda: nh.tracking_feedback(SLEIGH, {}, _many(10**12, 3)), "(controls=...)"),
    "testing.check_group": (lambda: nh.testing.check_group(nh.SO(1000)), "check_group(group=...)"),
    "testing.check_system": (lambda: nh.testing.check_system(WIDEST), COMPONENTS),
    "testing.check_discretization": (lambda: nh.testing.check_discretization(SLEIGH, steps=10**12), "(steps=...)"),
    "testing.check_order": (
        lambda: nh.testing.check_order(SLEIGH, (1.0, 0.5, 0.0), halvings=10**6),
        "(steps=..., halvings=...)",
    ),
    "examples.chaotic_quartic_oscillator": (
        lambda: nh.examples.chaotic_quartic_oscillator(pairs=10**12),
        "(pairs=...)",
    ),
}
RESULT = "a result, of what was asked of the function that makes it"
A_FEW, GIVEN = "takes a few numbers", "reads what it is given, in room of the same order"
FEW = {
    **dict.fromkeys(("Crossings", "Discretization", "Ensemble", "EventLog", "MemberBlock", "Orbit", "Outcome"), RESULT),
    **dict.fromkeys(("OutcomeError", "AliasingWarning", "ImpossibleBodyWarning"), RESULT),
    **dict.fromkeys(("testing.Report", "testing.Result", "examples.Example"), RESULT),
    **dict.fromkeys(
        ("ChaplyginSleigh", "Event", "Impact", "cusp", "allow_float32", "discretize", "single_valued_region"), A_FEW
    ),
    "branch_growth": "is of plane sleighs, and has words of at most 1000 steps",
    "critical_energies": "is in O(n) beyond n = 3",
    "critical_values": "asks the linearizations that are passed to it",
    "half_planes": "is of tops with n = 3 and of sleighs, and refuses all others",
    **dict.fromkeys(("compare", "crossings", "invariants", "save_orbit"), GIVEN),
    **dict.fromkeys(("load_orbit", "load_sweep", "resume"), "reads a store; the fuzzer of stores edits their figures"),
    **dict.fromkeys(("GroupLagrangeDAlembert", "ShapedBody", "local_connection"), "keeps functions, and calls none"),
    "FamilyTask": "has as many members as its design, which is asked for too much",
    "geometric_phase": "takes steps as the accuracy needs them",
    "explore": "shows at most some thousand states",
    "plot.animate": "below, with a small limit: it has at most as many frames as states",
    "plot.Look": "the names of choices",
}


def test_every_public_name_is_asked_for_too_much() -> None:
    """A new name comes with a call that asks for too much, or with the reason why none can."""
    limits, public = {name.split(",")[0] for name in TOO_MUCH}, set(public_names())
    drawn = {name for name in public if name.startswith("plot.")} - set(FEW)
    named = {name for name in public if name.startswith("examples.")} - limits - set(FEW)  # numbers of a body
    assert limits | set(FEW) | drawn | named == public
    assert not limits & set(FEW)


@pytest.mark.parametrize("name", TOO_MUCH)
def test_too_much_is_refused(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The refusal names the figure and the limit, comes before any memory is taken, and nothing is at the path."""
    monkeypatch.chdir(tmp_path)
    call, report = TOO_MUCH[name]
    before = _peak()
    with pytest.raises(ValueError, match=re.escape(report)) as caught:
        call()
    limits = "must (fit (into memory|on the disk)|(be|have) at most|have matrices|settle|keep)"
    assert re.search(limits, str(caught.value))
    assert _peak() - before < _MOST
    assert not list(tmp_path.iterdir())


def test_a_run_that_an_event_stops_may_be_long() -> None:
    """How many states a run keeps that an event stops is not known before."""
    event = nh.Event(lambda orbit: orbit.time - 0.55, stop=True)
    assert len(nh.simulate(TOP, steps=10**12, events=[event], **START)) == 6


def test_frames_that_fill_the_memory_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Frames are held until the last one is drawn."""
    orbit = nh.simulate(SLEIGH, steps=50, **START)
    monkeypatch.setattr("nonholo.base.limits.memory_limit", lambda: 1e6)
    with pytest.raises(ValueError, match=r"animate\(frames=...\)` must fit into memory. Got about .* MB of 1 MB"):
        nh.plot.animate(orbit, tmp_path / "a.gif", frames=40)
    assert not list(tmp_path.iterdir())


def test_times_that_fill_the_memory_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """A flow holds its states."""
    monkeypatch.setattr("nonholo.base.limits.memory_limit", lambda: 1e6)
    with pytest.raises(ValueError, match=r"flow\(times=...\)` must fit into memory"):
        nh.flow(SLEIGH.system, times=np.arange(10.0**5), **START)
