r"""Twelve bodies on eight groups, and their equations of motion as a user of a general solver writes them.

The equations come from the group's structure constants, the basis matrices and the inertia alone, in exact fractions,
so that one function serves floats, arrays of JAX, expressions of heyoka and series of any number of digits:
z = (w, the entries of the pose that move), with $\omega = S^T w$; rotations of three dimensions may be quaternions.
The Veselova top is written with its multiplier, z = (omega, gamma, pose), gamma the vertical seen from the body.
"""

import functools
from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np
from _inside import AbstractSystem

import nonholo as nh
from peers.problems import State, quaternion_matrix

Rates = Callable[[Sequence[Any]], list[Any]]
Number = Callable[[Fraction], Any]
HEISENBERG = nh.MatrixGroup([np.eye(3, k=1) * [0, 1, 0], np.eye(3, k=1) * [0, 0, 1], np.eye(3, k=2)])
LORENTZ = nh.MatrixGroup(np.diag([1.0, 1.0, -1.0]) @ nh.SO(3).basis, form=np.diag([1.0, 1.0, -1.0]))
_CYCLE = ((0, 1, 2), (1, 2, 0), (2, 0, 1))


class Body(NamedTuple):
    """A system and its restricted velocity at the identity, all numbers exact in a few bits."""

    name: str
    system: AbstractSystem
    velocity: np.ndarray

    @property
    def is_rotation(self) -> bool:
        """Whether poses may be quaternions."""
        return self.system.group == nh.SO(3)


