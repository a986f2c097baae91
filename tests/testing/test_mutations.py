"""The checks catch what is wrong, and name it: groups, systems and discretizations with one error each."""

import copy
import dataclasses
from collections.abc import Callable
from typing import Any

import jax.numpy as jnp
import numpy as np
import pytest

import nonholo as nh
from nonholo.discrete import _scheme
from nonholo.groups._special_euclidean import SpecialEuclidean2
from nonholo.systems import Equilibria
from nonholo.testing import Report, check_discretization, check_group, check_system

PLANE = nh.SE(2)
SLEIGH = nh.ChaplyginSleigh(1.0, 1.0, 0.5, 0.3)
VESELOVA = nh.VeselovaTop(np.diag([1.0, 2.0, 3.0]))
STEP = 0.2


def names(report: Report) -> set[str]:
    """Return the names of the checks that failed."""
    return {result.name for result in report.failed}


def longer_way_round(_: object, g: Any) -> Any:
    """Return the logarithm, beyond an angle of 2.9 the one of the turn the other way."""
    x = PLANE.log(g)
    xp = x.__array_namespace__()
    angle = x[..., 0]
    other = xp.where(xp.abs(angle) > 2.9, angle - 2 * np.pi * xp.sign(angle), angle)
    return xp.concatenate([other[..., None], x[..., 1:] * (other / xp.where(angle == 0, 1.0, angle))[..., None]], -1)


ADJOINTS = {"adjoint", "adjoint of products", "adjoint of exp"}
LOGARITHMS = {"log of small motions", "log", "log of large turns", "exp of log", "dexp_inverse and log"}
DEXP, TURN = {"dexp_inverse", "dexp_inverse and log"}, [True, False, False]
GROUP_ERRORS: dict[str, tuple[str, Callable[..., Any], set[str]]] = {
    "adjoint of the inverse": ("adjoint", lambda _, g: PLANE.adjoint(PLANE.inverse(g)), ADJOINTS),
    "Ad* with an inverse": ("coadjoint", lambda _, g, p: PLANE.coadjoint(PLANE.inverse(g), p), {"coadjoint"}),
    "log that forgets the path": ("log", lambda _, g: np.where(TURN, PLANE.log(g), PLANE.vee(g)), LOGARITHMS),
    "log the longer way round": ("log", longer_way_round, {"log of large turns"}),
    "dexp of the other side": ("dexp_inverse", lambda _, x: PLANE.dexp_inverse(-x), DEXP),
    "blind residual": ("residual", lambda _, g: 0 * g[..., 0, 0], {"residual"}),
    "NumPy alone": ("angle", lambda _, x: np.abs(np.asarray(x)[..., 0]), {"JAX"}),
    "random matrices": ("random", lambda _, rng: np.eye(3) + rng.normal(size=(3, 3)), {"random"}),
}


@pytest.mark.parametrize("error", GROUP_ERRORS)
def test_errors_of_groups(error: str) -> None:
    """A wrong function fails the checks of that function, in the error too, and no check of another one."""
    method, function, expected = GROUP_ERRORS[error]
    group = type("Wrong", (SpecialEuclidean2,), {method: function})()
    compiled = error == "NumPy alone"  # JAX takes seconds
    report = check_group(group, compiled=compiled, throw=False)
    assert names(report) >= expected
    if error != "random matrices":
        assert names(report) == expected
    with pytest.raises(AssertionError, match=rf"check_group\(SE\(2\)\)` failed {len(report.failed)} of") as raised:
        check_group(group, compiled=compiled)
    assert all(f"\n  {name}: must satisfy" in str(raised.value) for name in expected)


def bare(system: Any) -> Any:
    """Return a copy of a system without what it has computed and kept."""
    other = copy.copy(system)
    for name in vars(other).keys() - {field.name for field in dataclasses.fields(system)}:
        del vars(other)[name]
    return other


def changed(system: Any, **fields: Any) -> Any:
    """Return a copy of a system with fields that its class would refuse."""
    other = bare(system)
    for name, value in fields.items():
        object.__setattr__(other, name, np.asarray(value, dtype=float))
    return other


def overridden(system: Any, **members: Any) -> Any:
    """Return a copy of a system of a class with other members."""
    other = bare(system)
    object.__setattr__(other, "__class__", type("Wrong", (type(system),), members))
    return other


