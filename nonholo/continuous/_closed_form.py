"""Closed forms of the continuous motion: momenta of tops and sleighs, heading and path of the sleigh."""

import numpy as np

from nonholo.base.checks import error
from nonholo.base.numerics import sinc
from nonholo.base.results import Outcome
from nonholo.base.types import Float
from nonholo.continuous._blade_path import blade_path
from nonholo.continuous._heteroclinic import Heteroclinic, heteroclinic
from nonholo.continuous._integration import integrate_pose
from nonholo.systems import AbstractSystem, ChaplyginSleigh, SuslovTop

_LARGEST_RATIO = 1e150  # of turn to the Gudermannian; beyond it the centre of mass is as good as at the blade


def closed_form(
    system: AbstractSystem,
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
    if isinstance(system, SuslovTop) and system.group.dim == 3:
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
