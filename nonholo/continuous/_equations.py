r"""The Euler-Poincare-Suslov equations: rates of momentum, forces of constraint, the vector field.

With rows $S$ of the constraint subspace and $\omega = S^T w$ the momentum $p = \mathbb{I}\omega$ obeys
$p' = \mathrm{ad}^*_\omega p + \sum_j \lambda_j a^j$; since $S a^j = 0$, the restricted momentum $r = S p$ obeys
$r' = S\,\mathrm{ad}^*_\omega p$, without multipliers. Solutions live in `_closed_form` and `_series`.
"""

import dataclasses
from collections.abc import Callable
from typing import Any, ClassVar

import numpy as np

from nonholo.base.checks import error, number, trailing
from nonholo.base.numerics import applied
from nonholo.base.types import Array, Float
from nonholo.continuous._forced import forced_field, forced_reaction
from nonholo.continuous._series import Covectors, States
from nonholo.groups import AbstractMatrixGroup
from nonholo.orbit import AbstractMotion, First, Orbit, times_within
from nonholo.systems import AbstractCoordinateSystem, AbstractSystem, Start, as_system, inertia_form, refuse_slip

Body = tuple[Array, Array, Array]
r"""Constraint subspace $S$, inertia operator $\mathbb{I}$ and $(S\mathbb{I}S^T)^{-1}S$, which takes r to $\omega$."""


def body_of(system: AbstractSystem) -> Body:
    """Return the numbers that the equations need of a system."""
    S, inertia = system.constraint_subspace, system.inertia_operator
    xp = inertia.__array_namespace__()
    return S, inertia, xp.linalg.solve(S @ inertia @ S.T, xp.asarray(S))


def momentum_rate(
    group: AbstractMatrixGroup, body: Body, restricted_momentum: Float[Array, "... k"]
) -> tuple[Float[Array, "... k"], Float[Array, "... dim"], Float[Array, "... dim"]]:
    r"""Return $r' = S\,\mathrm{ad}^*_\omega p$, the body velocity $\omega$ and the torque $\mathrm{ad}^*_\omega p$."""
    S, inertia, to_velocity = body
    velocity = applied(to_velocity.T, restricted_momentum)
    torque = group.coad(velocity, applied(inertia, velocity))
    return applied(S, torque), velocity, torque


def reaction(group: AbstractMatrixGroup, body: Body, restricted_momentum: Float[np.ndarray, "K k"]) -> Covectors:
    r"""Return the force of constraint $p' - \mathrm{ad}^*_\omega p$.

    Here $p' = \mathbb{I} S^T (S\mathbb{I}S^T)^{-1} r'$: the full inertia operator is not inverted, so rods are allowed.
    """
    _, inertia, to_velocity = body
    rate, _, torque = momentum_rate(group, body, restricted_momentum)
    return applied(inertia, applied(to_velocity.T, rate)) - torque


