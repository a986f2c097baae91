"""The ball of Chaplygin: its center of mass is in its middle, and it rolls on a plane without sliding."""

import functools

import jax.numpy as jnp
import numpy as np

from nonholo.base.types import Array
from nonholo.examples._example import Example, numbers, positives, ready
from nonholo.groups import SE, SO
from nonholo.lagrange_dalembert import GroupLagrangeDAlembert, mass_tensor_lagrangian
from nonholo.systems import mass_tensor_from_inertia


@ready("angular_velocity")
def chaplygin_ball(
    *,
    mass: float = 1.0,
    radius: float = 1.0,
    inertia: tuple[float, float, float] = (0.3, 0.4, 0.5),
    angular_velocity: tuple[float, float, float] = (0.4, 0.3, 1.0),
) -> Example:
    r"""A ball on SE(3) with principal moments of inertia I about its middle, which rolls without sliding.

    $$ L = \tfrac12\omega\cdot I\omega + \tfrac m2|v|^2, \qquad v = r\,\omega\times\gamma, \qquad \gamma = R^Te_3, $$

    v the velocity of the middle seen from the ball. The constraint depends on the pose, so that the discrete principle
    is that of `GroupLagrangeDAlembert`. With the angular momentum about the contact,

    $$ M = I\omega + mr^2\,\gamma\times(\omega\times\gamma), \qquad \dot M = M\times\omega, \quad
       \dot\gamma = \gamma\times\omega: $$

    $R M$ is constant in space, and the energy $\tfrac12\omega\cdot M$.

    Reference: [chaplygin-1903].

    Args:
        mass: m.
        radius: r.
        inertia: Principal moments I.
        angular_velocity: omega at the start, seen from the ball.

    Raises:
        ValueError: A mass, radius or moment that is not positive, moments of no body, a wrong shape.

    Example:
        >>> ready = nh.examples.chaplygin_ball()
        >>> ready.conserved["momentum along z"](ready.configuration, ready.body_velocity).round(3)
        np.float64(0.5)
    """
    name = "chaplygin_ball"
    m, r = positives(name, mass=mass, radius=radius)
    given = numbers(name, "inertia", inertia, 3, "three moments")
    moments = tuple(positives(name, **{f"inertia[{i}]": moment for i, moment in enumerate(given)}))
    omega = numbers(name, "angular_velocity", angular_velocity, 3, "three components")
    v = np.append(omega, r * np.cross(omega, (0.0, 0.0, 1.0)))

    def momentum(g: Array, v: Array) -> Array:
        R = g[..., :3, :3]
        gamma, omega = R[..., 2, :], v[..., :3]
        own = omega * moments + m * r**2 * np.cross(gamma, np.cross(omega, gamma))
        return (R @ own[..., None])[..., 0]

    conserved = {f"momentum along {axis}": functools.partial(_component, momentum, i) for i, axis in enumerate("xyz")}
    facts = (
        "The angular momentum about the contact is constant in space, and so is the energy.",
        "The middle moves at constant height.",
    )
    return Example(name, _system(m, r, moments), np.eye(4), v, facts, conserved)


def _component(function: Array, index: int, g: Array, v: Array) -> Array:
    return function(g, v)[..., index]


@functools.cache
def _system(m: float, r: float, moments: tuple[float, ...]) -> GroupLagrangeDAlembert:
    tensor = np.zeros((4, 4))
    tensor[:3, :3], tensor[3, 3] = mass_tensor_from_inertia(np.diag(moments)), m

    def forms(g: Array) -> Array:
        return jnp.concatenate([r * SO(3).hat(g[2, :3]), jnp.eye(3)], axis=1)

    return GroupLagrangeDAlembert(SE(3), mass_tensor_lagrangian(SE(3), tensor), forms)
