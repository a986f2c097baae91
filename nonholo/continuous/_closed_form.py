"""Closed forms of the continuous motion: momenta along two directions, heading and path of the sleigh."""

import functools
from collections.abc import Callable

import numpy as np

from nonholo.base.checks import error
from nonholo.base.numerics import sinc
from nonholo.base.results import Outcome
from nonholo.base.types import Float
from nonholo.continuous._blade_path import blade_path
from nonholo.continuous._equations import body_of
from nonholo.continuous._heteroclinic import Heteroclinic, heteroclinic
from nonholo.continuous._series import pose_by_series
from nonholo.continuous._solution import Solved, States
from nonholo.systems import AbstractSystem, NormalForm

_LARGEST_RATIO = 1e150  # of turn to the Gudermannian; beyond it the center of mass is as good as at the blade


def closed_form(
    system: AbstractSystem,
    reduced_momentum: Float[np.ndarray, "k"],
    pose: Float[np.ndarray, "size"],
    elapsed: Float[np.ndarray, "K"],
    tolerances: tuple[float, float],
) -> Solved:
    """Solve the equations of a canonical system with two directions; times elapse from zero.

    Heading and path of a sleigh are exact; other poses are a quadrature by Taylor series.
    """
    if system.is_spatial or system.rank != 2:
        remedy = "Leave method out to integrate numerically."
        raise error("flow(method='closed_form')", "have a closed-form solution", type(system).__name__, remedy)
    motion, form = heteroclinic(system, reduced_momentum), system.normal_form
    if form is not None and form.is_sleigh:
        at = functools.partial(_sleigh_states, system, form, motion, reduced_momentum, pose)
        return Solved(at(elapsed), Outcome.successful, at)
    posed = pose_by_series(system.group, motion, body_of(system)[2], pose, elapsed, tolerances)
    reached = elapsed[: len(posed.states.momenta)]
    at = functools.partial(_with_momenta, motion, posed.at)
    return posed._replace(states=posed.states._replace(momenta=motion.momentum(reached)), at=at)


def _with_momenta(motion: Heteroclinic, series: Callable[[np.ndarray], States], elapsed: np.ndarray) -> States:
    return series(elapsed)._replace(momenta=motion.momentum(elapsed))


def _sleigh_states(
    system: AbstractSystem,
    form: NormalForm,
    motion: Heteroclinic,
    reduced_momentum: np.ndarray,
    pose: np.ndarray,
    elapsed: np.ndarray,
) -> States:
    group, foot = system.group, _foot(form)
    first = pose if foot is None else group.pose_from_matrix(group.matrix_from_pose(pose) @ foot)
    facing = _facing(first)
    omega, u = _turn_and_slide(system, form, reduced_momentum)
    gyration = np.sqrt(form.arm**2 + form.stiffness[0, 0] / form.mass)
    if motion.rate == 0 or gyration > _LARGEST_RATIO * abs(form.arm):
        turn, shift = _circle(omega, u, elapsed)
    else:
        sign = np.copysign(1.0, _turn_and_slide(system, form, motion.across)[0])
        turn, shift = _asymptotically_straight(gyration, form.arm, sign, motion, elapsed)
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


def _rows(form: NormalForm) -> Float[np.ndarray, "2 2"]:
    """Return C with r_form = C r."""
    return np.eye(2) if form.frame_map is None else form.frame_map


def _turn_and_slide(system: AbstractSystem, form: NormalForm, momentum: np.ndarray) -> tuple[float, float]:
    r"""Return $\omega$ and the velocity along the blade of the foot of the center of mass."""
    w, v1 = np.linalg.solve(_rows(form).T, system.restricted_velocity(momentum))
    return -w, v1 + form.offset[0] * w


def _circle(omega: float, v1: float, elapsed: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return turn and shift of constant velocities: the chord of a circle, or a straight line."""
    half = omega * elapsed / 2
    return 2 * half, v1 * elapsed * sinc(half * half) * np.exp(1j * half)


def _asymptotically_straight(
    gyration: float, a: float, sign: float, motion: Heteroclinic, elapsed: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    r"""Return turn and shift if neither a nor omega is zero.

    With $I = m\rho^2$: $\Lambda = \rho/|a|$, $\theta - \theta_0 = \pm\Lambda(\phi - \phi_0)$, and the shift is
    $\rho^2/a$ times the `blade_path`, for negative omega its conjugate.
    """
    ratio = gyration / abs(a)
    angle, path = blade_path(ratio, motion.start, motion.rate * elapsed)
    return sign * ratio * angle, gyration**2 / a * (path if sign > 0 else path.conj())
