"""Whether the errors of a discretization fall with the power of the time step that they should."""

import dataclasses

import numpy as np

from nonholo.analysis import Convergence, compare
from nonholo.base.checks import count, flags, instance, positive
from nonholo.base.types import Float
from nonholo.discrete import Discretization
from nonholo.simulation import flow, refuse_many_matrices, simulate

_MANY = 1000  # halvings; more than any memory holds


def check_order(
    discrete: Discretization,
    body_velocity: Float[np.ndarray, "dim"],
    *,
    steps: int = 20,
    halvings: int = 2,
    tolerance: float = 0.2,
    throw: bool = True,
) -> Convergence:
    r"""Check that momenta and poses converge to the continuous motion with the order of a discretization.

    $$ \max_k|r_k - r(t_k)| = O(h^p), \qquad \max_k\|g_k^{-1}g(t_k) - I\| = O(h^p), \qquad p = 2, 4, 6, 8. $$

    The same motion is run with the time step, a half of it, a fourth and so on, and compared with `nh.flow`. Errors
    that are only rounding have no order and pass; take larger steps to see one. `plot()` of what is returned draws the
    errors over the time step.

    Args:
        discrete: Made by `discretize` for a system on a group, with the largest time step.
        body_velocity: The start; it satisfies the constraint.
        steps: Length of the run with the largest time step.
        halvings: How often the time step is halved.
        tolerance: How far the slopes of $\log$ error over $\log h$ may be from the order.
        throw: Raise if they are farther; otherwise only what is returned says so.

    Returns:
        The errors of all runs, with `order` and `plot`.

    Raises:
        ValueError: `discrete` is no discretization of a system on a group, or the start is refused.
        OutcomeError: A run cannot continue: take a smaller time step.
        AssertionError: With `throw`: an order that is not the one claimed.

    Example:
        >>> sleigh = nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.5)
        >>> nh.testing.check_order(nh.discretize(sleigh, 0.2), (1.0, 0.5, 0.0))
        <Convergence over 3 time steps, order: momentum 2.01, pose 2.00, energy at rounding>
    """
    where, remedy = "check_order(discrete=...)", "Pass `discretize(system, time_step)` of a system on a group."
    instance(where, discrete, Discretization, "be a discretization of a system on a group", remedy)
    number = count("check_order(steps=...)", steps, "Pass the length of the first run.")
    finer = count("check_order(halvings=...)", halvings, "Pass 1 or more.")
    allowed = float(positive("check_order(tolerance=...)", tolerance, "Pass a positive number."))
    flags("check_order", throw=throw)
    where, all_steps = "check_order(steps=..., halvings=...)", number * 2 ** (min(finer, _MANY) + 1)
    refuse_many_matrices(where, discrete, all_steps, "Pass fewer of them.")
    h = float(discrete.time_step)
    exact = flow(discrete.system, body_velocity=body_velocity, times=(0.0, number * h))
    made = [dataclasses.replace(discrete, time_step=h / 2**k) for k in range(finer + 1)]
    runs = [simulate(each, body_velocity=body_velocity, steps=number * 2**k) for k, each in enumerate(made)]
    found = compare(runs, exact)
    missed = [slope for slope in (found.order.momentum, found.order.pose) if abs(slope - discrete.order) > allowed]
    if throw and missed:
        raise AssertionError(f"`check_order(...)` must find order {discrete.order} +- {allowed:g}. Got {found}.")
    return found
