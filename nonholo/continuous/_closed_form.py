r"""Closed forms of the continuous motion: momenta along two directions, heading and path of the sleigh.

In coordinates $x = L^{-1} r$, $B = L L^T$ the constrained inertia, the energy is $|x|^2/2$ and $r'$ is quadratic, so
$x' = (\gamma\cdot x)\,Q x$ with a quarter turn $Q$ and a constant $\gamma$: x runs along a circle from $-Q\gamma$ to
$Q\gamma$. For the top $\gamma = L^{-1} Q c/\sqrt{\det B}$, for the sleigh $\gamma = (a\sqrt m/I, 0)$.

The path of a sleigh's blade is the integral of $\tanh s\; e^{i\Lambda\phi}$ in s, $\phi = \mathrm{gd}\,s$. An
antiderivative is $G = e^{i\Lambda\phi}\Lambda^{-1}[-1 + 2\,{}_2F_1(1, \Lambda/2; 1 + \Lambda/2; -e^{2i\phi})]$
with $G(-s) = \overline{G(s)}$, for $\Lambda > 1$. The argument lies on the unit circle, where `scipy.special.hyp2f1`
can lose every digit (at $\Lambda = 2$, or for large ones), so it is evaluated here, in two regions.
"""

import dataclasses
import functools
from collections.abc import Callable
from typing import cast

import numpy as np
import scipy  # its parts load on first use

from nonholo.base.checks import error
from nonholo.base.numerics import sinc
from nonholo.base.results import Outcome
from nonholo.base.types import Array, Float
from nonholo.continuous._equations import body_of, momentum_rate
from nonholo.continuous._series import Problem, Solved, States, body_equations, power_of_two, solve
from nonholo.systems import AbstractSystem, NormalForm

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
    $s = s_0 + |\gamma||x|\,t$, $\sinh s_0 = (x_0\cdot Qn)/|x_0\cdot n|$. The rates of two unit vectors give
    $\gamma$.
    """
    lower, body = np.linalg.cholesky(system.constrained_inertia), body_of(system)

    def rates(x: Float[np.ndarray, "... 2"]) -> Float[np.ndarray, "... 2"]:
        rates, _, _ = momentum_rate(system.group, body, x @ lower.T)
        return np.linalg.solve(lower, rates[..., None])[..., 0]

    x = np.linalg.solve(lower, reduced_momentum)
    first, second = rates(np.eye(2))
    pull = np.array([first[1], -second[0]])
    strength, level = np.hypot(*pull), np.hypot(*x)
    constant = Heteroclinic(reduced_momentum, np.zeros(2), np.float64(0), np.float64(0))
    if strength <= _SMALLEST or level == 0:
        return constant
    normal, unit = pull / strength, x / level
    # Taken from the rate: near the equilibria unit @ normal loses more digits.
    across = rates(unit) @ _quarter_turn(unit) / strength
    if abs(across) <= _SMALLEST:
        return constant
    start = np.arcsinh(unit @ _quarter_turn(normal) / abs(across))
    side = np.copysign(level, across)
    return Heteroclinic(side * lower @ normal, level * lower @ _quarter_turn(normal), start, strength * level)


def _quarter_turn(x: Float[np.ndarray, "2"]) -> Float[np.ndarray, "2"]:
    return np.array([-x[1], x[0]])


_FRACTION_DEPTH = 200  # enough to rounding for every ratio on the near side of the border
_SERIES_LENGTH = 60  # enough to rounding on the far side
_LEAST_BORDER = 2.5
_NODES = 16  # to rounding on half a unit with one radian of turning


def blade_path(
    ratio: float, start: float, elapsed: Float[np.ndarray, "K"]
) -> tuple[Float[np.ndarray, "K"], Float[np.ndarray, "K"]]:
    r"""Return $\phi - \phi_0$ and $e^{-i\Lambda\phi_0}[G(s) - G(s_0)]$ for $s = s_0 +$ `elapsed`, $\Lambda$ = `ratio`.

    Where both ends lie far out on the same side, the straight part is subtracted analytically. A short path that turns
    little, on which the antiderivative hardly changes, is a quadrature of Gauss.

    Example:
        >>> angle, path = blade_path(2.0, 0.0, np.array([800.0]))
        >>> bool(abs(angle[0] - np.pi / 2) < 1e-15), f"{abs(path[0]):.6f}"
        (True, '798.308398')
    """
    s = start + elapsed
    angle = _gudermannian_difference(start, elapsed)
    path = np.exp(1j * ratio * angle) * _antiderivative(ratio, s) - _antiderivative(ratio, np.array([start]))
    q0 = np.exp(-abs(start))
    border = max(_LEAST_BORDER, ratio)
    if q0 * border <= 1:
        together = (np.exp(-abs(s)) * border <= 1) & (s * start > 0)
        straight = np.copysign(1.0, start) * elapsed + _remainder(ratio, np.exp(-abs(s))) - _remainder(ratio, q0)
        far = np.exp(2j * ratio * np.arctan(q0)) * straight
        path = np.where(together, far if start > 0 else far.conj(), path)
    short = (abs(elapsed) <= 0.5) & (ratio * abs(angle) <= 1)
    return angle, np.where(short, _short_path(ratio, start, elapsed), path)


def _short_path(ratio: float, start: float, elapsed: Float[np.ndarray, "K"]) -> Float[np.ndarray, "K"]:
    """Return the path of `blade_path` by Gauss's quadrature."""
    nodes, weights = np.polynomial.legendre.leggauss(_NODES)
    parts = (1 + nodes) / 2 * elapsed[:, None]
    direction = np.exp(1j * ratio * _gudermannian_difference(start, parts))
    return elapsed / 2 * ((np.tanh(start + parts) * direction) @ weights)


