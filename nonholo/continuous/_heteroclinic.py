r"""The momentum of every system with a two-dimensional constraint, in closed form.

In coordinates $x = L^{-1} r$, $B = L L^T$ the constrained inertia, the energy is $|x|^2/2$ and $r'$ is quadratic, so
$x' = (\gamma\cdot x)\,Q x$ with a quarter turn $Q$ and a constant $\gamma$: x runs along a circle from $-Q\gamma$ to
$Q\gamma$. For the top $\gamma = L^{-1} Q c/\sqrt{\det B}$, for the sleigh $\gamma = (a\sqrt m/I, 0)$.
"""

import dataclasses

import numpy as np

from nonholo.base.types import Array, Float
from nonholo.continuous._equations import body_of, momentum_rate
from nonholo.systems import AbstractSystem

_SMALLEST = 1e-290  # of a pull, or of the part of the momentum across the equilibria: below it digits are lost


@dataclasses.dataclass(frozen=True, eq=False)
class Heteroclinic:
    r"""A motion between two equilibria: $r(t) = r_\perp\,\mathrm{sech}(s_0 + \nu t) + r_\parallel \tanh(s_0 + \nu t)$.

    Attributes:
        across: $r_\perp$, shape (k,).
        along: $r_\parallel$, shape (k,): the equilibrium approached as $t \to \infty$.
        start: $s_0$.
        rate: $\nu \ge 0$; zero if the momentum is constant, which is then $r_\perp$.
    """

    across: Float[Array, "k"]
    along: Float[Array, "k"]
    start: Array
    rate: Array

    def momentum(self, elapsed: Float[Array, "..."]) -> Float[Array, "... k"]:
        """Return the momentum, without overflow and cancellation at any time."""
        xp = elapsed.__array_namespace__()
        phase = (self.start + self.rate * elapsed)[..., None]
        decay = xp.exp(-abs(phase))
        return (2 * decay / (1 + decay * decay)) * self.across + xp.tanh(phase) * self.along


def heteroclinic(system: AbstractSystem, reduced_momentum: Float[np.ndarray, "2"]) -> Heteroclinic:
    r"""Return the momentum of a system with a two-dimensional constraint in closed form.

    With $n = \gamma/|\gamma|$ and $|x|$ constant: $x(t) = |x|\,[\pm\mathrm{sech}\,s\; n + \tanh s\; Q n]$,
    $s = s_0 + |\gamma||x|\,t$, $\sinh s_0 = (x_0\cdot Qn)/|x_0\cdot n|$. The rates of two unit vectors show
    what $\gamma$ is.
    """
    lower = np.linalg.cholesky(system.constrained_inertia)
    x = np.linalg.solve(lower, reduced_momentum)
    first, second = _rates(system, lower, np.eye(2))
    pull = np.array([first[1], -second[0]])
    strength, level = np.hypot(*pull), np.hypot(*x)
    constant = Heteroclinic(reduced_momentum, np.zeros(2), np.float64(0), np.float64(0))
    if strength <= _SMALLEST or level == 0:
        return constant
    normal, unit = pull / strength, x / level
    # Taken from the rate: near the equilibria unit @ normal loses more digits.
    across = _rates(system, lower, unit) @ _turned(unit) / strength
    if abs(across) <= _SMALLEST:
        return constant
    start = np.arcsinh(unit @ _turned(normal) / abs(across))
    side = np.copysign(level, across)
    return Heteroclinic(side * lower @ normal, level * lower @ _turned(normal), start, strength * level)


def _rates(
    system: AbstractSystem, lower: Float[np.ndarray, "2 2"], x: Float[np.ndarray, "... 2"]
) -> Float[np.ndarray, "... 2"]:
    rates, _, _ = momentum_rate(system.group, body_of(system), x @ lower.T)
    return np.linalg.solve(lower, rates[..., None])[..., 0]


def _turned(x: Float[np.ndarray, "2"]) -> Float[np.ndarray, "2"]:
    return np.array([-x[1], x[0]])