@dataclasses.dataclass(frozen=True, eq=False)
class ContinuousFlow(AbstractMotion):
    """The continuous motion of a system, as the orbits of `flow` know it.

    Attributes:
        system: The system.
        span: The first and the last time at which the motion is known; None of one that was loaded.
        solution: Gives its states at times since the first.
    """

    system: AbstractSystem
    span: tuple[float, float] | None = dataclasses.field(default=None, repr=False, metadata={"stored": False})
    solution: Callable[[Array], States] | None = dataclasses.field(default=None, repr=False, metadata={"stored": False})
    time_step: ClassVar[None] = None
    starts: ClassVar[tuple[str, ...]] = ("body_velocity", "momentum", "restricted_velocity")

    def first(self, start: Start, *, with_poses: bool) -> First:
        """Return the checked start of a flow with poses or without."""
        system = self.system
        g = start.pose(system.group) if system.is_spatial or start.configuration is not None else None
        reduced = start.momentum(system, g)
        full = start.name == "momentum" and np.shape(start.value) != (system.rank,)
        pose = start.canonical_pose(system, g) if with_poses else np.empty(0)
        return First((reduced, pose), np.asarray(start.value, dtype=np.float64) if full else None)

    def at(self, states: Orbit, times: Any) -> Orbit:
        """Return the states at any times of the span."""
        if self.span is None or self.solution is None:
            remedy = "Solve it again: flow(orbit.system, ...)."
            raise error("Orbit.at(...)", "contain its series", "a flow from a file, which has only states", remedy)
        time, order = times_within(self.span, times)
        there = self.solution(time[order] - self.span[0]).chosen(np.argsort(order))
        rows: dict[str, Any] = {"reduced_momentum": there.momenta}
        if states.canonical_pose is not None:
            rows |= {"canonical_pose": there.poses, "turned": there.turned}
        return dataclasses.replace(states, time=time, **rows, save_every=1, events=None, step=np.arange(len(time)))

    def full_momentum(self, states: Orbit) -> Float[np.ndarray, "K dim"]:
        r"""Return the momenta $p = \mathbb{I}\omega$."""
        return applied(self.system.inertia_operator, states.body_velocity)

    def multipliers(self, states: Orbit) -> Float[np.ndarray, "K s"]:
        r"""Return the forces $\lambda$ in $p' = \mathrm{ad}^*_\omega p + \sum_j \lambda_j a^j$ at the states.

        For a right-invariant constraint the last term is $\sum_j \lambda_j \mathrm{Ad}^*_g a^j$.
        """
        system, forced = self.system, self.system.forces
        if forced is not None:
            force = forced_reaction(forced, states)
        elif system.is_spatial:
            force = spatial_reaction(system, states.configuration, states.body_velocity)
        else:
            force = reaction(system.group, body_of(system), states.restricted_momentum)
        return applied(np.linalg.pinv(system.inside.annihilator).T, force)

    def constraint_residual(self, states: Orbit) -> Float[np.ndarray, "K s"]:
        """Return the forbidden velocities."""
        system = self.system
        velocity = system.constraint_velocity(states.body_velocity, system.constraint_poses(states))
        return applied(system.annihilator, velocity)


def spatial_velocity(
    group: AbstractMatrixGroup, S: Array, tensor: Array, r: Array, g: Float[Array, "... N N"]
) -> Float[Array, "... dim"]:
    """Return the spatial velocity along rows S of a body at a pose with spatial momenta r along them."""
    xp = g.__array_namespace__()
    rows = xp.asarray(S, dtype=g.dtype)
    inertia = inertia_form(group, group.hat(rows), g @ tensor @ xp.swapaxes(g, -1, -2))
    w = xp.linalg.solve(inertia, xp.broadcast_to(r, inertia.shape[:-1])[..., None])[..., 0]
    return applied(rows.T, w)


def spatial_reaction(system: AbstractSystem, g: Float[np.ndarray, "K N N"], velocity: Covectors) -> Covectors:
    r"""Return the constraint force in space, $\mathrm{Ad}^*_{g^{-1}}(\mathbb{I}\dot\omega - \mathrm{ad}^*_\omega p)$.

    The spatial velocity $S^T w$ accelerates such that the momentum along $S$ stays:
    $B(g)\,\dot w = S\,\mathrm{Ad}^*_{g^{-1}}\mathrm{ad}^*_\omega p$, and $\dot\omega = \mathrm{Ad}_{g^{-1}}S^T\dot w$.
    """
    group, S, inertia = system.group, system.constraint_subspace, system.inertia_operator
    back = group.inverse(g)
    torque = group.coadjoint(back, group.coad(velocity, applied(inertia, velocity)))
    rate = applied(S.T, system.restricted_velocity(applied(S, torque), g))
    acceleration = applied(group.adjoint(back), rate)
    return group.coadjoint(back, applied(inertia, acceleration)) - torque


