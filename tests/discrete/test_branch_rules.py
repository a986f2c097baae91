"""Which value of the map a step takes: the principal one against continuation, the other rules, what is refused."""

import jax
import numpy as np
import pytest
from bodies import GENERAL
from fuzz.following import SHARP, distance, followed, newton
from fuzz.steps import equations_of
from refusals import refusals

import nonholo as nh
from nonholo.discrete import Branches
from nonholo.discrete.branching._equations import follow as followed_on_sphere
from nonholo.discrete.branching._equations import frame_of
from nonholo.discrete.branching._rules import PRINCIPAL, branch_rule, displacement_at, first_place, next_place

TOP = nh.discretize(nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]]), 0.3)
FOUR = nh.discretize(nh.SuslovTop([[1.25, 0.0, -0.5], [0.0, 1.0, -0.75], [-0.5, -0.75, 1.25]]), 1.0)
SLEIGH = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 1.0)
BALANCED = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.0), 0.1)
ROD = nh.discretize(nh.SuslovTop(np.outer([1.0, 0.5, 0.4], [1.0, 0.5, 0.4]) + np.diag([0.01, 0.02, 0.0])), 1.0)
ROUND = nh.discretize(nh.SuslovTop(np.diag([1.0, 1.0, 2.0])), 1.0)
FOUR_REAL = 2 * FOUR.system.constrained_inertia @ np.array([-0.25, -0.375]) / (1 + 0.0625 + 0.140625)  # an equilibrium
MOTION = nh.discretize(nh.MultidimensionalSleigh(1.3, [0.3, 0.2, -0.1], np.diag([0.5, 0.7, 0.4]) + 0.1), 0.3)
BODY, HALF = nh.discretize(nh.RigidBody(np.diag([1.0, 2.0, 3.0])), 0.1), np.diag([-1.0, -1.0, 1.0])


KINDS = {"top": TOP, "four": FOUR, "sleigh": SLEIGH, "motion": MOTION}


@pytest.mark.profile("routes", keep=["top", "sleigh"])
@pytest.mark.parametrize("discrete", KINDS.values(), ids=KINDS)
def test_the_principal_value_is_that_of_a_continuation(discrete: nh.Discretization) -> None:
    """Compiled and traced steps take the root that momentum zero leads to; a millionth or more beyond its fold none."""
    (equations, size), rng = equations_of(discrete.system), np.random.default_rng(1)
    r, unit = 2 * rng.normal(size=(60, discrete.system.rank)), size / discrete.time_step
    path = followed(equations, r)
    ahead = followed(equations, equations.momentum(path.roots, "right"))
    reached = path.whole & ahead.whole & (np.minimum(path.slopes, ahead.slopes) > 0.1)
    assert min(reached.sum(), path.folded.sum()) > 9
    for momentum, *roots in zip(unit * r[reached], path.roots[reached], ahead.roots[reached], strict=True):
        compiled, traced = nh.simulate(discrete, momentum=momentum, steps=1), nh.step(discrete, momentum)
        missed = distance(np.stack([*compiled.displacement, traced.displacement]), np.stack([*roots, roots[1]]))
        assert missed.max() < 1e-12
    beyond = path.s * (1 + 10 ** rng.uniform(-6, 0.3, len(r)))
    for momentum in unit * (beyond[:, None] * r)[path.folded]:
        outcome = nh.simulate(discrete, momentum=momentum, steps=1, throw=False).outcome
        assert outcome in (nh.Outcome.no_real_branch, nh.Outcome.branch_unverified)


def test_following_from_rest_leads_to_the_principal_value() -> None:
    """Also beyond half a turn, where Cayley coordinates end: the path on the sphere from zero to r."""
    frame, rng, far = frame_of("test", ROD), np.random.default_rng(4), 0
    for _ in range(60):
        r = 1.5 * rng.normal(size=2)
        code, x = followed_on_sphere(frame.equations(0 * r), frame.equations(r), np.array([1.0, 0.0, 0.0]))
        result = nh.displacements_over(ROD, r)
        assert (result.principal is None) == (code == nh.Outcome.no_real_branch)
        if result.principal is not None:
            W = frame.increment(x) + np.eye(3)
            assert np.abs(W - result.displacement[result.principal]).max() < 1e-12
            far += x[0] < 0
    assert far > 0


@pytest.mark.parametrize("discrete", [TOP, SLEIGH, MOTION], ids=["top", "sleigh", "motion"])
def test_the_principal_rule_on_the_sphere_steps_as_the_compiled_run(discrete: nh.Discretization) -> None:
    """The rule's own root over each new momentum against the kernels, which never ask it."""
    frame, r = frame_of("test", discrete), 0.2 * np.arange(1, len(discrete.system.constraint_subspace) + 1)
    orbit = nh.simulate(discrete, momentum=r, steps=10)
    code, place = first_place("test", frame, PRINCIPAL, discrete.system.to_canonical(r), None)
    for W in orbit.displacement:
        assert code == 0
        assert place is not None
        assert np.abs(displacement_at(frame, place.point) - W).max() < 1e-13
        code, place = next_place(frame, PRINCIPAL, place)


