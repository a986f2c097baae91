"""What stands in one step of a transcription: its unknowns, its equations, places; of groups and of coordinates.

Both kinds offer the same functions. A state x is a pose with the momenta of its node, an inner part z what a step has
besides, a chart of the displacement or a velocity with multipliers; f are the forces of the step.
"""

from typing import NamedTuple

import jax.numpy as jnp

from nonholo.analysis.steering._way import body_points, planar_points
from nonholo.base.types import Array, Float
from nonholo.discrete import Discretization
from nonholo.discrete.definition import free_rows, step_residual
from nonholo.lagrange_dalembert import LagrangeDAlembert, equations
from nonholo.systems import Forced


class GroupNodes(NamedTuple):
    """Steps on a group.

    Attributes:
        free: The discretization without forces.
        forced: The system with its forces, None where free.
        outline: Body points that keep clear of obstacles, (points, n).
        pose: The last pose, None where free.
    """

    free: Discretization
    forced: Forced | None
    outline: Float[Array, "points n"]
    pose: Array | None

    @property
    def sizes(self) -> tuple[int, int, int]:
        """How many numbers a state, an inner part and the forces of a step have."""
        group, k = self.free.system.group, self.free.system.rank
        return free_rows(group) * group.size + k, len(self.free.variety.chart), k

    def residual(self, x: Array, z: Array, f: Array, after: Array, row: Array) -> Array:
        """Return the equations of a step, under the row of a table of forces too."""
        covector = jnp.linalg.pinv(jnp.asarray(self.free.system.constraint_subspace)) @ f + row
        return step_residual(self.free, self.forced, self.state(x), z, self.state(after), covector)

    def missed(self, x: Array) -> Array:
        """Return what vanishes at the goal and is no number of the state."""
        if self.pose is None:
            return jnp.zeros(0)
        group = self.free.system.group
        return group.log(group.inverse(self.pose) @ self.state(x)[0])

    def places(self, x: Array) -> Array:
        """Return where the points of the outline are, (points, n)."""
        return body_points(self.state(x)[0], self.outline)

    def numbers(self, z: Array, x: Array) -> Array:
        """Return what bounds of states are about: entries of the pose, momenta."""
        del z
        g, momenta = self.state(x)
        return jnp.append(g, momenta)

    def state(self, x: Array) -> tuple[Array, Array]:
        """Return pose and momenta."""
        group = self.free.system.group
        rows = free_rows(group)
        g = jnp.concatenate([x[: rows * group.size].reshape(rows, -1), jnp.asarray(group.identity[rows:])])
        return g, x[rows * group.size :]


class CoordinateNodes(NamedTuple):
    """Steps in coordinates.

    Attributes:
        system: What moves.
        time_step: h.
        outline: Points in axes of the body that keep clear of obstacles, (points, 2).
        directions: Rows span the admissible velocities near the goal; none where its velocity is free.
        velocity: The last velocity.
    """

    system: LagrangeDAlembert
    time_step: Array
    outline: Float[Array, "points n"]
    directions: Array
    velocity: Array

    @property
    def sizes(self) -> tuple[int, int, int]:
        """How many numbers a state, an inner part and the forces of a step have."""
        n = self.system.dimension
        return 2 * n + self.system.is_driven, n + self.system.constraints, n

    def residual(self, x: Array, z: Array, f: Array, after: Array, row: Array) -> Array:
        """Return the equations of a step; there is no table of forces."""
        del row
        return equations.step_residual(self.system, self.state(x), z, self.state(after), f, self.time_step)

    def missed(self, x: Array) -> Array:
        """Return by how much the last momentum is missed along the constraint."""
        if not len(self.directions):
            return jnp.zeros(0)
        place, p = self.state(x)
        rows, off = equations.forms(self.system, place), p - equations.momentum(self.system, place, self.velocity)
        return self.directions @ (off - rows.T @ jnp.linalg.solve(rows @ rows.T, rows @ off))

    def places(self, x: Array) -> Array:
        """Return where the points of the outline are, (points, 2)."""
        return planar_points(self.system, x, self.outline)

    def numbers(self, z: Array, x: Array) -> Array:
        """Return what bounds of states are about: velocities of the step, coordinates."""
        return jnp.append(z[: self.system.dimension], x[: self.system.dimension])

    def state(self, x: Array) -> tuple[Array, Array]:
        """Return place and momentum."""
        return x[: -self.system.dimension], x[-self.system.dimension :]