def vector_field(
    system: AbstractSystem | AbstractCoordinateSystem,
) -> Callable[[Array, Float[Array, "size"]], Float[Array, "size"]]:
    r"""Return the equations of motion as a function (time, state) -> derivative, for your own solver.

    $$ r' = (\mathrm{ad}^*_\omega p)|_{\mathfrak{d}}, \qquad g' = g\,\hat\omega, \qquad
       p = \mathbb{I}\omega, \quad \omega \in \mathfrak{d}, \quad p|_{\mathfrak{d}} = r. $$

    The state is flat: the k components of the momentum along the rows of `constraint_subspace`, then the N x N entries
    of the configuration, row by row, all in the user's body frame. For a right-invariant constraint the momenta are
    spatial, and constant. It may be a NumPy array or, inside `jax.jit` or
    diffrax, a traced one; leading axes broadcast. Of a `Forced` the forces are added; functions in Python or numba are
    not traced.

    Of a system in coordinates the state is the configuration (on a group row by row), then the velocity,

    $$ \dot q = v, \qquad M\dot v = F(t, q, v) + A^T\lambda, \qquad \tfrac{d}{dt}(A v - b) = 0; $$

    start with $A v = b$, which then stays, as prescribed motions do. There is no projection.

    Reference: [fedorov-zenkov-2004], section 2, the Euler-Poincare-Suslov equations.

    Args:
        system: The system.

    Raises:
        ValueError: `system` is not a system, or has one force for each step.

    Example:
        >>> from scipy.integrate import solve_ivp
        >>> sleigh = nh.ChaplyginSleigh(mass=1.0, inertia=0.75, a=0.5)
        >>> start = np.concatenate([[1.0, 0.0], np.eye(3).ravel()])
        >>> end = solve_ivp(nh.vector_field(sleigh), (0.0, 2.0), start, rtol=1e-10, atol=1e-12).y[:, -1]
        >>> orbit = nh.flow(sleigh, momentum=(1.0, 0.0), times=(0.0, 2.0), method="closed_form")
        >>> bool(np.allclose(end[2:].reshape(3, 3), orbit.configuration[-1], atol=1e-8))
        True

        A knife edge on a slope, in coordinates:

        >>> edge = nh.examples.knife_edge_on_incline()
        >>> field = nh.vector_field(edge.system)
        >>> field(0.0, np.concatenate([edge.configuration, edge.body_velocity])).shape
        (6,)
    """
    if isinstance(system, AbstractCoordinateSystem):
        return system.vector_field()
    as_system("vector_field(system=...)", system)
    refuse_slip("vector_field(system=...)", system)
    field = _free_field(system) if system.forces is None else forced_field(system.forces)
    where, size = "vector_field(...)(state=...)", system.rank + system.group.size**2

    def derivative(time: Array, state: Float[Array, "size"]) -> Float[Array, "size"]:
        now = number("vector_field(...)(time=...)", time)
        remedy = "Pass momenta along the subspace, then the pose row by row."
        return field(now, trailing(where, state, (size,), remedy, real=True))

    return derivative


def _free_field(system: AbstractSystem) -> Callable[[Array, Array], Array]:
    """Return the equations of a free motion as a function of time and states."""
    group, S = system.group, system.constraint_subspace
    k, shape = len(S), group.identity.shape
    body = None if system.is_spatial else body_of(system)

    def derivative(_: Array, state: Array) -> Array:
        xp = state.__array_namespace__()
        r, g = state[..., :k], xp.reshape(state[..., k:], (*state.shape[:-1], *shape))
        if body is None:
            velocity = spatial_velocity(group, S, system.homogeneous_mass_tensor, r, g)
            rate, pose_rate = xp.zeros_like(r), group.hat(velocity) @ g
        else:
            rate, velocity, _ = momentum_rate(group, body, r)
            pose_rate = g @ group.hat(velocity)
        return xp.concatenate([rate, xp.reshape(pose_rate, (*state.shape[:-1], -1))], axis=-1)

    return derivative
