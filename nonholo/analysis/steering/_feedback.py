"""`tracking_feedback`: forces, linear in the error, that lead a disturbed motion back to a reference orbit."""

import dataclasses
import functools
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from nonholo.analysis.steering._arguments import check_names, checked_limits
from nonholo.base.checks import array, error, needs, positive_definite, shape_of, symmetric
from nonholo.base.memo import Keeper
from nonholo.base.progress import interruptibly
from nonholo.base.types import Float
from nonholo.discrete import Discretization, as_discretization
from nonholo.simulation import refuse_many_matrices
from nonholo.systems import in_group


class Tracking(NamedTuple):
    """A motion under feedback.

    Attributes:
        orbit: The states, a `Rollout`.
        controls: Body covectors that the feedback gave, (steps, dim), without the disturbance.
        error: Of the states, (K, dim + k): log(g*^-1 g), then w - w*.
    """

    orbit: Any
    controls: Float[np.ndarray, "steps dim"]
    error: Float[np.ndarray, "K n"]


@dataclasses.dataclass(frozen=True, eq=False)
class Feedback(Keeper):
    """A reference orbit and the feedback along it.

    Attributes:
        discrete: The steered system.
        controls: Body covectors of the reference, (steps, dim).
        reference: The reference orbit, a `Rollout`.
        gains: K, (steps, k, n) with n = dim + k.
        linearization: A and B of each step, (steps, n, n) and (steps, n, k).
        limits: The least and the largest force along each row, (k,).
    """

    discrete: Discretization
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
        """
        (A, B), ways = self.linearization, np.zeros((self.gains.shape[2], 0))
        for step in range(len(A)):
            ways = np.concatenate([A[step] @ ways, B[step]], axis=1)
        return np.linalg.svd(ways, compute_uv=False)

    def simulate(
        self,
        *,
        restricted_velocity: Any = None,
        configuration: Any = None,
        disturbance: Any = None,
        misreading: Any = None,
    ) -> Tracking:
        """Run the body under the feedback, from a given start, with pushes that the feedback does not include.

        Args:
            restricted_velocity: The first velocity along the constraint; by default that of the reference.
            configuration: The first pose; by default that of the reference.
            disturbance: Body covectors beside the controls, (steps, dim).
            misreading: The error added to the state where the feedback reads it, (steps, dim + k).

        Returns:
            The motion. Its `orbit.outcome` is not zero where it ends early, NaN from there on.

        Raises:
            ValueError: A bad argument.
        """
        with needs("jax", "Feedback.simulate"):
            from nonholo.analysis.steering._shooting import closed_loop
        where, nodes = "Feedback.simulate", _states(self.discrete, self.reference)
        S = self.discrete.system.constraint_subspace

        def table(name: str, value: Any, default: np.ndarray) -> np.ndarray:
            return default if value is None else array(f"{where}({name}=...)", value, default.shape)

        w, g = table("restricted_velocity", restricted_velocity, nodes[0][0]), nodes[1][0]
        if configuration is not None:
            g = in_group(f"{where}(configuration=...)", self.discrete.system.group, configuration)
        push = table("disturbance", disturbance, np.zeros_like(self.controls))
        misread = table("misreading", misreading, np.zeros_like(self.gains[:, 0]))
        tables = self.controls @ S.T, self.gains, push, misread
        orbit, forces, gaps = closed_loop(self.discrete, nodes, (w, g), tables, self.limits)
        return Tracking(orbit, forces @ np.linalg.pinv(S).T, gaps)


def tracking_feedback(
    discrete: Discretization,
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

    Feedback removes what forces can reach: a sleigh at rest is not moved sideways, to first order, by any.
    `Feedback.controllability` measures this along the whole orbit. Errors of poses must stay below half a turn.

    Reference: the recursion [anderson-moore-1990]; errors on a group [bullo-murray-1999].

    Args:
        discrete: The discretized system, of order 2, with a left-invariant constraint; a table of forces goes into the
            controls.
        start: `configuration` and `restricted_velocity` of the reference, as for `steer`.
        controls: Body covectors of the reference, (steps, dim): `Steering.controls`, or zeros for a free motion.
        state_weight: Q, of errors per time: a number, (n,) for a diagonal, or (n, n), with n = dim + k. Not negative.
        control_weight: R, of forces per time: a number, (k,) or (k, k). Positive.
        final_weight: F, of the last error, as `state_weight`.
        bounds: Least and largest force, numbers or one for each row; the feedback is clipped to them.

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
    """
    where = "tracking_feedback"
    _refuse(where, discrete, start)
    k, dim = discrete.system.rank, discrete.system.group.dim
    Q, F = (
        _weight(f"{where}({name}=...)", value, dim + k)
        for name, value in (("state_weight", state_weight), ("final_weight", final_weight))
    )
    R = _weight(f"{where}(control_weight=...)", control_weight, k)
    positive_definite(f"{where}(control_weight=...)", R, "the weight", "Pass a positive number, or one for each row.")
    table = array(f"{where}(controls=...)", controls, (None, dim), "Pass a body covector for each step.")
    limits = checked_limits(f"{where}(bounds=...)", bounds, k)
    refuse_many_matrices(f"{where}(controls=...)", discrete, len(table), "Pass fewer.", derivatives=dim + 2 * k)
    with needs("jax", where):
        from nonholo.analysis.steering._shooting import linearize_steps
        from nonholo.simulation.traced import rollout
    first = {"restricted_velocity": np.zeros(k), **start}
    reference = rollout(discrete, **first, controls=table, steps=len(table))
    if reference.outcome != 0:
        raise error(f"{where}(controls=...)", "give a motion to the end", "one that ends early", "Take shorter steps.")
    A, B = interruptibly(lambda: linearize_steps(discrete, _states(discrete, reference), table))
    h = float(discrete.time_step)
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


def _refuse(where: str, discrete: Discretization, start: Any) -> None:
    """Refuse maps without a linearization that is the same at every pose and time, and starts that are none."""
    as_discretization(f"{where}(discrete=...)", discrete, forced=True)
    if discrete.system.is_spatial:
        got, remedy = type(discrete.system).__name__, "Steer it by `nh.rollout`."
        raise error(f"{where}(discrete=...)", "have a left-invariant constraint", got, remedy)
    if discrete.forces is not None and discrete.forces.table is not None:
        got, remedy = "one force for each step", "Add the table to the controls."
        raise error(f"{where}(discrete=...)", "have forces that do not depend on time", got, remedy)
    check_names(f"{where}(start=...)", start)


def _states(discrete: Discretization, reference: Any) -> tuple[np.ndarray, np.ndarray]:
    """Return velocities along the constraint and poses of the nodes."""
    return discrete.system.restricted_velocity(reference.restricted_momentum), reference.configuration


def _weight(where: str, value: Any, n: int) -> Float[np.ndarray, "n n"]:
    """Return a weight as a matrix, symmetric and not negative."""
    remedy = f"Pass a number, {n} numbers, or a symmetric matrix of this size, with no negative eigenvalue."
    W = array(where, value, (n,) * min(2, len(shape_of(value))), remedy)
    W = symmetric(where, W if W.ndim == 2 else W * np.eye(n), remedy)
    if np.linalg.eigvalsh(W)[0] < -1e-13 * np.abs(W).max():
        raise error(where, "not be negative", f"an eigenvalue {np.linalg.eigvalsh(W)[0]:.6g}", remedy)
    return W
