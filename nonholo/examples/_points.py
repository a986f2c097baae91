"""Points: the nonholonomic particle, and oscillators coupled by a constraint, of which one is chaotic."""

import jax.numpy as jnp
import numpy as np

from nonholo.base.checks import bounded_count
from nonholo.base.types import Array
from nonholo.examples._example import Example, Numbers, family, ready, system_in
from nonholo.examples._formulas import energy_of, rate
from nonholo.lagrange_dalembert import LagrangeDAlembert


@ready("configuration planar_velocity", configuration="x, y and z", planar_velocity="x' and y'")
def particle(
    *,
    mass: float = 1.0,
    configuration: tuple[float, float, float] = (0.0, 0.0, 0.0),
    planar_velocity: tuple[float, float] = (1.0, 1.0),
) -> Example:
    r"""The free particle in space with the constraint z' = y x'.

    $$ L = \tfrac m2(\dot x^2 + \dot y^2 + \dot z^2), \qquad \dot z = y\,\dot x. $$

    With $\dot y = b$ and $c = \dot x\sqrt{1 + y^2}$, both constant, $y = y_0 + bt$ and

    $$ x - x_0 = \tfrac cb(\operatorname{arsinh} y - \operatorname{arsinh} y_0), \qquad
       z - z_0 = \tfrac cb\bigl(\sqrt{1 + y^2} - \sqrt{1 + y_0^2}\bigr). $$

    Reference: [bates-sniatycki-1993]; [cortes-martinez-2001].

    Facts:
        y' and x' sqrt(1 + y^2) are constant.
        The discrete energy settles to a constant; it does not drift.

    Args:
        mass: m.
        configuration: (x, y, z) at the start.
        planar_velocity: (x', y') at the start.

    Raises:
        ValueError: A mass that is not positive, a wrong shape.

    Example:
        >>> ready = nh.examples.particle()
        >>> orbit = ready.flow(times=(0, 5))
        >>> bool(np.allclose(orbit.configuration, ready.exact(orbit.time), rtol=0, atol=1e-9))
        True
    """
    q = np.asarray(configuration)
    (a, b), y0 = planar_velocity, q[1]
    c = a * np.sqrt(1 + y0**2)

    def exact(time: Array) -> Array:
        t = np.asarray(time)
        y = y0 + b * t
        # the quotients (f(y) - f(y0))/b in a form that stays accurate for b = 0
        root, root0 = np.sqrt(1 + y**2), np.sqrt(1 + y0**2)
        x = c * t / root0 if b == 0 else c / b * (np.arcsinh(y) - np.arcsinh(y0))
        return np.stack([q[0] + x, y, q[2] + c * t * (y + y0) / (root + root0)], axis=-1)

    conserved = {"y'": rate(1), "x' sqrt(1 + y^2)": lambda q, v: v[..., 0] * np.sqrt(1 + q[..., 1] ** 2)}
    v = np.array([a, b, y0 * a])
    return Example("particle", _particle_system(mass), q, v, conserved, exact)


@family
def _particle_system() -> LagrangeDAlembert:
    def lagrangian(q: Array, v: Array, p: Numbers) -> Array:
        return p["mass"] * (v @ v) / 2

    def forms(q: Array, p: Numbers) -> Array:
        return jnp.array([[-q[1], 0.0, 1.0]])

    return system_in("x y z", "Nonholonomic particle", ["mass"], lagrangian, forms)


@ready(reals="coupling")
def chaotic_quartic_oscillator(*, pairs: int = 3, coupling: float = 1.0) -> Example:
    r"""Oscillators with quartic couplings and one constraint, whose motion is chaotic: q = (x, y_1.., z_1..).

    $$ L = \tfrac12|\dot q|^2 - \tfrac12|q|^2 - \tfrac\kappa2\Bigl(z_1^2 z_2^2 + \sum_{i=1}^n y_i^2 z_i^2\Bigr), \qquad
       \dot x + \sum_{i=1}^n y_i\,\dot z_i = 0. $$

    Only the energy is known to be conserved. (For one pair the term $z_1^2 z_2^2$ is left out.) The energy error of the
    midpoint rule is of size h^2 and spreads like a random walk: its mean square grows with time.

    Reference: [mclachlan-perlmutter-2006]; also [celledoni-farre-hoiseth-martin-2019]. The start is our own.

    Facts:
        The energy is the only known conserved quantity.
        The motion is chaotic.
        The discrete energy error spreads like a random walk of size h^2.

    Args:
        pairs: n; there are 2 n + 1 coordinates.
        coupling: kappa, 1 in the source.

    Raises:
        ValueError: A number of pairs that is not a positive integer, a coupling that is no finite number.

    Example:
        >>> nh.examples.chaotic_quartic_oscillator().coordinates
        ('x', 'y1', 'y2', 'y3', 'z1', 'z2', 'z3')
    """
    n = bounded_count("examples.chaotic_quartic_oscillator(pairs=...)", pairs, 64.0, "Pass the number of pairs.")
    index = np.arange(1, n + 1)
    y, z = 0.6 / index, 0.4 + 0.2 * index
    z_rates = 1.0 / index
    q = np.concatenate([[0.5], y, z])
    v = np.concatenate([[-y @ z_rates], np.zeros(n), z_rates])

    system = _quartic(coupling, n=n)
    return Example("chaotic_quartic_oscillator", system, q, v, {"energy": energy_of(system)})


