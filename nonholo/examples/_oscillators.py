"""Oscillators coupled by a constraint: one that is chaotic, one whose driver spoils reversibility."""

import functools

import jax.numpy as jnp
import numpy as np

from nonholo.base.checks import number
from nonholo.base.limits import bounded_count
from nonholo.base.types import Array
from nonholo.examples._example import Example, ready
from nonholo.lagrange_dalembert import LagrangeDAlembert


@ready()
def chaotic_quartic_oscillator(*, pairs: int = 3) -> Example:
    r"""Oscillators with quartic couplings and one constraint, whose motion is chaotic: q = (x, y_1.., z_1..).

    $$ L = \tfrac12|\dot q|^2 - \tfrac12\Bigl(|q|^2 + z_1^2 z_2^2 + \sum_{i=1}^n y_i^2 z_i^2\Bigr), \qquad
       \dot x + \sum_{i=1}^n y_i\,\dot z_i = 0. $$

    Only the energy is known to be conserved. (For one pair the term $z_1^2 z_2^2$ is left out.) The energy error of the
    midpoint rule is of size h^2 and spreads like a random walk: its mean square grows with time.

    Reference: [mclachlan-perlmutter-2006]; also [celledoni-farre-hoiseth-martin-2019]. The start is our own.

    Args:
        pairs: n; there are 2 n + 1 coordinates.

    Raises:
        ValueError: A number of pairs that is not a positive integer.

    Example:
        >>> nh.examples.chaotic_quartic_oscillator().coordinates
        ('x', 'y1', 'y2', 'y3', 'z1', 'z2', 'z3')
    """
    n = bounded_count("examples.chaotic_quartic_oscillator(pairs=...)", pairs, 64.0, "Pass the number of pairs.")
    index = np.arange(1, n + 1)
    y, z = 0.6 / index, 0.4 + 0.2 * index
    turned = 1.0 / index
    q = np.concatenate([[0.5], y, z])
    v = np.concatenate([[-y @ turned], np.zeros(n), turned])

    def energy(q: Array, v: Array) -> Array:
        y, z = q[..., 1 : n + 1], q[..., n + 1 :]
        coupling = np.sum(y**2 * z**2, axis=-1) + (z[..., 0] ** 2 * z[..., 1] ** 2 if n > 1 else 0)
        return (np.sum(v**2, axis=-1) + np.sum(q**2, axis=-1) + coupling) / 2

    facts = (
        "The energy is the only known conserved quantity.",
        "The motion is chaotic.",
        "The discrete energy error spreads like a random walk of size h^2.",
    )
    return Example("chaotic_quartic_oscillator", _quartic(n), q, v, facts, {"energy": energy})


@functools.cache
def _quartic(n: int) -> LagrangeDAlembert:
    def lagrangian(q: Array, v: Array) -> Array:
        y, z = q[1 : n + 1], q[n + 1 :]
        coupling = jnp.sum(y**2 * z**2) + (z[0] ** 2 * z[1] ** 2 if n > 1 else 0.0)
        return (v @ v - q @ q - coupling) / 2

    def forms(q: Array) -> Array:
        return jnp.concatenate([jnp.ones(1), jnp.zeros(n), q[1 : n + 1]])[None]

    names = ("x", *(f"{letter}{i}" for letter in "yz" for i in range(1, n + 1)))
    return LagrangeDAlembert(lagrangian, forms, dimension=2 * n + 1, coordinates=names, name="Chaotic oscillator")


@ready("turning")
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
    epsilon = float(number("examples.non_reversible(asymmetry=...)", asymmetry))
    rate = float(number("examples.non_reversible(turning=...)", turning))

    def pendulum(q: Array, v: Array) -> Array:
        xi = q[..., 2]
        return v[..., 2] ** 2 / 2 - np.cos(xi) + epsilon / 2 * np.sin(2 * xi)

    def energy(q: Array, v: Array) -> Array:
        return pendulum(q, v) + np.sum(q[..., :2] ** 2 + v[..., :2] ** 2, axis=-1) / 2

    q, v = np.array([1.0, 0.3, 0.0]), np.array([0.0, 0.7, rate])
    facts = (
        "Energy and the energy of the pendulum are conserved.",
        "No reflection reverses a rotation: the discrete energy drifts in proportion to h^2 and time."
        if epsilon
        else "The reflection (x, -y, -xi) reverses the motion: the discrete energy does not drift.",
    )
    conserved = {"energy": energy, "energy of the pendulum": pendulum}
    return Example("non_reversible", _gearbox(epsilon), q, v, facts, conserved)


@functools.cache
def _gearbox(epsilon: float) -> LagrangeDAlembert:
    def lagrangian(q: Array, v: Array) -> Array:
        return (v @ v - q[0] ** 2 - q[1] ** 2) / 2 + jnp.cos(q[2]) - epsilon / 2 * jnp.sin(2 * q[2])

    def forms(q: Array) -> Array:
        return jnp.stack([jnp.ones(()), jnp.sin(q[2]), jnp.zeros(())])[None]

    name = "Oscillators, not reversible" if epsilon else "Oscillators, reversible"
    return LagrangeDAlembert(lagrangian, forms, dimension=3, coordinates=("x", "y", "xi"), name=name)