def _gudermannian_difference(start: float, elapsed: np.ndarray) -> np.ndarray:
    r"""Return $2\arctan\bigl(\sinh(\delta/2)/\cosh(s_0 + \delta/2)\bigr)$.

    The exponent $|\delta|/2 - |s_0 + \delta/2|$ is taken out and, since it may cancel, written without halves.
    """
    length, ahead = abs(elapsed), np.copysign(1.0, elapsed) * start
    middle = ahead + length / 2
    exponent = np.where(middle > 0, -ahead, length + ahead)
    size = np.exp(exponent) * -np.expm1(-length) / (1 + np.exp(-2 * abs(middle)))
    return 2 * np.copysign(np.arctan(size), elapsed)


def _antiderivative(ratio: float, s: np.ndarray) -> np.ndarray:
    r"""Return $e^{-i\Lambda\,\mathrm{gd}\,s}\,G(s)$, which for negative s is conjugate."""
    q = np.exp(-abs(s))
    far = q * max(_LEAST_BORDER, ratio) <= 1
    value = np.empty(s.shape, dtype=np.complex128)
    value[~far] = _near(ratio, abs(s[~far]))
    value[far] = _far(ratio, abs(s[far]), q[far])
    return np.where(s < 0, value.conj(), value)


def _near(ratio: float, s: np.ndarray) -> np.ndarray:
    r"""Return $(X - iT)/(1 - X)/\Lambda$, $T = \sinh s$, with Gauss's continued fraction X.

    Euler's transformation takes the argument to $w = (1 + iT)/2$, $b = \Lambda/2$; then
    ${}_2F_1(1, 1; 1 + b; w) = 1/(1 - X)$, $X = d_1 w/(1 - d_2 w/(1 - \cdots))$; the -1 is merged without cancellation.
    """
    T, b = np.sinh(s), ratio / 2
    w = (1 + 1j * T) / 2
    X = np.zeros_like(w)
    for n in range(_FRACTION_DEPTH, 0, -1):
        j = (n + 1) // 2
        X = j * (b + j - 1) / ((b + n - 1) * (b + n)) * w / (1 - X)
    return (X - 1j * T) / (1 - X) / ratio


def _far(ratio: float, s: np.ndarray, q: np.ndarray) -> np.ndarray:
    r"""Return $e^{2i\Lambda\arctan q}\,[s + C + R(q)]$: the asymptotic straight line and what is left of it."""
    constant = -1 / ratio - np.euler_gamma - scipy.special.digamma(ratio / 2) - np.log(4) - 0.5j * np.pi
    return np.exp(2j * ratio * np.arctan(q)) * (s + constant + _remainder(ratio, q))


def _remainder(ratio: float, q: np.ndarray | float) -> np.ndarray:
    r"""Return $R(q) = -\sum_{n \ge 1} \frac{f_n q^n}{n}\bigl(1 - \frac{i}{\Lambda}\frac{n^2 q}{n + 1}\bigr)$.

    The $f_n$ are the coefficients of $\bigl(\frac{1 - iq}{1 + iq}\bigr)^\Lambda$, and R comes from integrating
    $\tanh\sigma\,e^{-2i\Lambda\arctan q} - 1$ in $q = e^{-\sigma}$.
    """
    term, previous = -2j * ratio * q, np.ones_like(q)
    total = np.zeros_like(term)
    for n in range(1, _SERIES_LENGTH + 1):
        total = total - term / n * (1 - 1j / ratio * n * n * q / (n + 1))
        term, previous = (-2j * ratio * q * term - (n - 1) * q * q * previous) / (n + 1), term
    return total


_LARGEST_RATIO = 1e150  # of turn to the Gudermannian; beyond it the center of mass is as good as at the blade