@family
def _quartic(n: int) -> LagrangeDAlembert:
    def lagrangian(q: Array, v: Array, p: Numbers) -> Array:
        y, z = q[1 : n + 1], q[n + 1 :]
        quartic = jnp.sum(y**2 * z**2) + (z[0] ** 2 * z[1] ** 2 if n > 1 else 0.0)
        return (v @ v - q @ q - p["coupling"] * quartic) / 2

    def forms(q: Array, _: Numbers) -> Array:
        return jnp.concatenate([jnp.ones(1), jnp.zeros(n), q[1 : n + 1]])[None]

    pairs = " ".join(f"{letter}{i}" for letter in "yz" for i in range(1, n + 1))
    return system_in(f"x {pairs}", "Chaotic oscillator", ["coupling"], lagrangian, forms)


@ready("turning", reals="asymmetry")
def non_reversible(*, asymmetry: float = 0.5, turning: float = 2.6) -> Example:
    r"""Two oscillators in a gearbox whose ratio is set by a rotating, asymmetric pendulum: q = (x, y, xi).

    $$ L = \tfrac12(\dot x^2 + \dot y^2 + \dot\xi^2) - \tfrac12(x^2 + y^2) + \cos\xi - \tfrac\epsilon2\sin2\xi, \qquad
       \dot x + \sin\xi\,\dot y = 0. $$

    The pendulum is not influenced by the oscillators. With $\epsilon = 0$, or when it swings to and fro, a reflection
    reverses the motion on each of its levels; when it rotates and $\epsilon \ne 0$ no reflection does. Energy is
    conserved all the same, and so is that of the pendulum. But without a reversal the energy error of the discrete map
    is not bounded: the energy of the oscillators drifts in proportion to time and $h^2$, while with $\epsilon = 0$ it
    does not. This shows that good energy behavior is owed to reversibility, not to the discrete principle.

    Reference: [modin-verdier-2020], whose construction of perturbed, coupled test problems this follows (with
    parameters of our own).

    Args:
        asymmetry: epsilon; 0 gives the reversible companion.
        turning: xi' at the start, at the lowest point of the symmetric pendulum; it rotates if large enough.

    Raises:
        ValueError: A value that is not a finite number.

    Example:
        >>> ready = nh.examples.non_reversible()
        >>> [round(float(f(ready.configuration, ready.body_velocity)), 9) for f in ready.conserved.values()]
        [3.17, 2.38]
    """

    def pendulum(q: Array, v: Array) -> Array:
        xi = q[..., 2]
        return v[..., 2] ** 2 / 2 - np.cos(xi) + asymmetry / 2 * np.sin(2 * xi)

    q, v = np.array([1.0, 0.3, 0.0]), np.array([0.0, 0.7, turning])
    facts = (
        "Energy and the energy of the pendulum are conserved.",
        "No reflection reverses a rotation: the discrete energy drifts in proportion to h^2 and time."
        if asymmetry
        else "The reflection (x, -y, -xi) reverses the motion: the discrete energy does not drift.",
    )
    system = _gearbox(asymmetry, is_reversible=asymmetry == 0)
    conserved = {"energy": energy_of(system), "energy of the pendulum": pendulum}
    return Example("non_reversible", system, q, v, conserved, facts=facts)


@family
def _gearbox(is_reversible: bool) -> LagrangeDAlembert:
    def lagrangian(q: Array, v: Array, p: Numbers) -> Array:
        return (v @ v - q[0] ** 2 - q[1] ** 2) / 2 + jnp.cos(q[2]) - p["asymmetry"] / 2 * jnp.sin(2 * q[2])

    def forms(q: Array, _: Numbers) -> Array:
        return jnp.stack([jnp.ones(()), jnp.sin(q[2]), jnp.zeros(())])[None]

    name = "Oscillators, reversible" if is_reversible else "Oscillators, not reversible"
    return system_in("x y xi", name, {"asymmetry": 0.0}, lagrangian, forms)
