"""`flow`: an orbit of the continuous equations, from a checked start to a decoded result."""

import importlib
from typing import Any, NamedTuple, overload

import numpy as np

from nonholo.base.checks import error, flags, flow_times, flow_tolerances, within_memory
from nonholo.base.progress import telling
from nonholo.base.results import conclude_flow
from nonholo.continuous import ContinuousFlow, Problem, Solver, solver_of
from nonholo.orbit import First, Orbit
from nonholo.simulation._contact import BodyFlights, flow_through_impacts
from nonholo.simulation._crossings import check_resets, flow_with_events, refuse_resets
from nonholo.simulation._event import checked_events, has_resets
from nonholo.simulation._options import FEW
from nonholo.simulation._search import Events, values_of
from nonholo.systems import AbstractCoordinateSystem, OrbitT, Start, System, as_system, refuse_in_coordinates

_TOLERANCE = 1e-9  # relative, for momenta that a user computed in floating point


@overload
def flow(
    system: System,
    *,
    times: Any,
    body_velocity: Any = None,
    restricted_velocity: Any = None,
    momentum: Any = None,
    configuration: Any = None,
    project: bool = False,
    rtol: float | None = None,
    atol: float = 1e-12,
    method: str | None = None,
    reconstruct: bool = True,
    events: Any = None,
    progress: bool = False,
) -> Orbit: ...
@overload
def flow(
    system: AbstractCoordinateSystem[Any, OrbitT],
    *,
    times: Any,
    configuration: Any = None,
    body_velocity: Any = None,
    momentum: Any = None,
    project: bool = False,
    rtol: float | None = None,
    atol: float = 1e-12,
    events: Any = None,
    progress: bool = False,
) -> OrbitT: ...
def flow(
    system: System | AbstractCoordinateSystem,
    *,
    times: Any,
    body_velocity: Any = None,
    restricted_velocity: Any = None,
    momentum: Any = None,
    configuration: Any = None,
    project: bool = False,
    rtol: float | None = None,
    atol: float = 1e-12,
    method: str | None = None,
    reconstruct: bool = True,
    events: Any = None,
    progress: bool = False,
) -> Any:
    r"""Solve the Euler-Poincare-Suslov equations.

    $$ p' = \mathrm{ad}^*_\omega p + \sum_j \lambda_j a^j, \qquad \langle a^j, \omega\rangle = 0, \qquad
       g' = g\,\hat\omega, \qquad p = \mathbb{I}\omega. $$

    The default is a Taylor series, because the equations are quadratic in velocity and pose. Steps do not depend on the
    requested times, where the series are evaluated, and are exact to rounding unless `rtol` allows more. With
    "closed_form" the momentum along the constraint is
    $r_\perp\,\mathrm{sech}\,s + r_\parallel\tanh s$, $s = s_0 + \nu t$, exact.
    Heading and path of the sleigh are exact too (a hypergeometric function); the pose of the top is a quadrature.

    For a `Forced` system the force -dU + f is added to ad*. With `Gravity` and `Friction`, and a constraint fixed in
    the body, the series solve it too; if friction is much faster than the motion, Radau of SciPy does, with `rtol` of
    1e-9 and more. Other forces are integrated by DOP853, with `rtol` of 1e-13 and more. `Orbit.at` works with these
    two solvers too. Rows that may yield (`Slip`) hold or slide in phases, whose ends are located.

    `LagrangeDAlembert` documents its equations. Such a flow starts at a `configuration`, and takes neither
    `restricted_velocity` nor `method`. The acceleration comes from the constraint differentiated once, a holonomic one
    twice; velocities and places are projected to the constraints, orthogonally in the kinetic energy, at each requested
    time. Smooth formulas have Taylor series too; with kinks, as an absolute value has, diffrax solves them.

    References: [fedorov-zenkov-2004], sections 2, 4 and 5; [jorba-zou-2005] for order and step of the series.

    Args:
        system: The system.
        times: The times of the states, at least one, increasing or decreasing; the start is at the first.
        body_velocity: Start with this velocity, which must satisfy the constraint.
        restricted_velocity: The same, in rows of the constraint subspace.
        momentum: Start with this momentum, full or along the constraint subspace.
        configuration: First pose, a matrix of the group; the identity by default.
        project: Start at the admissible configuration and `body_velocity` closest to these in the kinetic energy.
        rtol: Relative error of a step, at least 1e-14, which is the default; with "diffrax" 1e-10.
        atol: Absolute error of a step with "diffrax". Smaller components are not resolved there: a solution that starts
            so near a repelling equilibrium leaves it at the wrong time.
        method: None for the solver described above. Without forces also "closed_form", or "diffrax" (numerical, needs
            the extra `jax`).
        reconstruct: Also keep poses. Without them momenta of tops and sleighs cost O(n) operations a Taylor
            coefficient, and nothing of size n x n is made.
        events: `Event`s, or functions of an orbit, whose changes of sign from one requested time or step of the series
            to the next are found, and located on the solution; see `Orbit.events`. Two of them between two such times
            are not seen: ask for more times. A stopping event ends the orbit with the last requested time before it.
            One with a `reset` changes the motion: the flow begins again at each `Impact`.
        progress: Show the time on standard error.

    Returns:
        The orbit. It has no displacements, and its multipliers are the forces at its times. Of a system in coordinates
        it is a `nonholo.lagrange_dalembert.CoordinateOrbit`.

    Raises:
        ValueError: A bad argument, before any work.
        OutcomeError: The solver could not meet the tolerances, or would need too many steps under forces (`too_stiff`);
            its `orbit` holds every good state.

    Example:
        The sleigh ends up gliding straight ahead, turned by pi sqrt(1 + J/(m a^2)) in total:

        >>> sleigh = nh.ChaplyginSleigh(mass=1.0, inertia=0.75, a=0.5)
        >>> orbit = nh.flow(sleigh, body_velocity=(1e-9, -2.0, 0.0), times=(0.0, 400.0), method="closed_form")
        >>> print(orbit.body_velocity[:, 1].round(6), (np.ptp(orbit.heading) / np.pi).round(6))
        [-2.  2.] 2.0
    """
    flags("flow", project=project, reconstruct=reconstruct, progress=progress)
    starts = {"body_velocity": body_velocity, "momentum": momentum}
    if isinstance(system, AbstractCoordinateSystem):
        others = {"restricted_velocity": (restricted_velocity, None), "method": (method, None)}
        refuse_in_coordinates("flow", **others, reconstruct=(reconstruct, True))
        errors = {"rtol": rtol, "atol": atol, "project": project}
        with telling("time", progress):
            return _flow_in_coordinates(system, events, configuration=configuration, times=times, **starts, **errors)
    as_system("flow(system=...)", system)
    time = flow_times(times)
    solver, with_poses = solver_of(system, method, float(time[0]), reconstruct=reconstruct)
    tolerances = flow_tolerances((1e-10 if method == "diffrax" else 1e-14) if rtol is None else rtol, atol)
    task = _Task(system, time, tolerances, reconstruct)
    start = Start.of("flow", configuration, project=project, restricted_velocity=restricted_velocity, **starts)
    first = _first_state(task, start, with_poses)
    by_name = None if events is None else checked_events("flow", events)
    with telling("time", progress):
        if by_name is not None and has_resets(by_name):
            if not task.reconstruct:
                refuse_resets("flow", by_name, "impacts of a flow without poses: reconstruct=False")
            flights = BodyFlights(system, method, tolerances)
            return _successful(task, *_flow_between_walls(task.opening(first), time, flights, by_name))
        return _successful(task, *_solve_flow(task, solver, first, by_name))


