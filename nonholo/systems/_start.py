"""The start of a motion, for every kind of run: exactly one start, a pose of the group, an admissible velocity."""

from typing import Any, NamedTuple

import numpy as np

from nonholo.base.checks import array, error, flags, refuse_given, shape_of
from nonholo.base.numerics import applied
from nonholo.base.types import Float
from nonholo.groups import AbstractMatrixGroup
from nonholo.systems._base import System

_TOLERANCE = 1e-9  # relative, for matrices and velocities that a user computed in floating point


class Start(NamedTuple):
    """The one start that a call was given, and the pose there.

    Attributes:
        owner: The function that was called, for messages.
        name: "body_velocity", "restricted_velocity", "momentum" or "displacement".
        value: Its value, not yet checked.
        configuration: The pose, not yet checked; None for the identity.
        project: Whether the admissible start next to it in the kinetic energy is meant.

    Example:
        >>> from nonholo.systems import Start
        >>> start = Start.of("simulate", momentum=(0.4, 0.9, 0.0), body_velocity=None)
        >>> start.name, start.momentum(nh.SuslovTop(np.eye(3)), np.eye(3)).tolist()
        ('momentum', [0.9, -0.4])
    """

    owner: str
    name: str
    value: Any
    configuration: Any = None
    project: bool = False

    @classmethod
    def of(
        cls, owner: str, configuration: Any = None, choices: Any = None, *, project: bool = False, **starts: Any
    ) -> "Start":
        """Return the start of a call, refused if it names none or several, or one that the motion does not have."""
        if project is not False:
            flags(owner, project=project)
        if choices is not None and len(choices) < len(starts):
            for other in [name for name in starts if name not in choices]:
                refuse_in_coordinates(owner, **{other: (starts.pop(other), None)})
        name = one_start(owner, **starts)
        if project and name == "displacement":
            raise error(f"{owner}(project=...)", "be left out", name, "Pass body_velocity instead.")
        return cls(owner, name, starts[name], configuration, project)

    @property
    def where(self) -> str:
        """The argument, for messages."""
        return f"{self.owner}({self.name}=...)"

    def pose(self, group: AbstractMatrixGroup) -> Float[np.ndarray, "N N"]:
        """Return the pose, refused with its distance from the group."""
        if self.configuration is None:
            return group.identity
        return in_group(f"{self.owner}(configuration=...)", group, self.configuration)

    def canonical_pose(self, system: System, g: Float[np.ndarray, "N N"] | None) -> Float[np.ndarray, "size"]:
        """Return the checked pose as a compact one in the canonical frame."""
        return system.frame_pose if self.configuration is None else system.group.pose_from_matrix(g @ system.frame)

    def momentum(self, system: System, g: Float[np.ndarray, "N N"] | None) -> Float[np.ndarray, "k"]:
        """Return the canonical momentum along the constraint that a velocity or a momentum has at a pose."""
        return _ALONG[self.name](self, system, g)


def refuse_in_coordinates(owner: str, **arguments: tuple[Any, Any]) -> None:
    """Refuse arguments that only systems on a group have: each comes with its default.

    Example:
        >>> from nonholo.systems import refuse_in_coordinates
        >>> refuse_in_coordinates("discretize", order=(2, 2))
    """
    remedy = "Leave it out: only tops, sleighs and other LL and LR systems have it."
    refuse_given(owner, "keep its default for a Lagrange-d'Alembert system", remedy, **arguments)


def one_start(owner: str, **starts: Any) -> str:
    """Return the name of the only start that is given, refused if there are none or several."""
    names = [name for name, value in starts.items() if value is not None]
    if len(names) != 1:
        got = " and ".join(names) if names else "none"
        raise error(f"{owner}(...)", "be given exactly one of " + ", ".join(starts), got, "Choose one start.")
    return names[0]


def in_group(where: str, group: AbstractMatrixGroup, element: Any) -> np.ndarray:
    """Return a matrix of the group, refused with its distance from the group."""
    g = array(where, element, group.identity.shape, f"Pass an element of {group} as a matrix.")
    distance = float(group.residual(g))
    if not distance <= _TOLERANCE * np.linalg.norm(g):
        remedy = "Build it with `exp` or `cayley`."
        raise error(where, f"lie in {group}", f"a matrix at distance {distance:.3g}", remedy)
    return g


def inadmissible(where: str, residual: np.ndarray, nearest: np.ndarray) -> ValueError:
    """Return the error of a velocity that does not satisfy the constraint, with the nearest one that does."""
    got = f"residual {np.array2string(residual, precision=6)}"
    return error(where, "satisfy the constraint", got, f"The nearest admissible velocity is {nearest.tolist()}.")


def of_finite_energy(owner: str, system: System, g: np.ndarray | None, along: np.ndarray, pair: Any = ()) -> np.ndarray:
    """Return canonical components of a momentum along the constraint, refused if its energy is not finite.

    The energy is half the product of a momentum and its velocity, the `pair` where both are known.
    """
    if not pair:
        with np.errstate(over="ignore", invalid="ignore"):
            pair = along, system.restricted_velocity(along, g)
    if not abs(energy := np.vdot(*pair) / 2) < np.inf:
        raise error(f"{owner}(...)", "start with a finite energy", f"{energy}", "Start slower, or use other units.")
    return along if system.canonical is system else applied(system.frame_map, along)


def _of_momentum(start: Start, system: System, g: np.ndarray | None) -> np.ndarray:
    k, dim = system.rank, system.group.dim
    size = k if shape_of(start.value) == (k,) else dim
    remedy = f"Pass {dim} body momenta or the {k} along the constraint subspace."
    value = array(start.where, start.value, (size,), remedy)
    return of_finite_energy(start.owner, system, g, value if size == k else system.components_along(value, g))


def _of_velocity(start: Start, system: System, g: np.ndarray | None) -> np.ndarray:
    remedy = "Pass finite coordinates; `vee` turns a matrix into them."
    velocity = array(start.where, start.value, (system.group.dim,), remedy)
    momentum = system.inertia_operator.dot(velocity)  # the bits of @ in half of its time
    along = system.components_along(momentum, g)
    if start.project:
        return of_finite_energy(start.owner, system, g, along)

    frame_velocity = system.constraint_velocity(velocity, g)
    forbidden = system.annihilator.dot(frame_velocity)
    if any(forbidden.tolist()) and np.abs(forbidden).max() > _TOLERANCE * np.abs(frame_velocity).max():
        nearest = frame_velocity - np.linalg.pinv(system.annihilator) @ forbidden
        raise inadmissible(start.where, forbidden, np.linalg.solve(system.carried(g), nearest))
    return of_finite_energy(start.owner, system, g, along, (momentum, velocity))


def _of_coordinates(start: Start, system: System, g: np.ndarray | None) -> np.ndarray:
    rows = array(start.where, start.value, (system.rank,), "Pass one number per admissible direction.")
    along = system.momenta_along(rows, g)
    return of_finite_energy(start.owner, system, g, along, (along, rows))


_ALONG = {"momentum": _of_momentum, "body_velocity": _of_velocity, "restricted_velocity": _of_coordinates}
