"""Bodies that turn on a point or on the floor: the rattleback, or celt, a boat that turns one way only; a heavy top."""

import functools
from typing import NamedTuple

import jax.numpy as jnp
import numpy as np

from nonholo.base.numerics import double_precision
from nonholo.base.types import Array, Float
from nonholo.examples._example import Example, Numbers, family, ready, system_in
from nonholo.examples._formulas import energy_of
from nonholo.lagrange_dalembert import LagrangeDAlembert
from nonholo.systems import Forced, SuslovTop


@ready(
    "tilt spin rates",
    reals="center product",
    positive="semi_axes inertia",
    semi_axes="three numbers",
    inertia="three numbers",
    tilt="lean and pitch",
    rates="rates of lean and pitch",
)
def rattleback(
    *,
    semi_axes: tuple[float, float, float] = (20.0, 3.0, 2.0),
    center: float = 1.0,
    inertia: tuple[float, float, float] = (2.0, 16.0, 17.0),
    product: float = 0.2,
    gravity: float = 980.665,
    tilt: tuple[float, float] = (0.01, 0.0),
    spin: float = 5.0,
    rates: tuple[float, float] = (0.0, 0.0),
) -> Example:
    r"""An ellipsoid of unequal axes that rolls without sliding: center of mass (x, y), heading theta, lean, pitch.

    The axes of the ellipsoid, ahead, left and up, are not those of inertia: hence the product $I_{12}$. With the
    vertical $\gamma = (-\sin\chi\cos\phi, \sin\phi, \cos\chi\cos\phi)$ of lean and pitch, seen from the body,
    $D = \mathrm{diag}(a, b, c)^2$ and the center of mass below the middle by $\ell$,

    $$ L = \tfrac12|v|^2 + \tfrac12\omega\cdot I\omega - gz, \qquad z = \sqrt{\gamma\cdot D\gamma} - \ell\gamma_3,
       \qquad v = \omega\times\frac{\partial z}{\partial\gamma}, $$

    of which the horizontal part is the constraint, the vertical one the derivative of z. Turned in the wrong direction,
    by `spin` with the defaults, it begins to rattle, stops and turns back. Energy is constant.

    Reference: [kane-levinson-1982], whose parameters are the defaults, in centimeters, seconds and per unit of mass,
    seen with its axis c upwards.

    Facts:
        Turned in the wrong direction it rattles, stops, and turns back.
        The energy is constant.

    Args:
        semi_axes: a, b, c.
        center: l, between 0 and c.
        inertia: Moments of inertia by mass about the axes of the ellipsoid, through the center of mass.
        product: $I_{12}$ by mass.
        gravity: g.
        tilt: Lean and pitch at the start.
        spin: theta' at the start.
        rates: Of lean and pitch at the start.

    Raises:
        ValueError: An axis, a moment or a gravity that is not positive, a wrong shape.

    Example:
        >>> ready = nh.examples.rattleback()
        >>> ready.coordinates, ready.body_velocity[2].item()
        (('x', 'y', 'theta', 'lean', 'pitch'), 5.0)
    """
    q, angles = np.array([0.0, 0.0, 0.0, *tilt]), np.array([spin, *rates])
    system = _system(np.array(semi_axes), center, np.array(inertia), product, gravity)
    with double_precision():
        v = np.append(np.asarray(_Boat(system.parameters).rolling(jnp.asarray(q))) @ angles, angles)
    return Example("rattleback", system, q, v, {"energy": energy_of(system)}, time_step=0.002, steps=5000)


class _Boat(NamedTuple):
    """The ellipsoid by its parameters, and how it rolls."""

    p: Numbers

    def support(self, q: Array) -> tuple[Array, Array, Array]:
        """Return the height of the center of mass, its gradient by the vertical, and the vertical, in body axes."""
        (lean, rise), (sin, cos) = (jnp.sin(q[3]), jnp.cos(q[3])), (jnp.sin(q[4]), jnp.cos(q[4]))
        up, D, low = jnp.stack([-sin * rise, lean, cos * rise]), jnp.asarray(self.p["semi_axes"]) ** 2, self.p["center"]
        width = jnp.sqrt(up @ (D * up))
        return width - low * up[2], D * up / width - low * np.array([0.0, 0.0, 1.0]), up

    def turns(self, q: Array) -> Array:
        """Return the angular velocities of one unit of each rate of an angle, as columns in body axes."""
        ahead = jnp.stack([jnp.cos(q[4]), 0.0 * q[4], jnp.sin(q[4])])
        return jnp.stack([self.support(q)[2], ahead, np.array([0.0, 1.0, 0.0])], axis=1)

    def rolling(self, q: Array) -> Array:
        """Return the matrix from rates of the angles to the velocity ahead and to the left."""
        (lean, rise), (sin, cos) = (jnp.sin(q[3]), jnp.cos(q[3])), (jnp.sin(q[4]), jnp.cos(q[4]))
        level = jnp.stack([jnp.stack([cos, 0.0 * cos, sin]), jnp.stack([sin * lean, rise, -cos * lean])])
        return level @ jnp.cross(self.turns(q).T, self.support(q)[1]).T


