"""The kinds of motion: how each is made, from what it starts, and what in it is the user's own."""

import dataclasses
import functools
import types
from collections.abc import Callable
from typing import Any

import numpy as np
from bodies import mass_tensor

import nonholo as nh

H, STEPS = 0.1, 12
_RNG = np.random.default_rng(5)
_TOP, _FIVE, _BODY = (mass_tensor(group, _RNG) for group in (nh.SO(3), nh.SO(5), nh.SE(3)))
_ROWS = np.linalg.qr(_RNG.normal(size=(6, 4)))[0].T
_TABLE = _RNG.normal(size=(4 * STEPS, 3))
_LORENTZ = [[[0, 1, 0], [1, 0, 0], [0, 0, 0]], [[0, 0, 1], [0, 0, 0], [1, 0, 0]], [[0, 0, 0], [0, 0, -1], [0, 1, 0]]]
_FRICTION, _WEIGHT, _POINT = [0.1, 0.2, 0.0], [0.2, -1.0], [0.5, 0.1]
_SLEIGH = {"kind": "sleigh", "mass": 2.0, "inertia": 1.0, "a": 0.5, "b": 0.3}


@dataclasses.dataclass(frozen=True, eq=False)
class Action:
    """A discrete Lagrangian of the user's own: that of the top, written by hand."""

    mass_tensor: Any
    time_step: float

    def __call__(self, W: Any) -> Any:
        """Return the time step times the Lagrangian of (W - I) / h."""
        import jax.numpy as jnp

        X = W - jnp.eye(3)
        return jnp.trace(X @ jnp.asarray(self.mass_tensor) @ X.T) / (2 * self.time_step)


def brake(time: float, g: np.ndarray, velocity: np.ndarray) -> np.ndarray:
    """Return a force of the user's own, which depends on time, place and velocity."""
    return -0.3 * np.cos(time) * velocity + 0.1 * g[0, :3]


@functools.cache
def compiled_brake() -> Callable[..., Any]:
    """Return the same force, compiled."""
    import numba

    return numba.njit(brake)


@dataclasses.dataclass(frozen=True)
class Kind:
    """A kind of motion.

    Attributes:
        about: How a user writes it.
        system: A function of one parameter of the body that makes what moves.
        parameter: The name of that parameter.
        values: Two values of it; the first is that of runs.
        body: The body as a scenario file writes it; empty where none does.
        forces: What acts on it, as a scenario file writes it.
        how: Options of `discretize`, which scenario files have, too.
        own: Options of `discretize` that are the user's functions, for a time step.
        branch: The branch rule.
        traits: What rules of abilities ask for: "composition", "table", "rule", "coordinates", "ready system",
            "function" (of the user's), "opaque" (a function that JAX does not see into), "wide" (hundreds of
            dimensions), "driven" (by prescribed motions).
        time_step: That of its runs.
        made: Returns the function of numbers by name that makes the system with a start; None where there is none.
    """

    about: str
    system: Callable[[Any], Any]
    parameter: str
    values: tuple[Any, Any]
    body: dict[str, Any] = dataclasses.field(default_factory=dict)
    forces: dict[str, Any] = dataclasses.field(default_factory=dict)
    how: dict[str, Any] = dataclasses.field(default_factory=dict)
    own: Callable[[float], dict[str, Any]] = lambda _: {}
    branch: str = "principal"
    traits: frozenset[str] = frozenset()
    time_step: float = H
    made: Callable[[], Callable[..., Any] | None] = lambda: None

    def discrete(self, time_step: float, value: int = 0) -> Any:
        """Return the discretized system."""
        return nh.discretize(self.system(self.values[value]), time_step, **self.how, **self.own(time_step))


def _tensor(about: str, system: Any, tensor: Any, kind: str = "", parameter: str = "mass_tensor", **more: Any) -> Kind:
    """Return the kind of a body that has a tensor."""
    body = {"kind": kind, parameter: np.asarray(tensor).tolist(), **more.pop("body", {})} if kind else {}
    return Kind(about, system, parameter, (tensor, 1.1 * np.asarray(tensor)), body, **more)


def _plane(about: str, load: Callable[[Any], Any], *traits: str, **more: Any) -> Kind:
    """Return the kind of a sleigh of the plane under a load."""
    own = "function" in traits
    things = functools.partial(_loaded, load)
    return Kind(about, things, "a", (0.5, 0.7), {} if own else _SLEIGH, traits=frozenset(traits), **more)


def _loaded(load: Callable[[Any], Any], a: float) -> Any:
    return load(nh.ChaplyginSleigh(2.0, 1.0, a, 0.3))


def ready(
    name: str, *traits: str, parameter: str = "mass", values: tuple[Any, Any] = (1.0, 1.5), time_step: float = H
) -> Kind:
    """Return the kind of a ready system."""
    return Kind(
        f"`nh.examples.{name}`",
        lambda value: getattr(nh.examples, name)(**{parameter: value}).system,
        parameter,
        values,
        {"kind": name, parameter: values[0]},
        traits=frozenset({"ready system", *traits}),
        time_step=time_step,
        made=lambda: getattr(nh.examples, name),
    )


def _action(W: Any, time_step: Any, p: Any) -> Any:
    xp, m, arm = W.__array_namespace__(), p["mass"], 0.3
    X = W - xp.eye(3)
    turns, moves = X[:2, 0] @ X[:2, 0], X[:2, 2] @ X[:2, 2] + 2 * arm * X[:2, 2] @ X[:2, 0]
    return ((0.4 + m * arm**2) * turns + m * moves) / (2 * time_step)


def _blade(g: Any, _: Any) -> Any:
    xp = g.__array_namespace__()
    angle = 0.6 * xp.sin(g[0, 2]) + 0.3 * g[1, 2]
    return xp.stack([0.0 * angle, -xp.sin(angle), xp.cos(angle)])[None]


