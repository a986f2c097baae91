"""A system has the numbers that its functions read when it is made; later changes are seen by what is made later."""

import copy
import functools
import pickle
from collections.abc import Callable, Iterator
from typing import Any, cast

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import nonholo as nh

START: dict[str, Any] = {"configuration": (1.0, 0.0), "body_velocity": (0.0, 0.5)}
READ, ROW, mass = {"mass": 1.0}, np.ones(1), 1.0


class _Body:
    """An object whose method is a Lagrangian."""

    mass = 1.0

    def lagrangian(self, q: Any, v: Any) -> Any:
        return self.mass * v @ v / 2 - q @ q / 2


BODY = _Body()


def change(number: float) -> None:
    """Change what all functions read."""
    global mass
    mass = READ["mass"] = ROW[0] = BODY.mass = number


@pytest.fixture(autouse=True)
def _one() -> Iterator[None]:
    change(1.0)
    yield
    change(1.0)


KINDS: dict[str, Callable[..., Any]] = {
    "global": lambda q, v: mass * v @ v / 2 - q @ q / 2,
    "mapping": lambda q, v: READ["mass"] * v @ v / 2 - q @ q / 2,
    "array": lambda q, v: (ROW * v) @ v / 2 - q @ q / 2,
    "method": BODY.lagrangian,
    "partial": functools.partial(_Body.lagrangian, BODY),
}


def _motions(system: nh.LagrangeDAlembert) -> list[np.ndarray]:
    discrete = nh.discretize(system, 0.1)
    run, flow = nh.simulate(discrete, **START, steps=3), nh.flow(system, **START, times=(0.0, 0.3))
    return [run.configuration, run.energy, flow.configuration, nh.rollout(discrete, **START, steps=3).configuration]


@pytest.mark.profile("routes", instead="test_systems_are_equal_where_their_numbers_are")
@pytest.mark.parametrize("kind", KINDS)
def test_a_system_keeps_the_numbers_of_its_making(kind: str) -> None:
    """A change moves neither a system that has run nor one that has not; a system made after it has other motions."""
    first, waiting = (nh.LagrangeDAlembert(KINDS[kind], None, dimension=2) for _ in range(2))
    before = _motions(first)
    change(4.0)
    after = _motions(nh.LagrangeDAlembert(KINDS[kind], None, dimension=2))
    assert all(np.abs(one - other).max() > 1e-3 for one, other in zip(before, after, strict=True))
    for system in (first, waiting):
        assert all(map(np.array_equal, _motions(system), before))


def _system(name: str, function: Any) -> nh.LagrangeDAlembert:
    arguments = {"lagrangian": _Body().lagrangian, "constraint_forms": None, "dimension": 2, name: function}
    return nh.LagrangeDAlembert(**arguments)


_pull = lambda q: mass * q @ q  # noqa: E731
_action = lambda W, h: mass * jnp.sum((W - jnp.eye(3)) ** 2) / h  # noqa: E731
_blade = lambda g: jnp.array([[0.0, -jnp.sin(mass * g[0, 2]), 1.0]])  # noqa: E731
FREE = _system("name", "free")
PLACES: dict[str, Callable[[], Any]] = {
    **{f"lagrangian, {kind}": functools.partial(_system, "lagrangian", function) for kind, function in KINDS.items()},
    "forms": functools.partial(_system, "constraint_forms", lambda q: jnp.array([[mass, 1.0]]) + 0 * q),
    "holonomic": functools.partial(_system, "holonomic", lambda q: jnp.stack([mass * q[0] - q[1]])),
    "action": functools.partial(_system, "discrete_lagrangian", lambda q, r, h: mass * (r - q) @ (r - q) / h),
    "force": functools.partial(_system, "force", lambda _t, _q, v: -mass * v),
    "joint": lambda: _system("prescribed", {1: MOTION}),
    "potential": lambda: nh.Forced(cast(Any, FREE), _pull),
    "action on a group": lambda: nh.GroupLagrangeDAlembert(nh.SE(2), _action, None),
    "forms on a group": lambda: nh.GroupLagrangeDAlembert(nh.SE(2), _action, _blade),
}
MOTION = lambda time: mass * time**2  # noqa: E731


