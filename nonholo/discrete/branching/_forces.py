r"""The values of a step under forces of the scheme "energy": equations with half impulses at the displacement.

A weight or another potential that is linear in the pose pulls by half impulses that are affine in the Cayley
coordinates $y = z/z_0$, viscous friction by $-K z_0 v$, $v = (z, u)$; a row of a table moves the target. Multiplied by
$z_0$ the equations of `_equations` stay polynomials.

Reference: docs/theory/branches.md, "Under forces".
"""

import dataclasses
import functools
from typing import Any, cast

import numpy as np

from nonholo.base.checks import error
from nonholo.base.numerics import applied
from nonholo.base.results import Outcome
from nonholo.base.types import Array, Float, Inexact
from nonholo.discrete._discretization import Discretization
from nonholo.discrete._scheme import legendre
from nonholo.discrete.branching._equations import Equations, Frame, frame_of
from nonholo.discrete.branching._roots import by_loops, disturb, polish
from nonholo.systems import Forced, in_group

_CIRCLES = 0.83, 6.0, 40.0  # radii on which polynomials are sampled: each sees the roots of its own size
_BEGIN = 0.1  # the angle of the first place on them
_TURN = 0.7  # by which coordinates are turned, lest two roots share one
_SEEN = 1e-13  # of the largest term of a resultant, below which one is none
_STARTS = 400  # of Newton's method on a generic problem
_DEGREE = 4  # of a polynomial in each coordinate


@dataclasses.dataclass(frozen=True, eq=False)
class Pulled(Equations):
    r"""The equations $z_0\,(\dots - r + K z_0v) = Nz$, without the factor z_0 where N = 0.

    Attributes:
        pull: N, a row for each of r and p.
        drag: K.
    """

    pull: Inexact[Array, "m k"] = dataclasses.field(default_factory=lambda: np.zeros((0, 0)))
    drag: Inexact[Array, "m m"] = dataclasses.field(default_factory=lambda: np.zeros((0, 0)))

    @property
    def parameters(self) -> tuple[str, ...]:  # type: ignore[override]
        """The names of all numbers."""
        return (*Equations.parameters, "pull", "drag", *(() if self.lever is None else ("lever",)))

    @property
    def is_pulled(self) -> bool:
        """Whether there is a factor z_0, and no half-turn is a root."""
        return bool(np.any(self.pull))

    @property
    def is_balanced(self) -> bool:
        """Whether the equations are odd."""
        return super().is_balanced and not self.is_pulled

    @property
    def count(self) -> int:
        """Number of complex roots in general; of special forces on more than two coordinates y there are fewer."""
        k = len(self.stiffness)
        if not self.is_pulled:
            return super().count
        if self.arm:
            return (k + 1) ** 2 - (k == 2 and _is_weight(self.pull))
        return k * k + k + 1 if np.any(self.coupling) else 2 * k + 1

    def around(self) -> tuple[Equations, Inexact[np.ndarray, "B m"]]:
        """Return a generic problem of as many coordinates and its roots."""
        return _around(len(self.stiffness), self.lever is not None)

    def residual(self, x: Inexact[Array, "... m"]) -> tuple[Inexact[Array, "... m"], Inexact[Array, "... m"]]:
        """Return the equations and the sizes of their terms."""
        (rows, sizes), m, z0 = super().residual(x), len(self.drag), x[..., :1]
        rows[..., :m] += z0 * applied(self.drag, x[..., 1:])
        sizes[..., :m] += np.abs(z0) * applied(np.abs(self.drag), np.abs(x[..., 1:]))
        if self.is_pulled:
            z = x[..., 1 : 1 + len(self.stiffness)]
            rows[..., :m] = z0 * rows[..., :m] - applied(self.pull, z)
            sizes[..., :m] = np.abs(z0) * sizes[..., :m] + applied(np.abs(self.pull), np.abs(z))
        return rows, sizes

    def slope(self, x: Inexact[Array, "... m"]) -> Inexact[Array, "... m m"]:
        """Return the derivative of the residual."""
        J, m, z0 = super().slope(x) + 0 * self.drag[0, 0], len(self.drag), x[..., :1, None]
        J[..., :m, 0] += applied(self.drag, x[..., 1:])
        J[..., :m, 1:] += z0 * self.drag
        if self.is_pulled:
            free, _ = dataclasses.replace(self, pull=0 * self.pull).residual(x)
            J[..., :m, :] *= z0
            J[..., :m, 0] += free[..., :m]
            J[..., :m, 1 : 1 + len(self.stiffness)] -= self.pull
        return J

    def regularity(self, x: Inexact[Array, "... m"]) -> Float[np.ndarray, "..."]:
        """Return the least singular value of the derivative along the sphere, without the factor z_0."""
        least = super().regularity(x)
        return least / np.abs(x[..., 0]) if self.is_pulled else least

    def starts(self) -> Inexact[Array, "B m"]:
        """Return approximate roots, by elimination; none of more than two coordinates y, whose roots are followed."""
        k, radius = len(self.stiffness), _CIRCLES[0]
        if k > 2:
            return np.zeros((0, 1 + len(self.drag)))
        if k == 1:
            _, values = _eliminate(self, _circle(2 * _DEGREE, radius)[:, None])
            y = np.roots(_coefficients(values[:, 0], 0, radius)[_DEGREE::-1])[:, None]
        else:
            y = np.concatenate([_bivariate(self, radius) for radius in _CIRCLES])
        q, _ = _eliminate(self, y)
        points = np.concatenate([np.ones((len(y), 1)), y, q], axis=1)
        return points / np.sqrt(1 + (y * y).sum(axis=1, keepdims=True))


