r"""Closed forms: the momentum of every system with a two-dimensional constraint, and the path of the sleigh.

In coordinates $x = L^{-1} r$, $B = L L^T$ the constrained inertia, the energy is $|x|^2/2$ and $r'$ is quadratic, so
$x' = (\gamma\cdot x)\,Q x$ with a quarter turn $Q$ and a constant $\gamma$: x runs along a circle from $-Q\gamma$ to
$Q\gamma$. For the top $\gamma = L^{-1} Q c/\sqrt{\det B}$, for the sleigh $\gamma = (a\sqrt m/I, 0)$.
"""

import dataclasses

import numpy as np

from nonholo._checks import error
from nonholo._results import Outcome
from nonholo._types import Array, Float
from nonholo.continuous._blade_path import blade_path
from nonholo.continuous._equations import body_of, momentum_rate
from nonholo.numerics import sinc
from nonholo.systems import AbstractLLSystem, ChaplyginSleigh, SuslovTop

_SMALLEST = 1e-290  # of a pull, or of the part of the momentum across the equilibria: below it digits are lost
_LARGEST_RATIO = 1e150  # of turn to the Gudermannian; beyond it the centre of mass is as good as at the blade


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


def heteroclinic(system: AbstractLLSystem, reduced_momentum: Float[np.ndarray, "2"]) -> Heteroclinic:
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
    system: AbstractLLSystem, lower: Float[np.ndarray, "2 2"], x: Float[np.ndarray, "... 2"]
) -> Float[np.ndarray, "... 2"]:
    rates, _, _ = momentum_rate(system.group, body_of(system), x @ lower.T)
    return np.linalg.solve(lower, rates[..., None])[..., 0]


def _turned(x: Float[np.ndarray, "2"]) -> Float[np.ndarray, "2"]:
    return np.array([-x[1], x[0]])


def closed_form(
    system: AbstractLLSystem,
    reduced_momentum: Float[np.ndarray, "k"],
    pose: Float[np.ndarray, "size"],
    elapsed: Float[np.ndarray, "K"],
    tolerances: tuple[float, float],
) -> tuple[Float[np.ndarray, "K k"], Float[np.ndarray, "K size"], Float[np.ndarray, "K"] | None, Outcome]:
    """Return momenta, poses, on SE(2) the heading without ambiguity of full turns, and the outcome.

    The system is a canonical one. The pose of a top is a quadrature within the tolerances; all else is exact.
    """
    if isinstance(system, ChaplyginSleigh):
        motion = heteroclinic(system, reduced_momentum)
        poses, turned = _sleigh_poses(system, motion, reduced_momentum, pose, elapsed)
        return motion.momentum(elapsed), poses, turned, Outcome.successful
    if isinstance(system, SuslovTop):
        from nonholo.continuous._integration import integrate_pose

        motion = heteroclinic(system, reduced_momentum)
        poses, outcome = integrate_pose(system, motion, pose, elapsed, tolerances)
        return motion.momentum(elapsed)[: len(poses)], poses, None, outcome
    remedy = "Leave method out to integrate numerically."
    raise error("flow(method='closed_form')", "have a closed-form solution", type(system).__name__, remedy)


def _sleigh_poses(
    sleigh: ChaplyginSleigh, motion: Heteroclinic, reduced_momentum: np.ndarray, pose: np.ndarray, elapsed: np.ndarray
) -> tuple[Float[np.ndarray, "K 4"], Float[np.ndarray, "K"]]:
    facing = complex(pose[0], pose[1]) / np.hypot(pose[0], pose[1])
    omega, v1 = sleigh.restricted_velocity(reduced_momentum)
    gyration = np.sqrt(sleigh.a**2 + sleigh.inertia / sleigh.mass)
    if motion.rate == 0 or gyration > _LARGEST_RATIO * abs(sleigh.a):
        turn, shift = _circle(omega, v1, elapsed)
    else:
        turn, shift = _asymptotically_straight(gyration, sleigh.a, motion, elapsed)
    heading, place = facing * np.exp(1j * turn), complex(pose[2], pose[3]) + facing * shift
    rows = (heading.real, heading.imag, place.real, place.imag)
    return np.stack(rows, axis=-1), np.angle(facing) + turn


def _circle(omega: float, v1: float, elapsed: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return turn and shift of constant velocities: the chord of a circle, or a straight line."""
    half = omega * elapsed / 2
    return 2 * half, v1 * elapsed * sinc(half * half) * np.exp(1j * half)


def _asymptotically_straight(
    gyration: float, a: float, motion: Heteroclinic, elapsed: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    r"""Return turn and shift if neither a nor omega is zero.

    With $I = m\rho^2$: $\Lambda = \rho/|a|$, $\theta - \theta_0 = \pm\Lambda(\phi - \phi_0)$, and the shift is
    $\rho^2/a$ times the `blade_path`, for negative omega its conjugate.
    """
    ratio, sign = gyration / abs(a), np.copysign(1.0, motion.across[0])
    angle, path = blade_path(ratio, motion.start, motion.rate * elapsed)
    return sign * ratio * angle, gyration**2 / a * (path if sign > 0 else path.conj())
