"""Motions as a feedback sees them, on a group and in coordinates: nodes, errors, and how steps move these."""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from nonholo.analysis.steering._arguments import VELOCITIES
from nonholo.analysis.steering._shooting import linearize_steps
from nonholo.base.checks import error, within_memory
from nonholo.base.types import Array
from nonholo.discrete import Discretization, as_discretization
from nonholo.discrete.definition import compile_double
from nonholo.lagrange_dalembert import places, tangents
from nonholo.simulation import refuse_many_matrices
from nonholo.simulation.traced import roll
from nonholo.systems import AbstractCoordinateDiscretization, refuse_fixed_in_space

Nodes = tuple[np.ndarray, np.ndarray]
"""Configurations, and body velocities of the momenta there."""


class GroupTrack(NamedTuple):
    """Motions of a body on a group: where it moves, and the directions of forces and of errors of velocities."""

    discrete: Discretization
    places: Any
    rows: np.ndarray
    velocities = VELOCITIES

    def check(self, where: str, steps: int) -> None:
        """Refuse constraints that are fixed in space, a table of forces, and what does not fit in memory."""
        discrete, system = self.discrete, self.discrete.system
        refuse_fixed_in_space(f"{where}(discrete=...)", system, "Steer it by `nh.rollout`.")
        if discrete.forces is not None and discrete.forces.table is not None:
            got, remedy = "one force for each step", "Add the table to the controls."
            raise error(f"{where}(discrete=...)", "have forces that do not depend on time", got, remedy)
        derivatives = system.group.dim + 2 * system.rank
        refuse_many_matrices(f"{where}(controls=...)", discrete, steps, "Pass fewer.", derivatives=derivatives)

    def nodes(self, orbit: Any) -> Nodes:
        """Return poses and velocities of a rollout."""
        return orbit.configuration, self.discrete.system.restricted_velocity(orbit.restricted_momentum) @ self.rows

    def linearize(self, nodes: Nodes, controls: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the derivatives of errors after each step by those before it, and by forces."""
        return linearize_steps(self.discrete, (nodes[1] @ np.linalg.pinv(self.rows), nodes[0]), controls)


class CoordinateTrack(NamedTuple):
    """Motions in coordinates, with a force on each, or on a group by functions, with a covector."""

    discrete: AbstractCoordinateDiscretization[Any]
    places: Any
    rows: np.ndarray
    velocities = VELOCITIES[1:]

    def check(self, where: str, steps: int) -> None:
        """Refuse what does not fit in memory."""
        within_memory(f"{where}(controls=...)", 200.0 * steps * self.rows.size, "Pass fewer.")  # four copies of A and B

    def nodes(self, orbit: Any) -> Nodes:
        """Return configurations and velocities of a rollout."""
        q = orbit.configuration
        return q, tangents.node_velocities(self.discrete.system, orbit.time, q, orbit.momentum)

    def linearize(self, nodes: Nodes, controls: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the derivatives of errors after each step by those before it, and by forces."""
        return tangents.forced_slopes(self.discrete, *nodes, controls)


def track_of(where: str, discrete: Any) -> GroupTrack | CoordinateTrack:
    """Return the kind of motion of a discretization."""
    if not isinstance(discrete, AbstractCoordinateDiscretization):
        system = as_discretization(f"{where}(discrete=...)", discrete, forced=True).system
        return GroupTrack(discrete, places.Poses(system.group), np.asarray(system.constraint_subspace))
    return CoordinateTrack(discrete, discrete.system.places, np.eye(discrete.system.dimension))


def _answer(
    places: Any, ways: Array, h: Array, nodes: Nodes, tables: tuple[Array, ...], limits: Any, time: Array, state: Any
) -> Array:
    """Return the control of a state as a policy of `rollout`."""
    step = jnp.rint(time / h).astype(int)
    reference, (force, gain, misread, push) = jax.tree.map(lambda rows: jnp.asarray(rows)[step], (nodes, tables))
    gap = _error(places, ways, reference, (state.configuration, state.body_velocity)) + misread
    return ways @ jnp.clip(force - gain @ gap, *limits) + push


def _error(places: Any, ways: Array, reference: tuple[Array, Array], state: tuple[Array, Array]) -> Array:
    """Return where states are, seen from a reference, and by how much their velocities differ."""
    return jnp.append(places.departure(reference[0], state[0]), (state[1] - reference[1]) @ ways)


@compile_double
def _errors(places: Any, ways: Array, nodes: Nodes, states: Nodes) -> Array:
    return jax.vmap(lambda *pair: _error(places, ways, *pair))(nodes, states)


def closed_loop(
    owner: str, track: Any, nodes: Nodes, start: dict[str, Any], tables: tuple[np.ndarray, ...], limits: Any
) -> tuple[Any, np.ndarray, np.ndarray]:
    """Return the motion from a start, the controls, and the errors; tables are forces, gains, misreadings, pushes."""
    force, gain, misread, _ = tables
    ways, h = np.linalg.pinv(track.rows), np.float64(track.discrete.time_step)
    policy = jax.tree_util.Partial(_answer, track.places, ways, h, nodes, tables, limits)
    orbit = roll(owner, track.discrete, **start, policy=policy, steps=len(force))
    errors = _errors(track.places, ways, nodes, track.nodes(orbit))
    change = (gain @ (errors[:-1] + misread)[..., None])[..., 0]
    return orbit, np.clip(force - change, *limits) @ ways.T, errors