def _top(n: int) -> Body:
    diagonal, coupling = 1 + np.arange(n) % 5 / 8, (-1.0) ** np.arange(n - 1) * (1 + np.arange(n - 1) % 3) / 16
    tensor = np.diag(diagonal)
    tensor[-1, :-1] = tensor[:-1, -1] = coupling
    return Body(
        f"top on SO({n})", nh.SuslovTop(tensor), (-1.0) ** (np.arange(n - 1) // 2) * (1 + np.arange(n - 1) % 3) / 8
    )


@functools.cache
def bodies() -> dict[str, Body]:
    """Return the bodies by name."""
    eighths = np.arange(1, 7) / 8
    rows = np.array([[1, 0, 0, 0.5, 0, 0], [0, 1, 0, 0, 0, -0.25], [0, 0, 0.5, 1, 0, 0], [0, 0, 0, 0, 1, 0.75]])
    inertia = np.diag([2, 3, 2.5, 1, 1.5, 1.25]) + (np.eye(6, k=2) + np.eye(6, k=-2)) / 4
    J = np.array([[1.0, 0.25, 0.5], [0.25, 2.0, 0.125], [0.5, 0.125, 4.0]])
    result = [
        Body(
            "top on SO(3)",
            nh.SuslovTop([[1.5, 0.25, 0.5], [0.25, 1, -0.375], [0.5, -0.375, 1]]),
            np.array([0.5, 0.875]),
        ),
        *map(_top, (4, 6, 10)),
        Body("sleigh in the plane", nh.ChaplyginSleigh(1.0, 1.0, 0.5), np.array([1.0, -0.625])),
        Body(
            "sleigh in space",
            nh.MultidimensionalSleigh(2.0, [0.5, 0.25, -0.125], np.diag([1.0, 2.0, 1.5])),
            np.array([0.75, -0.5, 0.25]),
        ),
        Body(
            "Heisenberg",
            nh.LLSystem(
                HEISENBERG, constraint_subspace=[[1, 0, 0.25], [0, 1, 0]], inertia_operator=np.diag([1.0, 2, 3])
            ),
            np.array([0.75, -0.5]),
        ),
        Body("Veselova top", nh.VeselovaTop(np.diag([1.0, 2.0, 3.0])), np.array([0.5, 0.875])),
        Body("free body on SO(3)", nh.RigidBody(np.diag([1.0, 2.0, 3.0])), np.array([0.25, 1.0, 0.125])),
        Body("body on SO(4)", nh.LLSystem(nh.SO(4), np.diag([1, 2, 2.5, 1.5]), np.eye(6)[:4]), eighths[:4]),
        Body("body on SE(3)", nh.LLSystem(nh.SE(3), constraint_subspace=rows, inertia_operator=inertia), eighths[:4]),
        Body(
            "top on SO(2, 1)",
            nh.LLSystem(LORENTZ, J @ LORENTZ.form, annihilator=[[0.0, 0.0, 1.0]]),
            np.array([0.5, 0.25]),
        ),
    ]
    return {body.name: body for body in result}


def exact(x: Any) -> np.ndarray:
    """Return an array of fractions."""
    return np.vectorize(Fraction, otypes=[object])(np.asarray(x, dtype=float))


def solved(matrix: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Return the solution of linear equations in fractions, by elimination."""
    n = len(matrix)
    rows = np.concatenate([matrix, right], axis=1)
    for i in range(n):
        pivot = next(j for j in range(i, n) if rows[j, i])
        rows[[i, pivot]] = rows[[pivot, i]]
        rows[i] = rows[i] / rows[i, i]
        for j in set(range(n)) - {i}:
            rows[j] = rows[j] - rows[j, i] * rows[i]
    return rows[:, n:]


def _torques(body: Body) -> np.ndarray:
    r"""Return T of $w_i' = \sum_{a\le b} T_{iab} w_a w_b$.

    It follows from $\langle ad^*_\omega p, S_i\rangle = \langle p, [\omega, S_i]\rangle$.
    """
    system, k = body.system, len(body.velocity)
    S, inertia, units = exact(system.constraint_subspace), exact(system.inertia_operator), np.eye(system.group.dim)
    constants = exact(system.group.bracket(units[:, None], units[None]))
    brackets = np.tensordot(S, np.tensordot(S, constants, (1, 1)), (1, 1))  # [S_b, S_i] as (b, i)
    momenta = S @ inertia
    torque = np.tensordot(brackets, momenta, (2, 1))  # (b, i, a)
    joined = torque.transpose(1, 2, 0) + torque.transpose(1, 0, 2)
    upper = joined * exact(np.triu(np.ones((k, k))) - np.eye(k) / 2)
    return solved(momenta @ S.T, upper.reshape(k, k * k)).reshape(k, k, k)


def _is(x: Any, whole: int) -> bool:
    """Tell a zero or one of the notation from numbers and expressions."""
    return type(x) is int and x == whole


def _sum(*terms: Any) -> Any:
    result = [x for x in terms if not _is(x, 0)]
    return functools.reduce(lambda a, b: a + b, result) if result else 0


def _product(x: Any, y: Any) -> Any:
    if _is(x, 0) or _is(y, 0):
        return 0
    return y if _is(x, 1) else x * y


def _dot(xs: Any, ys: Any) -> Any:
    return _sum(*(_product(x, y) for x, y in zip(xs, ys, strict=True)))


def _written(row: Any, number: Number) -> list[Any]:
    """Return coefficients, in which zeros and ones are left out of what is written with them."""
    return [int(c) if c in (0, 1) else number(c) for c in row]


def _moving(body: Body) -> np.ndarray:
    """Return which entries of a pose move that begins at the identity."""
    group, S = body.system.group, body.system.constraint_subspace
    used = (group.hat(np.eye(group.dim) if body.system.is_spatial else S) != 0).any(axis=0)
    N, moving = len(used), np.zeros_like(used)
    for _ in range(N):
        moving = (np.eye(N, dtype=bool) | moving) @ used
    return moving


def _turning(omega: Sequence[Any], pose: Sequence[Any], number: Number) -> list[Any]:
    """Return the rates of a quaternion."""
    q, x, y, z = pose
    half = number(Fraction(1, 2))
    rows = [[-x, -y, -z], [q, -z, y], [z, q, -x], [-y, x, q]]
    return [half * _dot(row, omega) for row in rows]


def _carried(body: Body, omega: Sequence[Any], pose: Sequence[Any], number: Number) -> list[Any]:
    """Return the rates of the entries of a pose that move."""
    group, moving = body.system.group, _moving(body)
    basis = exact(group.hat(np.eye(group.dim)))
    g: list = np.eye(len(moving), dtype=int).tolist()
    for (i, j), x in zip(np.argwhere(moving).tolist(), pose, strict=True):
        g[i][j] = x
    X = [[_dot(_written(basis[:, i, j], number), omega) for i in range(len(g))] for j in range(len(g))]
    return [_dot(g[i], X[j]) for i, j in np.argwhere(moving).tolist()]


def rates_of(body: Body, number: Number = float, turned: bool = False) -> Rates:
    """Return the equations: of numbers that `number` makes of fractions, with quaternions or matrices."""
    k = len(body.velocity)

    def posed(omega: Sequence[Any], pose: Sequence[Any]) -> list[Any]:
        return _turning(omega, pose, number) if turned else _carried(body, omega, pose, number)

    if body.system.is_spatial:
        return lambda z: [*_veselova(body, z[:3], z[3:6], number), *posed(z[:3], z[6:])]
    torques, S = _torques(body), exact(body.system.constraint_subspace)

    def rates(z: Sequence[Any]) -> list[Any]:
        w = z[:k]
        slopes = [_dot(w, [_dot(_written(row, number), w) for row in rows]) for rows in torques]
        return [0 * w[0] if _is(x, 0) else x for x in slopes] + posed(
            [_dot(_written(row, number), w) for row in S.T], z[k:]
        )

    return rates


def _veselova(body: Body, w: Sequence[Any], gamma: Sequence[Any], number: Number) -> list[Any]:
    r"""Return $\omega'$ and $\gamma'$: $I\omega' = I\omega\times\omega + \lambda\gamma$, $\gamma\cdot\omega' = 0$."""
    inertia = [Fraction(x) for x in np.diag(body.system.inertia_operator)]
    assert np.count_nonzero(body.system.inertia_operator) == 3
    free = [number((inertia[b] - inertia[c]) / inertia[a]) * (w[b] * w[c]) for a, b, c in _CYCLE]
    normal = [number(1 / moment) * x for moment, x in zip(inertia, gamma, strict=True)]
    multiplier = _dot(gamma, free) / _dot(gamma, normal)
    vertical = [gamma[b] * w[c] - gamma[c] * w[b] for _, b, c in _CYCLE]
    return [*(x - multiplier * y for x, y in zip(free, normal, strict=True)), *vertical]


def first_of(body: Body, turned: bool = False) -> np.ndarray:
    """Return the first state: at the identity."""
    pose = np.eye(4)[0] if turned else np.eye(len(_moving(body)))[_moving(body)]
    if body.system.is_spatial:
        return np.concatenate([body.velocity @ body.system.constraint_subspace, np.eye(3)[2], pose])
    return np.concatenate([body.velocity, pose])


def state_of(body: Body, z: Any, turned: bool = False) -> State:
    """Return body velocity and pose, a matrix."""
    z, k = np.asarray(z), len(body.velocity)
    velocity = z[:3] if body.system.is_spatial else z[:k] @ body.system.constraint_subspace
    rest = z[6 if body.system.is_spatial else k :]
    if turned:
        return State(velocity, quaternion_matrix(rest))
    pose = np.eye(len(_moving(body)), dtype=z.dtype)
    pose[_moving(body)] = rest
    return State(velocity, pose)
