"""`simulate`: an orbit of the discrete map, from a checked start to a decoded result."""

from collections.abc import Callable
from typing import Any, overload

import numpy as np

from nonholo import kernels
from nonholo._checks import choice, error, step_counts
from nonholo._progress import progress_bar
from nonholo._results import Outcome, finished
from nonholo.discrete import Discretization, initial_state
from nonholo.discrete._discretization import as_discretization
from nonholo.discrete._start import check_first_state, in_group
from nonholo.discrete._structured import Structured, structured
from nonholo.orbit import Orbit
from nonholo.systems._coordinate_system import AbstractCoordinateDiscretization, OrbitT, refuse_in_coordinates

_BLOCK = 1 << 20  # steps between two reports of progress

Rows = tuple[np.ndarray, np.ndarray, np.ndarray | None]


@overload
def simulate(
    discrete: Discretization,
    *,
    steps: int,
    body_velocity: Any = None,
    restricted_velocity: Any = None,
    displacement: Any = None,
    momentum: Any = None,
    configuration: Any = None,
    save_every: int = 1,
    branch: str = "principal",
    reconstruct: bool = True,
    backend: str = "auto",
    throw: bool = True,
    progress: bool = False,
) -> Orbit: ...
@overload
def simulate(
    discrete: AbstractCoordinateDiscretization[OrbitT],
    *,
    steps: int,
    configuration: Any,
    body_velocity: Any = None,
    displacement: Any = None,
    momentum: Any = None,
    save_every: int = 1,
    throw: bool = True,
    progress: bool = False,
) -> OrbitT: ...
def simulate(
    discrete: Discretization | AbstractCoordinateDiscretization,
    *,
    steps: int,
    body_velocity: Any = None,
    restricted_velocity: Any = None,
    displacement: Any = None,
    momentum: Any = None,
    configuration: Any = None,
    save_every: int = 1,
    branch: str = "principal",
    reconstruct: bool = True,
    backend: str = "auto",
    throw: bool = True,
    progress: bool = False,
) -> Any:
    r"""Run the discrete Euler-Poincare-Suslov map.

    $$ P(W_{k+1})|_{\mathfrak{d}} = (\mathrm{Ad}^*_{W_k} P(W_k))|_{\mathfrak{d}}, \qquad g_{k+1} = g_k W_k. $$

    The map is multivalued. The principal root is the one that momentum zero reaches along s r, 0 <= s <= 1; each root
    is verified to be it, since energy cannot tell (every root conserves it).

    A discretised `LagrangeDAlembert` runs the map of its `CoordinateDiscretization.simulate`. It starts at a
    `configuration`, its q_0, and takes neither `restricted_velocity` nor `branch`, `reconstruct` and `backend`.

    Reference: [fedorov-zenkov-2004], equation (disc.momentum.eqn).

    Args:
        discrete: The discretised system.
        steps: Number of steps N; unthinned orbits have N + 1 states.
        body_velocity: Start with the principal W_0 that has the same momentum along the constraint (second order).
        restricted_velocity: The same, in rows of the constraint subspace.
        displacement: Start with this W_0, on the displacement variety and on the principal branch.
        momentum: Start with this momentum, full (on the momentum locus) or along the constraint subspace.
        configuration: First pose, a matrix of the group; the identity by default.
        save_every: Keep every so many steps.
        branch: "principal".
        reconstruct: Also compute poses.
        backend: "numba" (closed forms, compiled), "jax" (the definition), or "auto" to choose.
        throw: Raise if the run cannot go on; otherwise return the good steps and the outcome.
        progress: Show a progress bar on standard error.

    Returns:
        The orbit; of a system in coordinates a `nonholo.lagrange_dalembert.CoordinateOrbit`.

    Raises:
        ValueError: A bad argument, before any work.
        OutcomeError: The start is not on the principal branch, or, with `throw`, the run could not go on; then the
            error's `orbit` holds every good step.

    Example:
        >>> top = nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]])
        >>> orbit = nh.simulate(nh.discretize(top, 0.1), body_velocity=(0.4, 0.9, 0.0), steps=1000)
        >>> float(np.ptp(orbit.energy)) < 1e-14
        True
    """
    starts = {"body_velocity": body_velocity, "displacement": displacement, "momentum": momentum}
    if isinstance(discrete, AbstractCoordinateDiscretization):
        refuse_in_coordinates(
            "simulate",
            restricted_velocity=(restricted_velocity, None),
            branch=(branch, "principal"),
            reconstruct=(reconstruct, True),
            backend=(backend, "auto"),
        )
        options = {"save_every": save_every, "throw": throw, "progress": progress}
        return discrete.simulate(configuration=configuration, steps=steps, **starts, **options)
    as_discretization("simulate(discrete=...)", discrete)
    steps, every = step_counts(steps, save_every)
    choice("simulate(branch=...)", branch, ("principal",))
    group = discrete.system.group
    g = group.identity if configuration is None else in_group("simulate(configuration=...)", group, configuration)
    reduced, demanded = initial_state(discrete, g, **starts, restricted_velocity=restricted_velocity)
    pose = group.pose_from_matrix(g @ discrete.system.frame)
    run = _runner(discrete, backend)
    rows, outcome, done = run(reduced, pose, steps, every, progress)
    orbit = _orbit(discrete, rows, outcome, every, reconstruct)
    if demanded is not None and len(orbit):
        check_first_state(demanded, orbit[:1].displacement[0], orbit[:1].momentum[0])
    return finished(orbit, float(discrete.time_step), done, steps, throw)