@pytest.mark.parametrize("name", ["principal", "nearest", "smallest", "largest", "inner", "outer"])
def test_a_rule_bears_its_name(name: str) -> None:
    """One object a name; orbits record it, and the rules but for two need all values."""
    rule = branch_rule("test", name)
    assert (rule.name, rule.is_principal) == (name, name == "principal")
    assert rule.is_nearest == (name == "nearest")


def test_nearest_follows_any_real_value() -> None:
    """From each real displacement the step ends where 200 steps of another continuation end."""
    equations, _ = equations_of(TOP.system)
    for W in _real(nh.displacements_over(TOP, [0.2, 0.3])):
        before, after, root = equations.momentum(W), equations.momentum(W, "right"), W[None]
        for t in np.linspace(0, 1, 201)[1:]:
            root, last = newton(equations, root, (before + t * (after - before))[None])
            assert last < SHARP
        step = nh.step(TOP, nh.discrete_legendre(TOP, W), branch="nearest")
        assert np.abs(step.displacement - root[0]).max() < 1e-12


def _real(result: Branches) -> np.ndarray:
    return result.displacement[result.is_real].real


@pytest.mark.parametrize("discrete", [TOP, SLEIGH, MOTION], ids=["top", "sleigh", "motion"])
@pytest.mark.parametrize(("branch", "sign"), [("smallest", 1), ("largest", -1)])
def test_smallest_and_largest_compare_full_momenta(discrete: nh.Discretization, branch: str, sign: int) -> None:
    """The real value with the smallest or largest norm of all components follows."""
    r = 0.3 * np.arange(1, len(discrete.system.constraint_subspace) + 1)
    after = nh.step(discrete, r, branch=branch)
    result = nh.branches(discrete, momentum=r)
    norms = sign * np.linalg.norm(result.momentum[result.is_real], axis=1)
    assert sign * np.linalg.norm(after.momentum) == pytest.approx(norms.min(), rel=1e-12)


def test_inner_and_outer_stay_in_their_region() -> None:
    """In the regular regime both parts of the invariant curve are invariant under their rule."""
    result = nh.displacements_over(FOUR, [0.2, 0.1])
    assert result.region[result.is_real].tolist() == ["inner", "outer"]
    for rule, W in zip(("inner", "outer"), _real(result), strict=True):
        orbit = nh.simulate(FOUR, displacement=W, steps=10, branch=rule)
        values = [nh.branches(FOUR, displacement=present) for present in orbit.displacement[:-1]]
        pairs = zip(values, orbit.displacement[1:], strict=True)
        assert {str(v.region[np.abs(v.displacement - W).max((1, 2)).argmin()]) for v, W in pairs} == {rule}


def test_of_three_outer_values_the_nearest_is_taken() -> None:
    """The body with four real values has three outer ones; from an outer W the followed one is chosen."""
    result = nh.displacements_over(FOUR, FOUR_REAL)
    assert result.region.tolist() == ["inner", "outer", "outer", "outer"]
    W = _real(result)[1]
    outer, nearest = (nh.step(FOUR, nh.discrete_legendre(FOUR, W), branch=rule) for rule in ("outer", "nearest"))
    np.testing.assert_allclose(outer.displacement, nearest.displacement, rtol=0, atol=1e-12)
    inner = nh.step(FOUR, FOUR_REAL, branch="outer")  # from the inner value the path leads to none of the three
    assert inner.outcome == nh.Outcome.branch_unverified


def test_a_function_gets_the_values_and_the_present() -> None:
    """A callable sees what `branches` finds and W_k, and its index is obeyed."""
    calls = []

    def last_real(result: Branches, present: np.ndarray) -> int:
        calls.append((result, present))
        return int(np.flatnonzero(result.is_real)[-1])

    after = nh.step(TOP, [0.2, 0.3], branch=last_real)
    (result, present), expected = calls[0], nh.branches(TOP, momentum=[0.2, 0.3])
    np.testing.assert_allclose(result.momentum, expected.momentum, rtol=0, atol=1e-11)
    np.testing.assert_allclose(after.momentum, result.momentum[1].real, rtol=1e-12)
    assert np.abs(present - _real(nh.displacements_over(TOP, [0.2, 0.3]))[0]).max() < 1e-12


def test_a_function_without_a_choice_ends_the_run() -> None:
    """None means that there is no real branch by this rule; the fields are then NaN."""
    after = nh.step(TOP, [0.2, 0.3], branch=lambda *_: None)
    assert after.outcome == nh.Outcome.no_real_branch
    assert np.isnan([*after.momentum, *after.displacement.ravel(), *after.multipliers]).all()