def closed_form(system: AbstractSystem, problem: Problem) -> Solved:
    """Solve the equations of a canonical system with two directions.

    Heading and path of a sleigh are exact; other poses are a quadrature by Taylor series.
    """
    elapsed = problem.elapsed
    if system.is_spatial or system.rank != 2:
        remedy = "Leave method out to integrate numerically."
        raise error("flow(method='closed_form')", "have a closed-form solution", type(system).__name__, remedy)
    motion, form = heteroclinic(system, problem.momentum), system.normal_form
    if form is not None and form.is_sleigh:
        at = functools.partial(_sleigh_states, system, motion, problem)
        return Solved(at(elapsed), Outcome.successful, at)
    series = _pose_by_series(system, motion, problem)
    times = elapsed[: len(series.states.momenta)]
    at = functools.partial(_with_momenta, motion, series.at)
    return series._replace(states=series.states._replace(momenta=motion.momentum(times)), at=at)


def _pose_by_series(system: AbstractSystem, motion: Heteroclinic, problem: Problem) -> Solved:
    r"""Solve for the poses of a body whose momentum is known in closed form.

    In place of the momenta stand sech s and tanh s, whose rates are $-\nu\,\mathrm{sech}\,s\tanh s$ and
    $\nu\,\mathrm{sech}^2 s$.
    """
    velocities = np.stack([motion.across, motion.along]) @ body_of(system)[2]
    unit = power_of_two(np.append(velocities, motion.rate))
    torques = np.zeros((2, 2, 2))
    torques[0, 1, 0], torques[0, 0, 1] = -motion.rate / unit, motion.rate / unit
    decay = np.exp(-abs(motion.start))
    head = np.array([2 * decay / (1 + decay * decay), np.tanh(motion.start)])
    f = body_equations(system.group, velocities / unit, np.eye(2), torques)
    return solve(system.group, f, head, unit, problem)


def _with_momenta(motion: Heteroclinic, series: Callable[[np.ndarray], States], elapsed: np.ndarray) -> States:
    return series(elapsed)._replace(momenta=motion.momentum(elapsed))


def _sleigh_states(system: AbstractSystem, motion: Heteroclinic, problem: Problem, elapsed: np.ndarray) -> States:
    group, form, (reduced_momentum, pose, _, _) = system.group, cast(NormalForm, system.normal_form), problem
    foot = _foot(form)
    first = pose if foot is None else group.pose_from_matrix(group.matrix_from_pose(pose) @ foot)
    facing = _facing(first)
    omega, u = _turn_and_slide(system, form, reduced_momentum)
    gyration = np.sqrt(form.arm**2 + form.stiffness[0, 0] / form.mass)
    if motion.rate == 0 or gyration > _LARGEST_RATIO * abs(form.arm):
        turn, shift = _circle(omega, u, elapsed)
    else:
        sign = np.copysign(1.0, _turn_and_slide(system, form, motion.across)[0])
        # with I = m rho^2: Lambda = rho/|a|, theta - theta_0 = +-Lambda (phi - phi_0); the shift is rho^2/a times the
        # path, for negative omega its conjugate
        ratio = gyration / abs(form.arm)
        angle, path = blade_path(ratio, motion.start, motion.rate * elapsed)
        turn, shift = sign * ratio * angle, gyration**2 / form.arm * (path if sign > 0 else path.conj())
    heading, place = facing * np.exp(1j * turn), complex(first[2], first[3]) + facing * shift
    rows = np.stack((heading.real, heading.imag, place.real, place.imag), axis=-1)
    if foot is not None:
        rows = group.pose_from_matrix(group.matrix_from_pose(rows) @ group.inverse(foot))
    return States(motion.momentum(elapsed), rows, np.angle(_facing(pose)) + turn)


def _facing(pose: np.ndarray) -> complex:
    return complex(pose[0], pose[1]) / np.hypot(pose[0], pose[1])


def _foot(form: NormalForm) -> Float[np.ndarray, "3 3"] | None:
    """Return the axes of the blade at the foot of the center of mass, as seen from the canonical frame, or None."""
    if form.frame is None and not np.any(form.offset):
        return None
    shift = np.eye(3)
    shift[1, 2] = form.offset[0]
    return shift if form.frame is None else form.frame @ shift


def _turn_and_slide(system: AbstractSystem, form: NormalForm, momentum: np.ndarray) -> tuple[float, float]:
    r"""Return $\omega$ and the velocity along the blade of the foot of the center of mass."""
    rows = np.eye(2) if form.frame_map is None else form.frame_map
    w, v1 = np.linalg.solve(rows.T, system.restricted_velocity(momentum))
    return -w, v1 + form.offset[0] * w


def _circle(omega: float, v1: float, elapsed: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return turn and shift of constant velocities: the chord of a circle, or a straight line."""
    half = omega * elapsed / 2
    return 2 * half, v1 * elapsed * sinc(half * half) * np.exp(1j * half)