@functools.cache
def _around(k: int, slides: bool) -> tuple[Pulled, Inexact[np.ndarray, "B m"]]:
    """Return a generic problem and its roots: some by Newton's method, the others where loops of problems lead them."""
    rng, m, none = np.random.default_rng(0), k + slides, np.zeros(k)
    still = Pulled(none, none, none, 0.0 if slides else None, 0.0, np.zeros((m, k)), np.zeros((m, m)))
    generic = disturb(still, rng)
    points = rng.normal(size=(_STARTS, 1 + m, 2)) @ np.array([1.0, 1j])
    points[:, : 1 + k] /= np.sqrt((points[:, : 1 + k] ** 2).sum(axis=1, keepdims=True))
    first = polish(generic, points)
    return generic, by_loops(generic, first, lambda: disturb(still, rng), lambda roots: len(roots) >= generic.count)


def _is_weight(pull: Inexact[Array, "3 2"]) -> bool:
    """Return whether N of a sleigh in space is of weights at one point, a number times y but for the slide's row."""
    aside = np.array([-pull[2, 1], pull[2, 0]])
    bent = pull[:2] @ aside
    return bool(abs(aside[0] * bent[1] - aside[1] * bent[0]) <= _SEEN * np.linalg.norm(aside) * np.linalg.norm(bent))


def _eliminate(equations: Pulled, y: Inexact[Array, "... k"]) -> tuple[Array, Array]:
    """Return u/z_0, which its equation determines, and the polynomials in y that are left."""
    k, has_length, w = len(equations.stiffness), equations.lever is not None, 1 + (y * y).sum(axis=-1, keepdims=True)

    def rows_at(q: Array) -> Array:
        rows, _ = equations.residual(np.concatenate([np.ones_like(w), y, q], axis=-1) / np.sqrt(w))
        return (rows * w * (np.sqrt(w) if equations.is_pulled else 1.0))[..., : k + has_length]

    if not has_length:
        none = np.zeros((*y.shape[:-1], 0))
        return none, rows_at(none)
    first, second = rows_at(np.zeros_like(w)), rows_at(np.ones_like(w))
    q = -first[..., k:] / (second - first)[..., k:]
    return q, (first + q * (second - first))[..., :k]


def _circle(n: int, radius: float) -> Array:
    return radius * np.exp(2j * np.pi * np.arange(n) / n + 1j * _BEGIN)


def _coefficients(values: Array, axis: int, radius: float) -> Array:
    """Return the coefficients of a polynomial, from the lowest on, from its values on a circle."""
    n = values.shape[axis]
    powers = (radius * np.exp(1j * _BEGIN)) ** np.arange(n)
    return np.moveaxis(np.moveaxis(np.fft.fft(values, axis=axis), axis, -1) / n / powers, -1, axis)


def _bivariate(equations: Pulled, radius: float) -> Inexact[Array, "B 2"]:
    """Return the common roots of two polynomials in turned coordinates, by their resultant."""
    n, d = 2 * _DEGREE, _DEGREE if equations.arm else _DEGREE - 1
    turn = np.array([[np.cos(_TURN), -np.sin(_TURN)], [np.sin(_TURN), np.cos(_TURN)]])
    t = np.stack(np.meshgrid(_circle(n, radius), _circle(n, radius), indexing="ij"), axis=-1)
    _, values = _eliminate(equations, t @ turn.T)
    both = _coefficients(_coefficients(values @ turn, 0, radius), 1, radius)[: d + 1, : d + 1]
    here = _circle(4 * n, radius)[:, None] ** np.arange(d + 1)
    rows, sylvester = np.einsum("pa,abi->pib", here, both), np.zeros((4 * n, 2 * d, 2 * d), dtype=complex)
    for i in range(d):
        sylvester[:, i, i : i + d + 1], sylvester[:, d + i, i : i + d + 1] = rows[:, 0], rows[:, 1]
    resultant = _coefficients(np.linalg.det(sylvester), 0, radius)[d * d :: -1]
    sizes = np.abs(resultant) * radius ** np.arange(d * d, -1, -1)
    pairs = []
    for first in np.roots(resultant[np.argmax(sizes > _SEEN * sizes.max()) :]):
        one, other = np.einsum("a,abi->ib", first ** np.arange(d + 1), both)[:, ::-1]
        seconds = np.roots(one)
        if len(seconds):
            pairs.append((first, seconds[np.argmin(np.abs(np.polyval(other, seconds)))]))
    return np.array(pairs, dtype=complex).reshape(-1, 2) @ turn.T