def test_values_that_tie_are_unverified() -> None:
    """A round balanced top has J_11 = J_22: both values have the same momentum, and no norm tells them apart."""
    assert nh.step(ROUND, [0.3, 0.4], branch="largest").outcome == nh.Outcome.branch_unverified


@pytest.mark.parametrize("angle", [1.0, 2.5, -0.7])
def test_a_double_value_is_unverified(angle: float) -> None:
    """On the deltoid two values of the sleigh are one: not even a rule that names it determines the next step."""
    arriving = nh.analysis.deltoid(SLEIGH).touching(angle)
    back = _real(nh.displacements_over(SLEIGH, -arriving))[0]
    counts = []

    def double(result: Branches, _: np.ndarray) -> int:
        counts.append(int(result.multiplicity.max()))
        return int(result.multiplicity.argmax())

    after = nh.step(SLEIGH, nh.discrete_legendre(SLEIGH, nh.SE(2).inverse(back)), branch=double)
    assert counts == [2]
    assert after.outcome == nh.Outcome.branch_unverified


def test_a_start_on_a_fold_is_unverified() -> None:
    """The balanced sleigh folds at a quarter turn: its root is double there and cannot be followed."""
    W = nh.SE(2).exp(np.array([np.pi / 2, 0.3, 0.0]))
    orbit = nh.simulate(BALANCED, displacement=W, steps=1, branch="nearest", throw=False)
    assert (len(orbit), orbit.outcome) == (1, nh.Outcome.branch_unverified)


def test_a_value_that_folds_on_the_way_is_not_replaced() -> None:
    """The second value of this sleigh merges and vanishes on the way, though the map has another real value."""
    W = _real(nh.displacements_over(SLEIGH, [0.473, -1.307]))[1]
    orbit = nh.simulate(SLEIGH, displacement=W, steps=3, branch="nearest", throw=False)
    assert (len(orbit), orbit.outcome) == (1, nh.Outcome.no_real_branch)
    assert nh.branches(SLEIGH, displacement=W).is_real.any()


def test_nearest_can_be_traced() -> None:
    """Under `jit` it starts at the principal displacement, and equals the eager step there."""
    with jax.enable_x64(True):
        traced = jax.jit(lambda r: nh.step(TOP, r, branch="nearest").momentum)(np.array([0.2, 0.3]))
    np.testing.assert_allclose(traced, nh.step(TOP, [0.2, 0.3], branch="nearest").momentum, rtol=0, atol=1e-13)


def test_another_rule_is_refused_under_a_trace() -> None:
    """All values of the map are found outside of JAX."""
    with pytest.raises(ValueError, match=r"step\(branch=...\)` must be 'principal' or 'nearest'. Got 'largest' under"):
        jax.jit(lambda r: nh.step(TOP, r, branch="largest").momentum)(np.array([0.2, 0.3]))


def _start(name: str, **options: object) -> dict:
    system, velocity = GENERAL[name]
    return {"discrete": nh.discretize(system, 0.1), "restricted_velocity": velocity, "momentum": None, **options}


# Each refusal names the reason, and "inner" and "outer" advise "nearest"; under a trace all values are not found.
test_rules_that_do_not_apply_are_refused = refusals(
    ({"discrete": TOP, "branch": "closest"}, "must be one of 'principal', 'nearest', .* a function of the branches"),
    ({"discrete": SLEIGH, "branch": "inner"}, "Got 'inner' for ChaplyginSleigh, whose .* Pass 'nearest'"),
    ({"discrete": ROD, "branch": "inner"}, r"Got 'inner' for SuslovTop, .* Pass 'nearest'.* det B > 2\|c\|\^2"),
    ({"discrete": TOP, "branch": "inner", "momentum": [5.0, 5.0]}, "Pass 'nearest', or start slower"),
    ({"discrete": MOTION, "branch": "outer", "momentum": [0.1] * 3}, "no inner and outer part. Pass 'nearest'"),
    (_start("veselova 3", branch="nearest"), "must be 'principal'. Got 'nearest' for a right-invariant"),
    (_start("any d on SO(4)", branch="largest"), "Got 'largest' for LLSystem, of whose values not all are known"),
    ({"discrete": TOP, "branch": "nearest", "backend": "numba"}, "Only 'principal' runs compiled"),
    ({"discrete": TOP, "branch": "largest", "backend": "jax"}, "must be 'auto'. Got 'jax' with branch 'largest'"),
    ({"discrete": TOP, "branch": lambda *_: 2}, "must return the index of a real branch or None. Got 2"),
    ({"discrete": TOP, "branch": "nearest", "momentum": [0.1, 0.2, 9.0]}, "must lie on the momentum locus"),
    ({"discrete": BODY, "branch": "nearest", "momentum": None, "displacement": HALF}, "must turn by less than a half"),
    ask=lambda given: nh.simulate(**{"momentum": [0.2, 0.3], "steps": 2} | given),
)