def _motor(time: Any, g: Any, w: Any, p: Any) -> Any:
    xp = w.__array_namespace__()
    return xp.stack([p["torque"] * xp.cos(2 * time) - 0.1 * w[0], 0.2 * g[0, 0], -0.1 * w[2]])


@functools.cache
def _motored_body() -> Any:
    """Return a body in the plane whose blade turns in it with the place, driven by a motor of the time."""
    numbers, name = {"mass": 1.0, "torque": 0.5}, "Motored body"
    return nh.GroupLagrangeDAlembert(nh.SE(2), _action, _blade, force=_motor, parameters=numbers, name=name)


def motored_body(*, mass: float = 1.0, torque: float = 0.5) -> Any:
    """Return it with its start."""
    system = _motored_body().with_parameters(mass=mass, torque=torque)
    return types.SimpleNamespace(
        system=system, configuration=np.eye(3), body_velocity=np.array([0.7, 0.9, 0.0]), name="motored_body"
    )


def _arrow(diagonal: Any) -> Any:
    return nh.SuslovTop.arrowhead(diagonal, np.full(299, 0.01))


KINDS: dict[str, Kind] = {
    "top, n = 3": _tensor("`nh.SuslovTop(J)`", nh.SuslovTop, _TOP, "suslov"),
    "top, n = 5": _tensor("the same on SO(5)", nh.SuslovTop, _FIVE, "suslov"),
    "arrowhead, n = 300": Kind(
        "`nh.SuslovTop.arrowhead`",
        _arrow,
        "diagonal",
        (np.linspace(1, 2, 300), np.linspace(1.2, 2, 300)),
        traits=frozenset({"wide"}),
    ),
    "sleigh, SE(2)": _plane("`nh.ChaplyginSleigh`", lambda sleigh: sleigh),
    "sleigh, SE(3)": _tensor(
        "`nh.MultidimensionalSleigh`",
        lambda tensor: nh.MultidimensionalSleigh(1.5, [0.3, 0.1, 0.2], tensor),
        _TOP,
        "multidimensional_sleigh",
        body={"mass": 1.5, "center_of_mass": [0.3, 0.1, 0.2]},
    ),
    "LL by matrices": _tensor(
        "`nh.LLSystem(nh.SE(3), J, rows)`",
        lambda tensor: nh.LLSystem(nh.SE(3), tensor, _ROWS),
        _BODY,
        "left_invariant",
        body={"group": "SE(3)", "constraint_subspace": _ROWS.tolist()},
    ),
    "free body": _tensor("`nh.RigidBody(J)`", nh.RigidBody, _TOP, "rigid_body"),
    "Veselova top": _tensor("`nh.VeselovaTop(J)`", nh.VeselovaTop, _TOP, "veselova"),
    "own group": _tensor(
        "`nh.LLSystem(nh.MatrixGroup(basis), ...)`",
        lambda tensor: nh.LLSystem(
            nh.MatrixGroup(_LORENTZ), constraint_subspace=np.eye(3)[:2], inertia_operator=tensor
        ),
        np.diag([2.0, 1.0, 1.5]),
        "left_invariant",
        "inertia_operator",
        body={"group": {"basis": _LORENTZ}, "constraint_subspace": np.eye(3)[:2].tolist()},
    ),
    "logarithmic": _tensor(
        '`difference="logarithmic"`', nh.SuslovTop, _TOP, "suslov", how={"difference": "logarithmic"}
    ),
    "own difference": _tensor(
        "`difference=` a function",
        nh.SuslovTop,
        _TOP,
        own=lambda h: {"difference": Action(_TOP, h)},
        traits=frozenset({"function"}),
    ),
    "order 4": _plane("`order=4`", lambda sleigh: sleigh, "composition", how={"order": 4}),
    "rule nearest": _tensor(
        '`branch="nearest"`', nh.SuslovTop, _TOP, "suslov", branch="nearest", traits=frozenset({"rule"})
    ),
    "gravity": _plane(
        "`nh.Forced(sleigh, nh.Gravity(...))`",
        lambda sleigh: nh.Forced(sleigh, nh.Gravity(_WEIGHT, _POINT)),
        forces={"gravity": {"force": _WEIGHT, "point": _POINT}},
    ),
    "friction, table": _plane(
        "`nh.Friction` and a force for each step",
        lambda sleigh: nh.Forced(sleigh, force=(nh.Friction(_FRICTION), _TABLE)),
        "table",
        forces={"friction": _FRICTION, "table": _TABLE.tolist()},
    ),
    "force in Python": _plane(
        "`force=` a function", lambda sleigh: nh.Forced(sleigh, force=brake), "function", "opaque"
    ),
    "force in numba": _plane(
        "`force=` a compiled function", lambda sleigh: nh.Forced(sleigh, force=compiled_brake()), "function", "opaque"
    ),
    "particle": ready("particle", "coordinates"),
    "rolling disk": ready("rolling_disk", "coordinates"),
    "snakeboard": ready("snakeboard", "coordinates"),
    "driven sleigh": ready("driven_sleigh", "coordinates", "driven"),
    "Chaplygin ball": ready("chaplygin_ball", "coordinates"),
    "driven on a group": Kind(
        "`nh.GroupLagrangeDAlembert(..., force=)`",
        lambda value: motored_body(mass=value).system,
        "mass",
        (1.0, 1.5),
        traits=frozenset({"coordinates", "driven", "function"}),
        made=lambda: motored_body,
    ),
    "sleigh in a well": ready("sleigh_in_a_well", "opaque", parameter="inertia", values=(0.5, 0.7)),
}