def _flow_in_coordinates(system: AbstractCoordinateSystem, events: Any, **how: Any) -> Any:
    """Return the flow of a system in coordinates, with what events found."""
    room = importlib.import_module("nonholo.lagrange_dalembert")
    if events is None:
        return room.flow(system, **how)
    by_name = checked_events("flow", events)
    flights, time, opening = room.flights(system, **how)
    if has_resets(by_name):
        orbit, _ = _flow_between_walls(opening, time, flights, by_name)
    else:
        flow = flights.solve(opening, time)
        orbit = flow_with_events(by_name, flow, flow.solution.looks())
    return flights.successful(orbit, time)


class _Task(NamedTuple):
    """The equations of a system at times, and whether with poses."""

    system: System
    time: np.ndarray
    tolerances: tuple[float, float]
    reconstruct: bool

    def opening(self, first: tuple[Any, Any]) -> Orbit:
        """Return the first state alone."""
        reduced, pose = first[0][None], None if first[1] is None else first[1][None]
        return Orbit(ContinuousFlow(self.system), self.time[:1], reduced, None, pose)


def _first_state(task: _Task, start: Start, with_poses: bool) -> tuple[np.ndarray, np.ndarray | None]:
    """Return the momentum at the first time, which belongs to an admissible velocity, and the pose if it is needed."""
    if (numbers := len(task.time) * (task.system.rank + with_poses * task.system.group.pose_size)) > FEW:
        remedy = "Ask for fewer times, or for momenta alone: reconstruct=False without a method."
        within_memory("flow(times=...)", 32.0 * numbers, remedy)
    first = ContinuousFlow(task.system).first(start, with_poses=with_poses)
    reduced, pose = first.numbers[0], first.numbers[1] if with_poses else None
    if first.demand is not None:
        nearest = task.opening((reduced, pose)).momentum[0]
        if (distance := np.linalg.norm(first.demand - nearest)) > _TOLERANCE * np.linalg.norm(nearest):
            remedy = f"With the same components along the constraint it is {nearest.tolist()}."
            raise error("flow(momentum=...)", "belong to an admissible velocity", f"a distance {distance:.3g}", remedy)
    return reduced, pose


