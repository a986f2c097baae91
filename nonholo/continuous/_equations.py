r"""The Euler-Poincare-Suslov equations: rates of momentum, forces of constraint, the vector field.

With rows $S$ of the constraint subspace and $\omega = S^T w$ the momentum $p = \mathbb{I}\omega$ obeys
$p' = \mathrm{ad}^*_\omega p + \sum_j \lambda_j a^j$; since $S a^j = 0$, the restricted momentum $r = S p$ obeys
$r' = S\,\mathrm{ad}^*_\omega p$, without multipliers. Solutions live in `_closed_form` and `_integration`.
"""

import dataclasses
from collections.abc import Callable

import numpy as np

from nonholo._checks import error
from nonholo._types import Array, Float
from nonholo.groups import AbstractMatrixGroup
from nonholo.orbit import AbstractMotion
from nonholo.systems import AbstractLLSystem

Body = tuple[Array, Array, Array]
r"""Constraint subspace $S$, inertia operator $\mathbb{I}$ and $(S\mathbb{I}S^T)^{-1}S$, which takes r to $\omega$."""


def body_of(system: AbstractLLSystem) -> Body:
    """Return the numbers that the equations need of a system."""
    S, inertia = system.constraint_subspace, system.inertia_operator
    xp = inertia.__array_namespace__()
    return S, inertia, xp.linalg.solve(S @ inertia @ S.T, xp.asarray(S))


def momentum_rate(
    group: AbstractMatrixGroup, body: Body, restricted_momentum: Float[Array, "... k"]
) -> tuple[Float[Array, "... k"], Float[Array, "... dim"], Float[Array, "... dim"]]:
    r"""Return $r' = S\,\mathrm{ad}^*_\omega p$, the body velocity $\omega$ and the torque $\mathrm{ad}^*_\omega p$."""
    S, inertia, to_velocity = body
    velocity = restricted_momentum @ to_velocity
    torque = group.coad(velocity, velocity @ inertia.T)
    return torque @ S.T, velocity, torque


def reaction(
    group: AbstractMatrixGroup, body: Body, restricted_momentum: Float[np.ndarray, "K k"]
) -> Float[np.ndarray, "K dim"]:
    r"""Return the force of constraint $p' - \mathrm{ad}^*_\omega p$.

    Here $p' = \mathbb{I} S^T (S\mathbb{I}S^T)^{-1} r'$: the full inertia operator is not inverted, so rods are allowed.
    """
    _, inertia, to_velocity = body
    rate, _, torque = momentum_rate(group, body, restricted_momentum)
    return rate @ to_velocity @ inertia.T - torque


@dataclasses.dataclass(frozen=True, eq=False)
class ContinuousFlow(AbstractMotion):
    """The continuous motion of a system, as the orbits of `flow` know it."""

    system: AbstractLLSystem

    def full_momentum(
        self, reduced_momentum: Float[np.ndarray, "K k"], cayley: Float[np.ndarray, "K k"] | None
    ) -> Float[np.ndarray, "K dim"]:
        r"""Return the momenta $p = \mathbb{I}\omega$ in the user's frame."""
        del cayley
        _, inertia, to_velocity = body_of(self.system.canonical)
        return self._in_users_frame(reduced_momentum @ to_velocity @ inertia.T)

    def multipliers(
        self, reduced_momentum: Float[np.ndarray, "K k"], cayley: Float[np.ndarray, "K k"] | None, save_every: int
    ) -> Float[np.ndarray, "K s"]:
        r"""Return the forces $\lambda$ in $p' = \mathrm{ad}^*_\omega p + \sum_j \lambda_j a^j$ at the states."""
        del cayley, save_every
        force = reaction(self.system.group, body_of(self.system.canonical), reduced_momentum)
        return self._in_users_frame(force) @ np.linalg.pinv(self.system.annihilator)

    def _in_users_frame(self, covector: np.ndarray) -> np.ndarray:
        group = self.system.group
        return group.coadjoint(group.inverse(self.system.frame), covector)


def vector_field(system: AbstractLLSystem) -> Callable[[Array, Float[Array, "size"]], Float[Array, "size"]]:
    r"""Return the equations of motion as a function (time, state) -> derivative, for a solver of your own.

    $$ r' = (\mathrm{ad}^*_\omega p)|_{\mathfrak{d}}, \qquad g' = g\,\hat\omega, \qquad
       p = \mathbb{I}\omega, \quad \omega \in \mathfrak{d}, \quad p|_{\mathfrak{d}} = r. $$

    The state is flat: the k components of the momentum along the rows of `constraint_subspace`, then the N x N entries
    of the configuration, row by row, all in the user's body frame. It may be a NumPy array or, inside `jax.jit` or
    diffrax, a traced one; leading axes broadcast.

    Reference: [fedorov-zenkov-2004], section 2, the Euler-Poincare-Suslov equations.

    Args:
        system: What moves.

    Raises:
        ValueError: `system` is not a system.

    Example:
        >>> from scipy.integrate import solve_ivp
        >>> sleigh = nh.ChaplyginSleigh(mass=1.0, inertia=0.75, a=0.5)
        >>> start = np.concatenate([[1.0, 0.0], np.eye(3).ravel()])
        >>> end = solve_ivp(nh.vector_field(sleigh), (0.0, 2.0), start, rtol=1e-10, atol=1e-12).y[:, -1]
        >>> orbit = nh.flow(sleigh, momentum=(1.0, 0.0), times=(0.0, 2.0), method="closed_form")
        >>> bool(np.allclose(end[2:].reshape(3, 3), orbit.configuration[-1], atol=1e-8))
        True
    """
    if not isinstance(system, AbstractLLSystem):
        raise error("vector_field(system=...)", "be a system", repr(system), "Pass a SuslovTop or a ChaplyginSleigh.")
    body = body_of(system)
    k, shape = len(system.constraint_subspace), system.group.identity.shape

    def derivative(time: Array, state: Float[Array, "size"]) -> Float[Array, "size"]:
        del time
        xp = state.__array_namespace__()
        rate, velocity, _ = momentum_rate(system.group, body, state[..., :k])
        g = xp.reshape(state[..., k:], (*state.shape[:-1], *shape))
        moved = xp.reshape(g @ system.group.hat(velocity), (*state.shape[:-1], -1))
        return xp.concatenate([rate, moved], axis=-1)

    return derivative
