"""What measurements miss of a motion, with exact derivatives, compiled once: in JAX."""

import dataclasses
import functools
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from nonholo.analysis.inverse._first import first
from nonholo.analysis.inverse._measurements import Names, names_of
from nonholo.analysis.inverse._problem import Shapes, named
from nonholo.base.types import Array
from nonholo.discrete import discretize
from nonholo.discrete.definition import in_double
from nonholo.groups import SE
from nonholo.orbit import Orbit
from nonholo.simulation import simulate
from nonholo.simulation.traced import rollout

_COPIES = 8  # of matrices at a node, and their derivatives


@dataclasses.dataclass(frozen=True)
class GroupModel:
    """Motions of a body on a group: what can be measured of them, and where they begin.

    Attributes:
        system: The body of the guess.
    """

    system: Any

    @property
    def names(self) -> Names:
        """The names of columns by kind."""
        return names_of(self.system.group)

    def each(self, count: int) -> float:
        """Return the bytes of a node under a number of parameters."""
        group = self.system.group
        return _COPIES * 8.0 * (1 + count + self.system.rank + group.dim) * group.size**2

    def first(self, h: float, kinds: dict[str, np.ndarray], *, is_robust: bool) -> tuple[np.ndarray, np.ndarray]:
        """Return a first pose and a first start."""
        return first(self.system, h, kinds, is_robust=is_robust)

    def missed(
        self, system_of: Callable[..., Any], shapes: Shapes, time_step: float, numbers: Array, starts: Array, *data: Any
    ) -> dict[str, tuple[np.ndarray, np.ndarray, np.ndarray]]:
        """Return by kind residuals (T, K, c), measured minus computed, with derivatives by numbers and by starts."""
        return in_double(_compiled(system_of, shapes), time_step, numbers, starts, *data)

    def orbit(self, system: Any, h: float, start: np.ndarray, pose: np.ndarray, steps: int) -> Orbit:
        """Return the motion of a trial."""
        k = system.rank
        g = (
            pose @ system.group.exp(np.pad(start[k:], (0, k + system.group.dim - len(start))))
            if len(start) > k
            else pose
        )
        return simulate(discretize(system, h), restricted_velocity=start[:k], configuration=g, steps=steps)


@functools.lru_cache(maxsize=8)
def _compiled(system_of: Callable[..., Any], shapes: Shapes) -> Callable[..., Any]:
    def one(time_step: Array, numbers: Array, start: Array, g: Array, kinds: dict[str, Array]) -> tuple[Any, Any]:
        system = system_of(named(shapes, numbers))
        group, k = system.group, system.rank
        pose = g @ group.exp(jnp.pad(start[k:], (0, k + group.dim - len(start)))) if len(start) > k else g
        steps = len(kinds["turn"]) - 1
        orbit = rollout(discretize(system, time_step), restricted_velocity=start[:k], configuration=pose, steps=steps)
        inertia = jnp.asarray(system.constrained_inertia)
        velocity = jnp.linalg.solve(inertia, orbit.restricted_momentum.T).T @ system.constraint_subspace
        rows = {kind: _gap(group, kind, measured, orbit, velocity) for kind, measured in kinds.items()}
        return rows, rows

    each = jax.vmap(jax.jacfwd(one, argnums=(1, 2), has_aux=True), in_axes=(None, None, 0, 0, 0))

    def by_kind(*arguments: Any) -> dict[str, tuple[Array, Array, Array]]:
        slopes, rows = each(*arguments)
        return {kind: (rows[kind], *slopes[kind]) for kind in rows}  # JAX sorts a dictionary: only names are kept

    return jax.jit(by_kind)


def _gap(group: Any, kind: str, measured: Array, orbit: Any, velocity: Array) -> Array:
    """Return measured minus computed numbers, zero where nothing was measured; of turns the vector of the rotation."""
    there = jnp.isfinite(measured)
    measured, g = jnp.where(there, measured, 1.0), orbit.configuration
    if kind == "position":
        gap = measured - g[:, :-1, -1]
    elif kind == "rate":
        gap = measured - velocity[:, : measured.shape[1]]
    elif group == SE(2):
        cos, sin = g[:, 0, 0], g[:, 1, 0]
        c, s = jnp.cos(measured[:, 0]), jnp.sin(measured[:, 0])
        gap = jnp.arctan2(s * cos - c * sin, c * cos + s * sin)[:, None]
    else:
        turn = jnp.swapaxes(g[:, :3, :3], 1, 2) @ _rotations(measured)
        odd = (turn - jnp.swapaxes(turn, 1, 2)) / 2
        gap, there = jnp.stack([odd[:, 2, 1], odd[:, 0, 2], odd[:, 1, 0]], axis=1), there[:, :3]
    return jnp.where(there, gap, 0.0)


def _rotations(q: Array) -> Array:
    w, x, y, z = (q / jnp.linalg.norm(q, axis=1, keepdims=True)).T
    rows = (
        (1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
        (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
        (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
    )
    return jnp.moveaxis(jnp.array(rows), -1, 0)
