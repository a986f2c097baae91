"""`tracking_feedback`: forces, linear in the error, that lead a disturbed motion back to a reference orbit."""

import dataclasses
import functools
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from nonholo.analysis.steering._arguments import VELOCITIES, check_names, checked_limits, velocities_of
from nonholo.base.checks import array, error, needs, positive_definite, shape_of, symmetric
from nonholo.base.memo import Keeper
from nonholo.base.progress import interruptibly
from nonholo.base.results import result
from nonholo.base.types import Float
from nonholo.discrete import Discretization
from nonholo.systems import AbstractCoordinateDiscretization


class Tracking(NamedTuple):
    """A motion under feedback.

    Attributes:
        orbit: The states, a `Rollout` or a `CoordinateRollout`.
        controls: Body covectors that the feedback gave, (steps, dim), without the disturbance; in coordinates forces.
        error: Of the states, (K, dim + k): log(g*^-1 g), then w - w*; in coordinates (K, 2 n), q - q*, then v - v*.
    """

    orbit: Any
    controls: Float[np.ndarray, "steps dim"]
    error: Float[np.ndarray, "K n"]


@result
class Feedback(Keeper):
    """A reference orbit and the feedback along it.

    Attributes:
        discrete: The steered system.
        controls: Body covectors of the reference, (steps, dim), or forces on its coordinates.
        reference: The reference orbit, a `Rollout` or a `CoordinateRollout`.
        gains: K, (steps, k, n) with n = dim + k; in coordinates k = dim is their number.
        linearization: A and B of each step, (steps, n, n) and (steps, n, k).
        limits: The least and the largest force along each row, (k,).
    """

    discrete: Discretization | AbstractCoordinateDiscretization
    controls: Float[np.ndarray, "steps dim"]
    reference: Any = dataclasses.field(repr=False)
    gains: Float[np.ndarray, "steps k n"] = dataclasses.field(repr=False)
    linearization: tuple[np.ndarray, np.ndarray] = dataclasses.field(repr=False)
    limits: tuple[np.ndarray, np.ndarray]

    @functools.cached_property
    def controllability(self) -> Float[np.ndarray, "n"]:
        r"""Singular values, largest first, of the linear map from all forces to the last error.

        One that is zero to rounding belongs to an error that no feedback removes, to first order; a small one to an
        error that asks for large forces. Their squares are the eigenvalues of the Gramian of controllability.
        In coordinates those of errors that the constraints exclude are zero.
        """
        (A, B), ways = self.linearization, np.zeros((self.gains.shape[2], 0))
        for step in range(len(A)):
            ways = np.concatenate([A[step] @ ways, B[step]], axis=1)
        return np.linalg.svd(ways, compute_uv=False)

    def simulate(
        self,
        *,
        restricted_velocity: Any = None,
        body_velocity: Any = None,
        momentum: Any = None,
        configuration: Any = None,
        disturbance: Any = None,
        misreading: Any = None,
    ) -> Tracking:
        """Run the system under the feedback, from a given start, with pushes that the feedback does not include.

        Args:
            restricted_velocity: The first velocity along the constraint, of a body on a group; by default that of the
                reference.
            body_velocity: The first body velocity, or velocity in coordinates.
            momentum: The first momentum.
            configuration: The first configuration; by default that of the reference.
            disturbance: Body covectors beside the controls, (steps, dim); in coordinates forces.
            misreading: The error added to the state where the feedback reads it, (steps, n).

        Returns:
            The motion. Its `orbit.outcome` is not zero where it ends early, NaN from there on.

        Raises:
            ValueError: A bad argument.
        """
        where = "Feedback.simulate"
        with needs("jax", where):
            from nonholo.analysis.steering._tracks import closed_loop, track_of
        track, values = track_of(where, self.discrete), (restricted_velocity, body_velocity, momentum)
        start = velocities_of(dict(zip(VELOCITIES, values, strict=True)))
        check_names(where, start, track.velocities)
        nodes = track.nodes(self.reference)
        start = start or {track.velocities[0]: nodes[1][0] @ np.linalg.pinv(track.rows)}
        start["configuration"] = nodes[0][0] if configuration is None else configuration

        def table(name: str, value: Any, default: np.ndarray) -> np.ndarray:
            return default if value is None else array(f"{where}({name}=...)", value, default.shape)

        push = table("disturbance", disturbance, np.zeros_like(self.controls))
        misread = table("misreading", misreading, np.zeros_like(self.gains[:, 0]))
        tables = self.controls @ track.rows.T, self.gains, misread, push
        return Tracking(*closed_loop(where, track, nodes, start, tables, self.limits))


