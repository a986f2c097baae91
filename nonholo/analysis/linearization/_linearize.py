"""`linearize`: the linear equations beside a steady motion, of a flow or of a discrete map."""

import dataclasses
import functools
from collections.abc import Callable
from typing import Any

import numpy as np

from nonholo.analysis.linearization._reduction import Local, reduced
from nonholo.base.checks import error, needs, shown
from nonholo.base.memo import Keeper
from nonholo.base.types import Float, Inexact
from nonholo.discrete import Discretization
from nonholo.systems import AbstractCoordinateSystem, AbstractSystem, in_coordinates

Shifted = Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]
"""Takes changes of coordinates and of velocities to a configuration and a body velocity."""


@dataclasses.dataclass(frozen=True, eq=False)
class Linearization(Keeper):
    r"""The linear equations beside a steady motion, $\delta\dot z = A\,\delta z$, of a map $\delta z' = A\,\delta z$.

    Attributes:
        matrix: A, shape (d, d).
        names: The names of the states z. In coordinates those of coordinates, and of independent velocities with a
            prime; on groups "xi1", ... of the pose $g\,e^\xi$, then "r1", ... of momenta along the rows of the
            constraint subspace, or "v1", ... of body velocities.
        ignorable: Coordinates on which no velocity depends. They are left out, and may move; each of them has a further
            eigenvalue 0, of a map 1.
        time_step: h of a map; None of a flow.
    """

    matrix: Float[np.ndarray, "d d"]
    names: tuple[str, ...]
    ignorable: tuple[str, ...]
    time_step: float | None

    @property
    def eigenvalues(self) -> Inexact[np.ndarray, "d"]:
        """Rates, the one that grows fastest first; of a map multipliers of a step, the largest first."""
        return self._spectrum[0]

    @property
    def modes(self) -> Inexact[np.ndarray, "d d"]:
        """Columns in the order of the eigenvalues, of length one; rows belong to the names."""
        return self._spectrum[1]

    @functools.cached_property
    def _spectrum(self) -> tuple[np.ndarray, np.ndarray]:
        values, modes = np.linalg.eig(self.matrix)
        size = np.real(values) if self.time_step is None else np.abs(values)
        order = np.lexsort((-np.imag(values), -size))
        return values[order], modes[:, order]

    def to_pandas(self) -> Any:
        """Return a `pandas.DataFrame` with a row for each eigenvalue and a column for each state of its mode."""
        import pandas

        table = pandas.DataFrame(self.modes.T, columns=list(self.names))
        table.insert(0, "eigenvalue", self.eigenvalues)
        return table


def linearize(system: Any, *, configuration: Any = None, body_velocity: Any = None) -> Linearization:
    r"""Linearize a system, or its discrete map, beside a steady motion or at rest.

    $$ \delta\dot z = \frac{\partial f}{\partial z}\,\delta z, \qquad
       \delta z' = \frac{\partial z_{k+1}}{\partial z_k}\,\delta z, $$

    where z are the states on which anything depends. In coordinates they are the coordinates and n - s independent
    velocities; the constraints $A v = b$ give the others. Coordinates that no equation contains, such as the place and
    the heading of a vehicle on a plane, are left out: they may move, all others and the independent velocities have to
    be constant. On a group z has the momenta along the constraint, $r = S\,\mathbb{I}\omega$, and where forces depend
    on the pose $\xi$ of $g\,e^\xi$, seen from a body that moves on steadily. So a top in steady precession is, too.

    Derivatives are exact, by JAX; those of forces and potentials that are functions, on groups, are central
    differences of order 6. What depends on what is seen at the state and three more, up to 1e-11 of the largest
    derivative. The step of a map begins as `simulate` begins, with `body_velocity`.

    Args:
        system: Any system, on a group or in coordinates, or what `discretize` made of it.
        configuration: Where it is; on a group the identity by default.
        body_velocity: Its velocity, which must satisfy the constraint; at rest by default.

    Raises:
        ValueError: Something else, a table of forces, a system without matrices, a bad state, or one that is not
            steady: the error has its rates.

    Example:
        A sleigh that moves ahead, with the center of mass in front of the blade, loses all turning:

        >>> sleigh = nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.5)
        >>> nh.linearize(sleigh, body_velocity=(0.0, 2.0, 0.0)).eigenvalues
        array([ 0. , -0.8])

        A pendulum, upside down:

        >>> import jax.numpy as jnp
        >>> pendulum = nh.LagrangeDAlembert(lambda q, v: v @ v / 2 + jnp.cos(q[0]), None, dimension=1)
        >>> found = nh.linearize(pendulum, configuration=[np.pi])
        >>> found.names, found.eigenvalues.round(12)
        (('q1', "q1'"), array([ 1., -1.]))
    """
    local, _ = local_motion("linearize", system, configuration, body_velocity)
    where = "linearize(body_velocity=...)"
    if not np.isfinite(local.slope[0]).all():
        remedy = "Take a smaller time step, or another state."
        raise error(where, "have a finite linearization", f"none at {local.state.tolist()}", remedy)
    found = reduced(local)
    names = tuple(local.names[i] for i in found.states)
    if not found.is_steady:
        rates = ", ".join(f"{name}: {rate:.6g}" for name, rate in zip(names, found.missed, strict=True))
        remedy = "Pass a state of rest or of a steady motion; coordinates that matter have to stay."
        raise error(where, "be that of a steady motion", f"rates {rates}", remedy)
    ignorable = tuple(local.names[i] for i in found.ignorable)
    matrix = found.matrix if _time_step(system) is None else np.eye(len(names)) + found.matrix
    return Linearization(matrix, names, ignorable, _time_step(system))


def step_tangents(orbit: Any) -> Float[np.ndarray, "L d d"]:
    """Return the derivative of each state of a discrete orbit on a group by the one before."""
    with needs("jax", "Orbit.tangent"):
        from nonholo.analysis.linearization import _on_groups
    return _on_groups.along(orbit)


def local_motion(owner: str, system: Any, configuration: Any, velocity: Any) -> tuple[Local, Shifted]:
    """Return the changes beside a state, and the function that gives the states beside it."""
    with needs("jax", owner):
        from nonholo.analysis.linearization import _in_coordinates, _on_groups
    if isinstance(system, AbstractCoordinateSystem) or in_coordinates(system):
        return _in_coordinates.beside_state(owner, system, configuration, velocity)
    if not isinstance(system, AbstractSystem | Discretization):
        remedy = "Pass a system, on a group or in coordinates, or what `discretize` returned."
        raise error(f"{owner}(system=...)", "be a system or its map", shown(system), remedy)
    return _on_groups.on_group(owner, system, configuration, velocity)


def _time_step(system: Any) -> float | None:
    return getattr(system, "time_step", None)