@dataclasses.dataclass(frozen=True, eq=False)
class Node:
    """Where a step under forces begins: at a pose, with a number.

    Attributes:
        discrete: The discretization with its forces.
        frame: The frame of the equations of the body inside.
        configuration: g, in the user's frame.
        step: The number of the step, whose row of a table acts.
    """

    discrete: Discretization
    frame: Frame
    configuration: Float[np.ndarray, "N N"]
    step: int

    @property
    def forced(self) -> Forced:
        """The system with its forces."""
        return cast(Forced, self.discrete.forces)

    def equations(self, canonical: Inexact[np.ndarray, "k"]) -> Equations:
        """Return the equations over a canonical restricted momentum."""
        h, m, frame = float(self.discrete.time_step), self.forced.rank, self.frame
        still, pull, drag = self._half_impulses
        free = frame.equations(h * (canonical + still))
        if self.forced.friction is None and not np.any(pull):
            return free
        rows = [frame.equations(row) for row in np.eye(m)]
        targets = [row.target if row.lever is None else np.append(row.target, row.push) for row in rows]
        to_rows = h * np.transpose(targets)  # from canonical momenta
        to_chart = frame.chart(np.concatenate([np.ones((m, 1)), np.eye(m)], axis=1)).T  # times z_0, from (z, u)
        along = to_chart[:, : len(frame.stiffness)]
        return Pulled(**vars(free), pull=to_rows @ pull @ along, drag=to_rows @ drag @ to_chart)

    @functools.cached_property
    def _half_impulses(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Half impulses along the constraint at the identity, what Cayley coordinates of one add, and friction."""
        forced, group, h = self.forced, self.forced.group, float(self.discrete.time_step)
        m, drag = forced.rank, np.zeros((forced.rank, forced.rank))
        W = self.frame.discrete.displaced(np.concatenate([np.zeros((1, m)), np.eye(m)]))
        row = np.repeat(forced.rows(np.array([self.step])), m + 1, axis=0)
        poses = np.repeat(self.configuration[None], m + 1, axis=0)
        still = dataclasses.replace(forced, force=None).mean_force(poses, W, h, row)
        along = forced.to_canonical(forced.restrict(still))
        if forced.friction is not None:
            velocities = group.vee(forced.from_canonical_frame(group.hat(self.frame.discrete.variety.chart)))
            drag = forced.to_canonical(forced.restrict(-forced.friction.covector(velocities))).T
        return h / 2 * along[0], h / 2 * (along[1:] - along[0]).T, drag

    def principal(self, canonical: Float[np.ndarray, "k"]) -> tuple[Outcome, Array]:
        """Return the outcome and the verified principal displacement, canonical, minus the identity."""
        route, group = cast(Any, self.discrete.route), self.forced.group
        pose = route.encode_poses(group.pose_from_matrix(self.configuration @ self.forced.frame))
        code, state = route.runs.start(route.body_from(self.step), route.encode(canonical), pose)
        chart = route.from_kernel(route.runs.chart_of(route.body, state))
        return Outcome(code), self.discrete.variety.increment(chart) if code == 0 else None

    def following(self, X: Float[np.ndarray, "N N"]) -> tuple["Node", Float[np.ndarray, "k"]]:
        """Return the node after a displacement, given minus the identity, and the restricted momentum there."""
        h, W = float(self.discrete.time_step), X + self.forced.group.identity
        row = self.forced.rows(np.array([self.step]))
        force = self.forced.mean_force(self.configuration[None], W[None], h, row)[0]
        momentum = legendre(self.frame.discrete, X, "right") + h / 2 * force
        after = dataclasses.replace(self, configuration=self.configuration @ W, step=self.step + 1)
        return after, self.forced.restrict(momentum)


def node_of(owner: str, discrete: Discretization, configuration: object, step: int) -> Node:
    """Return where a step under forces begins, refused where not all its values are known."""
    forced, where, group = cast(Forced, discrete.forces), f"{owner}(discrete=...)", discrete.system.group
    demand = "have forces that act at the displacement (scheme 'energy')"
    if forced.slips:
        remedy = "Pass the system without the Slip, or with fixed rows."
        raise error(where, demand, "a Slip, whose rows hold or slide", remedy)
    if not discrete.is_balanced:
        remedy = "Pass the system inside, and the momentum after the kick."
        raise error(where, demand, "forces that kick at the nodes", remedy)
    frame = frame_of(where, dataclasses.replace(discrete, system=forced.system))
    if forced.function is not None or not all(hasattr(each, "matrix_for") for each in forced.terms):
        got = f"{forced.names} on a body of rank {forced.rank}"
        remedy = "Under other forces only the principal value is known: use `simulate`."
        raise error(where, "have forces that are rational in the coordinates of a turn", got, remedy)
    g = group.identity if configuration is None else in_group(f"{owner}(configuration=...)", group, configuration)
    return Node(discrete, frame, g, step)