def tracking_feedback(
    discrete: Discretization | AbstractCoordinateDiscretization,
    start: Mapping[str, Any],
    controls: Any,
    *,
    state_weight: Any = 1.0,
    control_weight: Any = 1.0,
    final_weight: Any = 1.0,
    bounds: Any = None,
) -> Feedback:
    r"""Make the linear feedback along an orbit that spends least on errors and on forces together (LQR).

    $$ f_j = f_j^* + \delta f_j,\quad \delta f_j = -K_j e_j,\quad e_j = \bigl(\log(g_j^{*-1}g_j),\ w_j - w_j^*\bigr),
       \quad e_{j+1} = A_je_j + B_j\,\delta f_j + \dots, $$

    $$ \min\ \tfrac12 e_N^TFe_N + \tfrac h2\sum_j\bigl(e_j^TQe_j + \delta f_j^TR\,\delta f_j\bigr),\qquad
       P_N = F,\quad K_j = (hR + B^TPB)^{-1}B^TPA,\quad P_j = hQ + A^TP(A - BK_j), $$

    with $P = P_{j+1}$. A star marks the reference, that of `rollout` from the start under the controls; f are forces
    and w velocities along the rows of the constraint subspace. The error of a pose is seen from the reference, so that
    gains do not depend on where it lies. A and B are the exact derivatives of the discrete step. The force is found
    from the state at a node, and is constant over the step after it.

    In coordinates of a `LagrangeDAlembert` forces act on them, $e_j = (q_j - q_j^*, v_j - v_j^*)$ with the velocities v
    that belong to the momenta at the nodes, and gains act on errors along admissible directions. Its equations may
    depend on time. So it is for a `GroupLagrangeDAlembert`, with body covectors and errors of poses.

    Feedback removes what forces can reach: a sleigh at rest is not moved sideways, to first order, by any.
    `Feedback.controllability` measures this along the whole orbit. Errors of poses must stay below half a turn.

    Reference: the recursion [anderson-moore-1990]; errors on a group [bullo-murray-1999].

    Args:
        discrete: The discretized system, of order 2, with a left-invariant constraint, whose table of forces goes into
            the controls; or one in coordinates, or by functions on a group.
        start: Of the reference, as for `steer`.
        controls: Body covectors of the reference, (steps, dim), in coordinates forces: `Steering.controls`, or zeros
            for a free motion.
        state_weight: Q, of errors per time: a number, (n,) for a diagonal, or (n, n), with n = dim + k. Not negative.
        control_weight: R, of forces per time: a number, (k,) or (k, k). Positive.
        final_weight: F, of the last error, as `state_weight`.
        bounds: Least and largest force, numbers or one for each row; the feedback is clipped to them. A row whose
            bounds are equal is left out of the gains: no motor is there.

    Returns:
        The feedback; its `simulate` runs a disturbed motion.

    Raises:
        ValueError: A bad argument, a reference that ends early.

    Example:
        A sleigh that glides straight on, and begins half a unit beside its line:

        >>> sleigh = nh.discretize(nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.2), 0.1)
        >>> hold = nh.tracking_feedback(sleigh, {"restricted_velocity": (0.0, 1.0)}, np.zeros((100, 3)))
        >>> beside = nh.SE(2).exp([0.0, 0.0, 0.5])
        >>> motion = hold.simulate(configuration=beside)
        >>> bool(np.abs(motion.error[-1]).max() < 0.01), int((hold.controllability > 1e-9).sum())
        (True, 5)

        A rolling disk is led back to its line by the motors of its rolling and its heading:

        >>> disk = nh.examples.rolling_disk(rates=(1.0, 0.0))
        >>> line = {"configuration": disk.configuration, "body_velocity": disk.body_velocity}
        >>> motors = np.array([0.0, 0.0, 1.0, 1.0])
        >>> steered = nh.tracking_feedback(disk.discretize(0.1), line, np.zeros((100, 4)), bounds=(-motors, motors))
        >>> motion = steered.simulate(configuration=(0.0, 0.3, 0.0, 0.0))
        >>> bool(np.abs(motion.error[-1]).max() < 0.01)
        True
    """
    where = "tracking_feedback"
    with needs("jax", where):
        from nonholo.analysis.steering._tracks import track_of
        from nonholo.simulation.traced import roll
    track = track_of(where, discrete)
    check_names(f"{where}(start=...)", start, track.velocities)
    k, dim = track.rows.shape
    Q = _weight(f"{where}(state_weight=...)", state_weight, dim + k)
    F = _weight(f"{where}(final_weight=...)", final_weight, dim + k)
    R = _weight(f"{where}(control_weight=...)", control_weight, k)
    positive_definite(f"{where}(control_weight=...)", R, "the weight", "Pass a positive number, or one for each row.")
    table = array(f"{where}(controls=...)", controls, (None, dim), "Pass a body covector for each step.")
    limits = checked_limits(f"{where}(bounds=...)", bounds, k)
    track.check(where, len(table))
    rest: dict[str, Any] = {} if velocities_of(start) else {track.velocities[0]: np.zeros(k)}
    reference = roll(where, discrete, **start, **rest, controls=table, steps=len(table))
    if reference.outcome != 0:
        raise error(f"{where}(controls=...)", "give a motion to the end", "one that ends early", "Take shorter steps.")
    A, B = interruptibly(lambda: track.linearize(track.nodes(reference), table))
    B, h = B * (limits[0] < limits[1]), float(discrete.time_step)
    return Feedback(discrete, table, reference, riccati_gains(A, B, (h * Q, h * R, F)), (A, B), limits)