def flow_from(system: System, first: First, time: np.ndarray, rtol: float, *, reconstruct: bool) -> Orbit:
    """Return the flow from a checked start as far as it gets, with a pose where one is solved for, by the default."""
    solver, with_poses = solver_of(system, None, float(time[0]), reconstruct=reconstruct)
    task = _Task(system, time, (rtol, 1.0), reconstruct)
    return _solve_flow(task, solver, (first.numbers[0], first.numbers[1] if with_poses else None), None)[0]


def _solve_flow(task: _Task, solver: Solver, first: tuple[Any, Any], events: Events | None) -> tuple[Orbit, str]:
    """Return the orbit from a first state, with what events found, and what a function said that ended it."""
    time, reconstruct = task.time, task.reconstruct
    if events is not None:
        values_of(events, task.opening(first if reconstruct else (first[0], None)))  # refused where there is none
    solution = solver(Problem(*first, time - time[0], task.tolerances))
    states = solution.states
    if not reconstruct:  # nor is the memory kept, of which the momenta are a part
        states = states._replace(momenta=states.momenta.copy(), poses=None, turned=None)
    time = time[: len(states.momenta)]
    motion, rows = ContinuousFlow(task.system, (time[0], time[-1]), solution.at), (states.momenta, None, states.poses)
    orbit = Orbit(motion, time, *rows, solution.outcome, turned=states.turned).on_group()
    if events is not None:
        orbit = flow_with_events(events, orbit, time[0] + solution.steps())
    return orbit, solution.fault


def _flow_between_walls(opening: Any, time: np.ndarray, flights: Any, events: Events) -> tuple[Any, str]:
    """Return the orbit from a first state, with impacts, and what a function said that ended it."""
    if time[-1] < time[0]:
        refuse_resets("flow", events, "impacts of a flow back in time, which has other impacts")
    values_of(events, opening)
    check_resets(events, opening)
    return flow_through_impacts(opening, time, flights, events)


def _successful(task: _Task, orbit: Orbit, message: str) -> Orbit:
    """Return a flow, or raise if it ended early."""
    forces = task.system.forces
    acting = "" if forces is None else f" under {forces.names}"
    return conclude_flow(orbit, task.time, task.tolerances, acting, message)