@family
def _system() -> LagrangeDAlembert:
    exchange = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]])

    def lagrangian(q: Array, v: Array, p: Numbers) -> Array:
        boat, tensor = _Boat(p), p["inertia"] * np.eye(3) + p["product"] * exchange
        height, gradient, up = boat.support(q)
        omega = boat.turns(q) @ v[2:]
        velocity = jnp.stack([v[0], v[1], gradient @ jnp.cross(up, omega)])
        return (velocity @ velocity + omega @ tensor @ omega) / 2 - p["gravity"] * height

    def forms(q: Array, p: Numbers) -> Array:
        cos, sin = jnp.cos(q[2]), jnp.sin(q[2])
        return jnp.concatenate([jnp.eye(2), -jnp.array([[cos, -sin], [sin, cos]]) @ _Boat(p).rolling(q)], axis=1)

    numbers = {"semi_axes": np.ones(3), "center": 1.0, "inertia": np.ones(3), "product": 0.0, "gravity": 1.0}
    names = "x y theta lean pitch"
    return system_in(names, "Rattleback", numbers, lagrangian, forms, heading="theta", outline=_outline)


def _outline(_: Array, p: Numbers) -> list[Array]:
    """Return the rim as it looks from above, and the long axis ahead."""
    a, b, _ = p["semi_axes"]
    angle = np.linspace(0.0, 2 * np.pi, 41)
    return [np.stack([a * np.cos(angle), b * np.sin(angle)], axis=1), np.array([[0.5 * a, 0.0], [a, 0.0]])]


@ready("velocity", positive="inertia", inertia="three moments", stiffness="three numbers", velocity="two components")
def heavy_suslov_top(
    *,
    inertia: tuple[float, float, float] = (1.0, 1.2, 0.8),
    stiffness: tuple[float, float, float] = (0.5, 1.0, 2.0),
    velocity: tuple[float, float] = (0.6, 0.4),
) -> Example:
    r"""A top that may not spin about its third axis, in the quadratic potential of Klebsch and Tisserand.

    $$ I\dot\omega = I\omega\times\omega + \gamma\times\nabla U(\gamma) + \lambda e_3, \quad \omega_3 = 0, \qquad
       \dot\gamma = \gamma\times\omega, \qquad U = \tfrac12(c_1\gamma_1^2 + c_2\gamma_2^2 + c_3\gamma_3^2) $$

    with the vertical $\gamma = R^Te_3$ seen from the body and principal moments I; the third axis is the
    forbidden one.
    The two equations separate,

    $$ I_1\omega_1^2 - (c_3 - c_2)\gamma_2^2, \qquad I_2\omega_2^2 - (c_3 - c_1)\gamma_1^2, $$

    are constant, and so half of their sum, the energy but for $c_3/2$.

    Reference: [hu-santoprete-2017]; the integrals follow at once from the equations above.

    Facts:
        The equations separate: there are two quadratic integrals.
        Every solution is one of quadratures.

    Args:
        inertia: Principal moments I.
        stiffness: c.
        velocity: (omega_1, omega_2) at the start, where the third axis is vertical.

    Raises:
        ValueError: A moment that is not positive, moments of no body, a wrong shape.

    Example:
        >>> ready = nh.examples.heavy_suslov_top()
        >>> discrete = nh.discretize(ready.system, 0.01)
        >>> orbit = nh.simulate(discrete, body_velocity=ready.body_velocity, steps=1000)
        >>> values = ready.conserved["of the first axis"](orbit.configuration, orbit.body_velocity)
        >>> bool(np.ptp(values) < 1e-3)
        True
    """
    c = np.asarray(stiffness)

    def integral(g: Array, v: Array, axis: int) -> Array:
        return inertia[axis] * v[..., axis] ** 2 - (c[2] - c[1 - axis]) * g[..., 2, 1 - axis] ** 2

    axes = enumerate(("first", "second"))
    conserved = {f"of the {name} axis": functools.partial(integral, axis=i) for i, name in axes}

    import numba

    @numba.njit
    def potential(g: Float[np.ndarray, "3 3"]) -> np.float64:
        return c @ g[2] ** 2 / 2

    system = Forced(SuslovTop.from_inertia(np.diag(inertia)), potential)
    return Example("heavy_suslov_top", system, np.eye(3), np.append(velocity, 0.0), conserved)