def _runner(discrete: Discretization, backend: str) -> Callable[..., tuple[Rows, Outcome, int]]:
    choice("simulate(backend=...)", backend, ("auto", "numba", "jax"))
    closed = structured(discrete)
    if closed is not None and backend != "jax":
        return lambda *arguments: _run_compiled(discrete, closed, *arguments)
    if backend == "numba":
        remedy = "Pass backend='jax', or difference='matrix'."
        raise error("simulate(backend=...)", "have a closed form of the step", repr(discrete.difference), remedy)
    from nonholo.discrete._definition import run_by_definition

    return lambda *arguments: run_by_definition(discrete, *arguments)


def _run_compiled(
    discrete: Discretization,
    closed: Structured,
    reduced: np.ndarray,
    pose: np.ndarray,
    steps: int,
    every: int,
    progress: bool,
) -> tuple[Rows, Outcome, int]:
    group, general = discrete.system.group, isinstance(closed.body, kernels.GeneralBody)
    scaled, coded = closed.scale * reduced, group.matrix_from_pose(pose).ravel() if general else pose
    code, state = kernels.start(closed.body, scaled, coded)
    started = code == 0
    saved = 1 + steps // every
    momenta, charts, poses = (np.empty((saved, size)) for size in kernels.sizes(closed.body))
    momenta[0], charts[0], poses[0] = scaled, kernels.chart_of(closed.body, state), coded
    done, block = 0, max(1, _BLOCK // every) * every
    with progress_bar("steps", progress) as report:
        while code == 0 and done < steps:
            first = 1 + done // every
            chunk = min(block, steps - done)
            rows = momenta[first:], charts[first:], poses[first:]
            good, code = kernels.advance(closed.body, state, chunk, every, rows)
            done += good
            report(done, steps)
    kept = 1 + done // every if started else 0
    momenta, charts, poses = momenta[:kept] / closed.scale, charts[:kept], poses[:kept]
    if general:
        poses = group.pose_from_matrix(poses.reshape(-1, *group.identity.shape))
    return (momenta, charts, poses), Outcome(code), done


def _orbit(discrete: Discretization, rows: Rows, outcome: Outcome, every: int, reconstruct: bool) -> Orbit:
    momenta, charts, poses = rows
    time = discrete.time_step * (every * np.arange(len(momenta)))
    return Orbit(discrete, time, momenta, charts, poses if reconstruct else None, outcome, every)