def riccati_gains(
    A: Float[np.ndarray, "steps n n"], B: Float[np.ndarray, "steps n k"], weights: tuple[np.ndarray, ...]
) -> Float[np.ndarray, "steps k n"]:
    """Return the gains of the least of e_N F e_N + sum of e Q e + f R f for e' = A e + B f; the weights are Q, R, F."""
    Q, R, P = weights
    gains = np.empty((len(A), *B.shape[:0:-1]))
    for j in reversed(range(len(A))):
        gains[j] = np.linalg.solve(R + B[j].T @ P @ B[j], B[j].T @ P @ A[j])
        rest = A[j] - B[j] @ gains[j]
        P = Q + gains[j].T @ R @ gains[j] + rest.T @ P @ rest  # a sum of squares: no rounding makes it negative
    return gains


def _weight(where: str, value: Any, n: int) -> Float[np.ndarray, "n n"]:
    """Return a weight as a matrix, symmetric and not negative."""
    remedy = f"Pass a number, {n} numbers, or a symmetric matrix of this size, with no negative eigenvalue."
    W = array(where, value, (n,) * min(2, len(shape_of(value))), remedy)
    W = symmetric(where, W if W.ndim == 2 else W * np.eye(n), remedy)
    if np.linalg.eigvalsh(W)[0] < -1e-13 * np.abs(W).max():
        raise error(where, "not be negative", f"an eigenvalue {np.linalg.eigvalsh(W)[0]:.6g}", remedy)
    return W