@pytest.mark.parametrize("place", PLACES)
def test_systems_are_equal_where_their_numbers_are(place: str) -> None:
    """Of the same functions, systems are equal if these read the same numbers, and programs are shared then alone."""
    first = PLACES[place]()
    change(4.0)
    other = PLACES[place]()
    change(1.0)
    same = PLACES[place]()
    assert first != other
    assert first == same
    assert hash(first) == hash(same)


def test_a_potential_makes_another_system() -> None:
    """What is asked of the free system first is not taken for the system under a potential."""
    free = nh.LagrangeDAlembert(lambda _, v: v @ v / 2, None, dimension=2)
    bound, tangents = nh.Forced(free, potential=lambda q: q @ q / 2), []
    for system in (free, bound):
        assert system.lagrangian.digest is not None
        tangents.append(nh.simulate(nh.discretize(system, 0.1), **START, steps=1).tangent[0])
    assert bound != free
    assert np.abs(tangents[1] - tangents[0]).max() > 0.05


def test_a_field_is_the_function_of_its_making() -> None:
    """In 64 bits a field of a system, and a copy of it, gives the value that its function had; of more rows it asks."""
    system, at = nh.LagrangeDAlembert(KINDS["array"], None, dimension=2), (np.zeros(2), np.array([1.0, 2.0]))
    change(3.0)
    with jax.enable_x64(True):
        assert float(copy.deepcopy(system).lagrangian(*at)) == 2.5
    assert float(pickle.loads(pickle.dumps(_system("name", "free"))).lagrangian(*at)) == 2.5  # noqa: S301


SLEIGH = nh.ChaplyginSleigh(1.0, 1.0, 0.3)
_hold = lambda _time, _state: jnp.array([-mass, 0.0, 0.0])  # noqa: E731
_well = lambda g: mass * g[0, 2] ** 2  # noqa: E731
_kinetic = lambda W: 10 * jnp.sum((W - jnp.eye(3)) ** 2 * jnp.array([1.0, mass, 1.0])[:, None])  # noqa: E731
_bent = lambda W: W[1, 2] + (mass - 1) * W[1, 0] ** 3  # noqa: E731
_shaped = lambda s, xi, ds: (xi @ xi + mass * (xi[:2] + ds) @ (xi[:2] + ds)) / 2 + 0 * s[0]  # noqa: E731


def _rolled(system: Any, **options: Any) -> np.ndarray:
    return nh.rollout(nh.discretize(system, 0.1), restricted_velocity=(1.0, 2.5), steps=3, **options).configuration


def _run(**options: Any) -> np.ndarray:
    return nh.simulate(nh.discretize(SLEIGH, 0.1, **options), restricted_velocity=(1.0, 2.5), steps=3).configuration


def _sleigh(p: dict[str, Any]) -> nh.ChaplyginSleigh:
    return nh.ChaplyginSleigh(mass=mass, inertia=p["inertia"], a=0.3)


@functools.cache
def _record() -> dict[str, np.ndarray]:
    orbit = nh.simulate(nh.discretize(SLEIGH, 0.1), restricted_velocity=(1.0, 2.5), steps=10)
    noise = 1e-3 * np.random.default_rng(0).normal(size=(11, 3))
    return dict(zip(("x", "y", "theta"), np.c_[orbit.position, orbit.heading].T + noise.T, strict=True), t=orbit.time)


QUESTIONS: dict[str, Callable[[], Any]] = {
    "policy": lambda: _rolled(SLEIGH, policy=_hold),
    "potential": lambda: _rolled(nh.Forced(SLEIGH, _well)),
    "difference": lambda: _run(difference=_kinetic),
    "constraint": lambda: _run(constraint=_bent),
    "fit": lambda: nh.fit(_sleigh, _record(), {"inertia": 1.0}).parameters["inertia"],
    "shape": lambda: nh.local_connection(nh.ShapedBody(nh.SO(3), ("a", "b"), _shaped)).matrix((0.0, 0.0)),
}


@pytest.mark.profile("routes", instead="test_systems_are_equal_where_their_numbers_are")
@pytest.mark.parametrize("question", QUESTIONS)
def test_a_question_sees_the_numbers_of_its_time(question: str) -> None:
    """Programs that are kept between calls are those of the same numbers."""
    first = QUESTIONS[question]()
    change(2.0)
    assert np.abs(QUESTIONS[question]() - first).max() > 1e-3