ANY = nh.LLSystem(PLANE, SLEIGH.homogeneous_mass_tensor, np.eye(3)[:2])
ROUND = nh.LLSystem(PLANE, inertia_operator=np.eye(3), constraint_subspace=np.eye(3)[:2])
DOUBLED = nh.ChaplyginSleigh(1.0, 2.0, 0.5, 0.3).inertia_operator
REPELLING = Equilibria(SLEIGH.equilibria().subspace, -SLEIGH.equilibria().attracting)
RESTING = Equilibria(SLEIGH.constraint_subspace, None)
SYSTEM_ERRORS: dict[str, tuple[Any, set[str]]] = {
    "annihilator of another subspace": (changed(ANY, annihilator=[[0, 1, 0.5]]), {"annihilator", "constraint"}),
    "dependent annihilator": (changed(ANY, annihilator=[[0, 1, 0]]), {"complementary", "annihilator", "constraint"}),
    "too few annihilators": (changed(ANY, annihilator=np.zeros((0, 3))), {"sizes", "complementary"}),
    "inertia about another point": (
        overridden(SLEIGH, inertia_operator=DOUBLED),
        {"inertia of the mass tensor", "constrained_inertia", "frame and inertia"},
    ),
    "asymmetric inertia": (changed(ROUND, given_inertia=np.eye(3) + np.eye(3, k=1) / 2), {"inertia symmetric"}),
    "negative inertia": (changed(ROUND, given_inertia=-np.eye(3)), {"inertia positive"}),
    "no frame": (overridden(SLEIGH, frame=np.eye(3)), {"frame and inertia", "frame and energy"}),
    "twice the energy": (
        overridden(SLEIGH, constrained_energy=lambda _, p: 2 * SLEIGH.constrained_energy(p)),
        {"energy", "frame and energy"},
    ),
    "repelling for attracting": (overridden(SLEIGH, equilibria=lambda _: REPELLING), {"attraction"}),
    "everything at rest": (overridden(SLEIGH, equilibria=lambda _: RESTING), {"equilibria"}),
}


@pytest.mark.parametrize("error", SYSTEM_ERRORS)
def test_errors_of_systems(error: str) -> None:
    """A system that contradicts itself fails the checks of what contradicts."""
    system, expected = SYSTEM_ERRORS[error]
    report = check_system(system, throw=False)
    assert names(report) >= expected
    with pytest.raises(AssertionError, match=rf"failed {len(report.failed)} of"):
        check_system(system)


def energy(W: Any) -> Any:
    """Return the discrete Lagrangian of the sleigh."""
    X = W - jnp.eye(3)
    return jnp.trace(X @ jnp.asarray(SLEIGH.homogeneous_mass_tensor) @ X.T) / (2 * STEP)


@pytest.mark.profile("routes", instead="test_a_wrong_momentum")
def test_a_discrete_lagrangian_of_the_wrong_sign() -> None:
    """Minus the kinetic energy is seen at the identity, and in the order of the motion that it gives."""
    report = check_discretization(nh.discretize(SLEIGH, STEP, difference=lambda W: -energy(W)), throw=False)
    assert report["inertia"].value == pytest.approx(2.0)
    assert {"inertia", "order of the start", "order of poses"} <= names(report)
    assert report["left momentum"].passed  # the momentum of the wrong Lagrangian is right


@pytest.mark.profile("routes", instead="test_a_wrong_momentum")
def test_a_discrete_lagrangian_of_first_order() -> None:
    """An odd cubic term leaves every equation in place, but the order falls to one."""

    def lopsided(W: Any) -> Any:
        return energy(W) + (W[1, 0] + W[0, 2]) ** 3 / (10 * STEP)

    report = check_discretization(nh.discretize(SLEIGH, STEP, difference=lopsided), throw=False)
    assert names(report) == {"order of the start", "order of momenta", "order of poses"}
    # ten to forty steps give the slope 1 to a quarter
    assert report["order of poses"].value == pytest.approx(1, abs=0.25)
    assert report["self-adjoint"].value > 1e-2


def test_a_wrong_momentum(monkeypatch: pytest.MonkeyPatch) -> None:
    """Momenta of the wrong side of the displacement are not the derivative of the discrete Lagrangian."""
    right = _scheme.matrix_legendre
    monkeypatch.setattr(_scheme, "matrix_legendre", lambda group, J, X, _: right(group, J, X, "right"))
    report = check_discretization(nh.discretize(SLEIGH, STEP), definition=False, throw=False)
    assert {"left momentum", "momentum equation"} <= names(report)


