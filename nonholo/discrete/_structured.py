"""Which discretisations have a compiled step, in which units it works, and what one step from each state gives."""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from nonholo import kernels
from nonholo._results import Outcome, OutcomeError
from nonholo._types import Array, Float
from nonholo.discrete._general import general_body
from nonholo.discrete._secular import SecularStep, is_secular, secular_step
from nonholo.groups import AbstractMatrixGroup
from nonholo.orbit import Orbit
from nonholo.systems import AbstractSystem, ChaplyginSleigh, SuslovTop

if TYPE_CHECKING:
    from nonholo.discrete._discretization import Discretization


class ScalarStep(NamedTuple):
    """The body of a scalar kernel and the factor from physical momenta to the kernel's scaled ones."""

    body: kernels.Body
    scale: Array


class MatrixStep(NamedTuple):
    """The body of the general kernel and the factor to its momenta."""

    body: kernels.GeneralBody
    scale: Array


Structured = ScalarStep | MatrixStep | SecularStep


def scalar_step(discrete: "Discretization") -> ScalarStep | None:
    """Return the step in closed form, which JAX can trace too: the top in space and the sleigh in the plane."""
    if discrete.difference != "matrix" or discrete.constraint not in ("skew", "exponential"):
        return None
    system: AbstractSystem = discrete.system.canonical
    if isinstance(system, SuslovTop) and system.group.dim == 3:
        body = kernels.suslov_body(system.constrained_inertia, system.coupling)
        return ScalarStep(body, discrete.time_step / 2)
    if isinstance(system, ChaplyginSleigh):
        numbers = (system.mass, system.inertia, system.a)
        concrete = all(isinstance(x, np.floating) for x in numbers)
        return ScalarStep(kernels.SleighBody(*map(float, numbers) if concrete else numbers), discrete.time_step)
    return None


def structured(discrete: "Discretization") -> Structured | None:
    """Return the compiled step of a discretisation, or None if only its definition can be run."""
    closed = scalar_step(discrete)
    if closed is not None or discrete.difference != "matrix":
        return closed
    return secular_step(discrete) if is_secular(discrete) else matrix_step(discrete)


def matrix_step(discrete: "Discretization") -> MatrixStep | None:
    """Return the general step of a discretisation with difference "matrix", None if its variety needs exp."""
    variety = discrete.variety
    if variety.exponential or discrete.constraint not in ("skew", "exponential"):
        return None
    body, unit = general_body(discrete.system, variety)
    return MatrixStep(body, discrete.time_step / unit)


def encoded(step: Structured, momenta: np.ndarray) -> np.ndarray:
    """Return the momenta of a kernel from canonical ones."""
    return step.encoded(momenta) if isinstance(step, SecularStep) else step.scale * momenta


def decoded(step: Structured, momenta: np.ndarray) -> np.ndarray:
    """Return canonical momenta from those of a kernel."""
    return step.decoded(momenta) if isinstance(step, SecularStep) else momenta / step.scale


def to_kernel(step: Structured, charts: np.ndarray) -> np.ndarray:
    """Return the chart coordinates of a kernel from canonical ones."""
    return step.turned(charts) if isinstance(step, SecularStep) else charts


def from_kernel(step: Structured, charts: np.ndarray) -> np.ndarray:
    """Return canonical chart coordinates from those of a kernel."""
    return step.turned_back(charts) if isinstance(step, SecularStep) else charts


def encoded_poses(step: Structured, group: AbstractMatrixGroup, poses: np.ndarray) -> np.ndarray:
    """Return the poses of a kernel, rows of matrices but for scalar kernels, from compact canonical ones."""
    if isinstance(step, ScalarStep):
        return poses
    g = group.matrix_from_pose(poses)
    g = step.posed(g) if isinstance(step, SecularStep) else g
    return g.reshape(*poses.shape[:-1], group.size**2)


def decoded_poses(step: Structured, group: AbstractMatrixGroup, poses: np.ndarray) -> np.ndarray:
    """Return compact canonical poses from those of a kernel."""
    if isinstance(step, ScalarStep):
        return poses
    g = poses.reshape(*poses.shape[:-1], group.size, group.size)
    return group.pose_from_matrix(step.posed_back(g) if isinstance(step, SecularStep) else g)


def first_root(step: Structured, system: AbstractSystem, momenta: np.ndarray) -> tuple[Outcome, np.ndarray]:
    """Return the outcome of the principal root over canonical momenta, and its canonical chart coordinates."""
    pose = encoded_poses(step, system.group, system.group.pose_from_matrix(system.frame))
    code, state = kernels.start(step.body, encoded(step, momenta), pose)
    return Outcome(code), from_kernel(step, kernels.chart_of(step.body, state))


def next_charts(discrete: "Discretization", states: Orbit) -> Float[np.ndarray, "K m"]:
    """Return the displacements that follow, one step from each state."""
    closed = structured(discrete)
    if closed is None:
        from nonholo.discrete._definition import next_charts_by_definition

        return next_charts_by_definition(discrete, states)
    charts = to_kernel(closed, states.canonical_chart)
    rows = (encoded(closed, states.reduced_momentum), charts, matrices_of(states))
    _, following, codes = kernels.step_each(closed.body, rows, charts, True)
    if codes.any():
        raise OutcomeError(Outcome(int(codes.max())), "Step after a saved state")
    return from_kernel(closed, following)


def matrices_of(states: Orbit) -> Float[np.ndarray, "K size"] | None:
    """Return poses as rows of matrix entries where the step depends on them, for right-invariant constraints."""
    if not states.system.is_spatial:
        return None
    return np.ascontiguousarray(states.configuration.reshape(len(states), states.system.group.size**2))


def reversal_defects(discrete: "Discretization", states: Orbit) -> Float[np.ndarray, "K"]:
    """Return, for each state, how far one step forward and one back (W to its inverse) miss it, relative to it.

    The map is multivalued and its principal value is not always the way back: the nearest value counts. Infinite where
    the iteration for it fails, NaN where there is no step forward.
    """
    closed = structured(discrete)
    if closed is None:
        raise ValueError("`reversal_defects` needs a compiled step. Got another. Pass difference='matrix'.")
    scaled, cayley = encoded(closed, states.reduced_momentum), to_kernel(closed, states.canonical_chart)
    poses = matrices_of(states)
    momenta, charts, ahead = kernels.step_each(closed.body, (scaled, cayley, poses), cayley, True)
    if poses is None:
        after, _, _ = kernels.step_each(closed.body, (momenta, charts, None), charts, False)
        returning = (-after, -charts, None)
    else:
        returning = (-momenta, -charts, _two_ahead(states, charts))
    back, returned, behind = kernels.step_each(closed.body, returning, -cayley, False)
    missed = np.maximum(_largest(returned + cayley) / _largest(cayley), _largest(back + momenta) / _largest(momenta))
    return np.where(ahead != 0, np.nan, np.where(behind != 0, np.inf, missed))


def _two_ahead(states: Orbit, following: np.ndarray) -> Float[np.ndarray, "K size"]:
    """Return the poses two steps after each state, from where a right-invariant constraint is run back."""
    U, V = states.motion.displaced(states.canonical_chart), states.motion.displaced(following)
    return np.ascontiguousarray((V @ U @ states.configuration).reshape(len(states), states.system.group.size**2))


def _largest(rows: np.ndarray) -> np.ndarray:
    return np.abs(rows).max(axis=1, initial=0.0)