def test_a_wrong_claim_of_energy() -> None:
    """Energy that is claimed is judged: a constraint fixed in space does not keep it."""
    claiming = type("Claiming", (nh.Discretization,), {"conserves_energy": True})
    report = check_discretization(claiming(VESELOVA, np.float64(STEP)), definition=False, throw=False)
    assert names(report) == {"energy"}


SLOPE = nh.Gravity(force=[0.4, -1.0], point=[0.5, 0.3])
RUB, TABLE = nh.Friction([0.1, 0.2, 0.3]), np.cos(np.arange(90.0)).reshape(30, 3)


def _spring(g: np.ndarray) -> float:
    return float(0.5 * np.sum((g[:2] - 0.3) ** 2))


def _drive(time: float, g: np.ndarray, w: np.ndarray) -> np.ndarray:
    return np.cos(3 * time + np.arange(3)) - 0.4 * w * np.roll(w, 1) + 0.3 * g[0, 1]


def _even(_time: float, _g: np.ndarray, w: np.ndarray) -> np.ndarray:
    return np.array([w[0] ** 2, 0.3, 0.1])


CASES = {
    "nothing": (nh.Forced(SLEIGH), "ok"),
    "weight with friction": (nh.Forced(SLEIGH, SLOPE, RUB), "reported"),
    "friction": (nh.Forced(SLEIGH, force=RUB), "reported"),
    "potential": (nh.Forced(SLEIGH, _spring), "ok"),
    "function": (nh.Forced(SLEIGH, _spring, _drive), "reported"),
    "even force": (nh.Forced(SLEIGH, force=_even), "ok"),
    "table": (nh.Forced(SLEIGH, force=TABLE), "reported"),
    "friction and table": (nh.Forced(SLEIGH, force=(RUB, TABLE)), "reported"),
    "all three": (nh.Forced(SLEIGH, SLOPE, (_drive, RUB, TABLE)), "reported"),
    "veselova": (nh.Forced(VESELOVA, force=_drive), "reported"),
}


@pytest.mark.profile("routes", keep=["0.1-weight*", "0.1-even*"])
@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("time_step", [0.1, 0.01])
def test_forced_systems_pass(name: str, time_step: float) -> None:
    """Systems and maps pass; reversal is judged where forces allow it, and seen to fail where they do not."""
    forced, reversal = CASES[name]
    assert check_system(forced).passed
    report = check_discretization(nh.discretize(forced, time_step))
    assert report.passed
    assert report["reversal"].status == reversal
    assert (report["reversal"].value < 1e-11) == (reversal == "ok")
    assert report["no forces"].status == report["order of the balance"].status == "ok"
    assert (report["friction"].status == "ok") == (name == "friction")


def _scaled(factor: float, original: Callable[..., Any]) -> Callable[..., Any]:
    return lambda *arguments: factor * original(*arguments)


@pytest.mark.parametrize(
    ("kind", "name", "expected"),
    [(nh.Forced, "potential_force", {"potential force", "energy conserved"}), (nh.Friction, "covector", {"friction"})],
)
def test_errors_in_systems(monkeypatch: pytest.MonkeyPatch, kind: Any, name: str, expected: set[str]) -> None:
    """A potential force of the wrong sign, and friction that drives, are named."""
    monkeypatch.setattr(kind, name, _scaled(-1.0, getattr(kind, name)))
    assert names(check_system(nh.Forced(SLEIGH, SLOPE, RUB), throw=False)) == expected


@pytest.mark.profile("routes", keep=["work*"])
@pytest.mark.parametrize(
    ("name", "factor", "expected"),
    [
        ("impulses", 1.1, {"start", "momentum equation", "order of momenta", "order of poses", "order of the balance"}),
        ("work", -1.0, {"order of the balance"}),
        ("propagator", 0.9, {"start", "momentum equation"}),
    ],
)
def test_errors_in_maps(monkeypatch: pytest.MonkeyPatch, name: str, factor: float, expected: set[str]) -> None:
    """A map passes; too large impulses, work of the wrong sign, friction that forgets fail the checks of their own."""
    force = RUB if name == "propagator" else _even
    discrete = nh.discretize(nh.Forced(VESELOVA, force=force), 0.1)  # whose steps call the functions in Python
    assert check_discretization(discrete, definition=False).passed
    monkeypatch.setattr(nh.Forced, name, _scaled(factor, getattr(nh.Forced, name)))
    assert names(check_discretization(discrete, throw=False, definition=False)) >= expected
