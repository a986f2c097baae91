r"""The continuous motion under forces, by Taylor series or by Runge-Kutta methods; the reaction of the constraint.

With E(g) the admissible body directions ($S^T$, or $\mathrm{Ad}_{g^{-1}}S^T$ of a constraint fixed in space) and
$f = -dU + f(t, g, \omega)$

$$ \dot r = S\,\mathrm{ad}^*_\omega p + E^Tf \quad\text{(left)}, \qquad \dot r = E^Tf \quad\text{(right)}, \qquad
   \dot g = g\hat\omega, \quad \omega = E(E^T\mathbb{I}E)^{-1}r. $$

Under weights and friction the equations of the series stay quadratic. A potential that is linear in the entries of the
pose acts along the constraint by $Lu$, where constant vectors F in space are seen from the body as $u = g^TF$. With a
constant c = 1

$$ r' = S\,\mathrm{ad}^*_\omega p + c\,(Lu - Cw), \qquad u' = \sum_a w_a\hat S_a^Tu, \qquad c' = 0 : $$

rates of (r, u, c) are quadratic in (w, u, c), as those of r are in w. So (r, u, c) are solved for as momenta of a free
motion are; in another unit of time all of them are divided by one number.

Rows of the constraint may yield: then phases are smooth, in each of which every contact holds or slides. A contact that
holds yields where its reaction reaches the grip, toward what the reaction opposed. One that slides comes to rest where
its slip ends. Which contacts hold then is the one solution for their accelerations.

Reference: docs/theory/forces.md, "Slipping in flows".
"""

import contextlib
import dataclasses
import functools
import operator
from collections.abc import Callable
from typing import Any, NamedTuple, cast

import numpy as np
import scipy  # its parts load on first use

from nonholo.base.calls import note_fault
from nonholo.base.checks import error, is_traced
from nonholo.base.numerics import applied
from nonholo.base.progress import late_bar
from nonholo.base.results import Outcome
from nonholo.base.types import Float
from nonholo.continuous import _series
from nonholo.continuous._series import PLANE, Covectors, Problem, Solved, States
from nonholo.kernels import Quadratic
from nonholo.orbit import Orbit, turned_near
from nonholo.systems.forces import Contacts, Forced, Mode, Widened, refuse_table

Field = Callable[[float, np.ndarray], np.ndarray]
_LOOKS = 0.25, 0.5, 0.75, 1.0  # parts of a step, at which it is seen whether a contact changes
_PHASES = 1000  # phases
_REST = 1e-9  # of the speed that a grip takes from its own slip in the whole time
_ROUNDING = 1e-12  # relative, of a grip
_FAST = 1e4  # times in which viscous friction slows a slip down


def phases(contacts: Contacts, at: slice, field: Field, start: np.ndarray, span: Any, rtol: float) -> Any:
    """Return the ends of the steps, what interpolates within them, and the outcome: too stiff after too many phases.

    Args:
        contacts: The contacts.
        at: The places of their momenta in a state.
        field: The equations without the forces of contacts.
        start: The first state.
        span: The first and the last time.
        rtol: The relative error of a step.
    """
    nodes, pieces, speed = [span[0]], [], _REST * (span[1] - span[0])
    least = np.array([min(one.grip, 1e300) * speed / np.trace(contacts.inertia[p, p]) for p, one in contacts.each])
    mode = Mode.of(contacts, np.linalg.solve(contacts.inertia, start[at]), least)
    phase = Phase(mode, at, field, start.copy()).settle(span[0])
    for _ in range(_PHASES):
        is_stiff = phase.is_stiff(span[1] - span[0])
        error, rest = max(rtol, _LEAST_IMPLICIT * is_stiff), (nodes[-1], span[1])
        own, parts, outcome = _steps(phase.derivative, phase.start, rest, error, is_stiff=is_stiff, stop=phase.stop)
        state, length = parts[-1](own[-1]) if parts else phase.start, len(set(own)) - 1
        nodes, pieces = nodes + own[1 : length + 1], pieces + parts[:length]
        if outcome != Outcome.successful or not phase.ends:
            return nodes, pieces, outcome
        phase = phase.change(own[-1], state)
    return nodes, pieces, Outcome.too_stiff


@dataclasses.dataclass(frozen=True, eq=False)
class Phase:
    """A time in which no contact changes.

    Attributes:
        mode: Which contacts hold, and where the others slide.
        at: The places of momenta of slips in a state.
        field: The equations without the forces of contacts.
        start: The first state.
        ends: Gets the contact that ends it.
    """

    mode: Mode
    at: slice
    field: Field
    start: np.ndarray
    ends: list[int] = dataclasses.field(default_factory=list)

    def is_stiff(self, span: float) -> bool:
        """Return whether a cone yields, whose way is stiff at first, or viscous friction is much faster than a span."""
        (contacts, least, rests, _), v = self.mode, self.velocities(self.start)
        slow = (contacts.sizes(v[None])[0] <= least) & [len(one.rows) > 1 for one in contacts.slips]
        fast = [one.viscous * span > _FAST * np.trace(contacts.inertia[p, p]) for p, one in contacts.each]
        return bool((~rests & (slow | fast)).any())

    def velocities(self, state: np.ndarray) -> Float[np.ndarray, "s"]:
        """Return the slip velocities of a state."""
        return np.linalg.solve(self.mode.contacts.inertia, state[self.at])

    def derivative(self, time: float, state: np.ndarray) -> np.ndarray:
        """Return the equations of motion."""
        rate = self.field(time, state)
        rate[self.at] += self.mode.forces(self.velocities(state), rate[self.at])
        return rate

    def forces(self, time: float, state: np.ndarray) -> Float[np.ndarray, "s"]:
        """Return the forces of contacts at a state."""
        return self.mode.forces(self.velocities(state), self.field(time, state)[self.at])

    def gaps(self, time: float, state: np.ndarray) -> Float[np.ndarray, "m"]:
        """Return what is left of grips that hold, and the speeds of slips that have not ended."""
        (contacts, least, rests, ways), v = self.mode, self.velocities(state)
        reactions, sizes = contacts.sizes(np.stack([self.forces(time, state), v]))
        along = [ways[p] @ v[p] if len(ways[p]) == 1 else sizes[i] - least[i] for i, (p, _) in enumerate(contacts.each)]
        return np.where(rests, [(1 + _ROUNDING) * one.grip for one in contacts.slips] - reactions, along)

    def stop(self, piece: Any) -> float:
        """Return where in a step a contact changes, or its end."""
        begin, before, own = piece.t_old, self.gaps(piece.t_old, piece(piece.t_old)), self.mode
        for time in piece.t_old + (piece.t - piece.t_old) * np.array(_LOOKS):
            now = self.gaps(time, piece(time))
            places = np.flatnonzero((now < 0) & (own.rests | (before > 0) | (now < -own.least)))
            if len(places):
                times = [self._root(piece, int(i), begin, time) if before[i] > 0 else begin for i in places]
                self.ends.append(int(places[np.argmin(times)]))
                return min(*times, float(np.nextafter(piece.t, piece.t_old)))
            begin, before = time, now
        return piece.t

    def _root(self, piece: Any, i: int, begin: float, end: float) -> float:
        tight = np.spacing(max(abs(begin), abs(end)))
        return scipy.optimize.brentq(lambda time: self.gaps(time, piece(time))[i], begin, end, xtol=tight)

    def change(self, time: float, state: np.ndarray) -> "Phase":
        """Return the phase after the contact that ends this one has changed."""
        i, rests, ways = self.ends[0], self.mode.rests.copy(), self.mode.ways.copy()
        place = self.mode.contacts.each[i][0]
        if rests[i]:
            force = self.forces(time, state)[place]
            ways[place] = -force / np.linalg.norm(force)
        rests[i] = not rests[i]
        return Phase(self.mode._replace(rests=rests, ways=ways), self.at, self.field, state).settle(time)

    def settle(self, time: float) -> "Phase":
        """Return the phase from the same state, in which some of the contacts at rest yield at once."""
        state, at = self.start, self.at
        state[at] = self.mode.contacts.stop(state[at], self.mode.rests)
        return dataclasses.replace(self, mode=self.mode.settle(self.velocities(state), self.field(time, state)[at]))


_LEAST_RTOL, _SHARE = 1e-13, 1e-3  # SciPy allows no less; absolute errors are that part of the relative ones
_LEAST_IMPLICIT = 1e-9  # relative, for some hundred steps of order 5
_FIRST, _FEW, _MOST = 1000, 10_000, 10_000_000  # steps tried before any judgment, and in total
_NOWHERE = 1e-9  # of the whole time, in `_FIRST` steps
_STABLE = 3.0  # half of h |lambda| at the bound of stability; smooth motions have less than 1
_PARTS = 1000  # of the time, for progress
_WHOLE = operator.attrgetter("t")  # the end of a step
_SLOW = 1e-9  # relative, of a slip that counts as rest
_STIFF = 2e6  # of a flow, in times in which friction slows the body down: a step of the series has about five


class LinearForces(NamedTuple):
    """Forces along the canonical rows of the constraint.

    Attributes:
        vectors: F, vectors in space.
        turns: The rates of a vector seen from the body, as a matrix for each velocity.
        levers: L.
        friction: C.
        velocities: V of w = V r.
        sizes: Units of the momenta, in which the three before are.
        fastest: The largest rate at which friction alone slows the body down.
    """

    vectors: Float[np.ndarray, "p N"]
    turns: Float[np.ndarray, "k n n"]
    levers: Float[np.ndarray, "k m"]
    friction: Float[np.ndarray, "k k"]
    velocities: Float[np.ndarray, "k k"]
    sizes: Float[np.ndarray, "k"]
    fastest: float


def _are_linear(forced: Forced) -> bool:
    """Return whether only friction and a potential linear in the pose act, and the constraint is in the body."""
    others = forced.function is not None or forced.table is not None or forced.is_spatial or bool(forced.slips)
    return not others and (forced.potential is None or hasattr(forced.potential, "levers"))


@functools.lru_cache(maxsize=16)
def _linear_forces(forced: Forced) -> LinearForces:
    """Return what acts, seen from the canonical frame."""
    group, body, rows = forced.group, forced.canonical, forced.frame_map @ np.asarray(forced.constraint_subspace)
    n = group.point_size  # levers have none for the last number of points, which is 1
    vectors, levers = np.zeros((0, group.size)), np.zeros((group.dim, 0, group.size))
    if forced.potential is not None:
        vectors, levers = forced.potential.levers(group)
        vectors, levers = vectors.reshape(-1, group.size), levers.reshape(group.dim, -1, group.size)
    body_levers = np.tensordot(rows, levers, 1) @ np.linalg.inv(forced.frame).T
    C = np.zeros((group.dim, group.dim)) if forced.friction is None else forced.friction.matrix
    V, _, sizes = _series.body_numbers(group, body.constraint_subspace, body.inertia_operator)
    turns = group.hat(body.constraint_subspace).swapaxes(-1, -2)[:, :n, :n]
    friction = rows @ C @ rows.T / sizes[:, None]
    fastest = float(np.linalg.eigvals(V @ friction).real.max(initial=0.0))
    own_levers = body_levers[..., :n].reshape(len(rows), n * len(vectors)) / sizes[:, None]
    return LinearForces(vectors, turns, own_levers, friction, V, sizes, fastest)


@functools.lru_cache(maxsize=16)
def quadratic_under(forced: Forced) -> Quadratic:
    """Return the equations of momenta, vectors seen from the body, and the constant behind the pose."""
    body, acting = forced.canonical, _linear_forces(forced)
    S, (k, m) = body.constraint_subspace, acting.levers.shape
    velocities, torques = np.eye(k + m + 1), np.zeros((k + m + 1,) * 3)
    velocities[:k, :k], torques[:k, :k, :k], _ = _series.body_numbers(body.group, S, body.inertia_operator)
    torques[-1, :k, :k], torques[-1, k:-1, :k] = -acting.friction.T, acting.levers.T
    torques[:k, k:-1, k:-1] = np.kron(np.eye(len(acting.vectors)), acting.turns).swapaxes(-1, -2)
    return _series.body_equations(body.group, S, velocities, torques, (k, m, 1))


def heads(
    forced: Forced, momenta: Float[np.ndarray, "M k"], poses: Float[np.ndarray, "M size"]
) -> tuple[Float[np.ndarray, "M K"], Float[np.ndarray, "M"]]:
    """Return momenta, vectors seen from the body and the constant at starts, divided by the unit of time, and this."""
    acting, one = _linear_forces(forced), np.ones((len(momenta), 1))
    n, sizes, momenta = acting.turns.shape[-1], acting.sizes, momenta / acting.sizes
    V = sizes[:, None] * acting.velocities
    body_vectors = (acting.vectors @ forced.group.matrix_from_pose(poses))[..., :n].reshape(len(momenta), -1)
    pull, rub = (np.abs(V @ acts).max(initial=0.0) for acts in (acting.levers, acting.friction / sizes))
    rates = np.concatenate([applied(V, momenta), np.sqrt(pull * np.abs(body_vectors)), rub * one], axis=1)
    units = _series.power_of_two(rates)
    return np.concatenate([momenta, body_vectors, one], axis=1) / units[:, None], units


def has_series_under(forced: Forced, span: float) -> bool:
    """Return whether the flow over a time is solved by series: not where friction is much faster."""
    return _are_linear(forced) and bool(abs(span) * _linear_forces(forced).fastest <= _STIFF)


def under_forces(forced: Forced, begins: float, problem: Problem) -> Solved:
    """Solve the equations of a system with forces from the time `begins` on, by series where they serve."""
    if forced.slips:
        return by_runge_kutta(forced, begins, problem)
    if not has_series_under(forced, problem.elapsed[-1]):
        return by_runge_kutta(forced, begins, problem, is_stiff=_are_linear(forced))
    (head,), (unit,) = heads(forced, problem.momentum[None], problem.pose[None])
    f, sizes = quadratic_under(forced), _linear_forces(forced).sizes
    solution = _series.solve(forced.group, f, head, float(unit), problem, _MOST, sizes)
    return solution if solution.outcome == Outcome.successful else solution._replace(outcome=Outcome.too_stiff)


def by_runge_kutta(forced: Forced, begins: float, problem: Problem, *, is_stiff: bool = False) -> Solved:
    """Solve the equations of a system with forces, from canonical momenta and pose at the time `begins`.

    By DOP853, or if they are known to be stiff by the implicit Radau; piece by piece where rows may yield.
    """
    reduced_momentum, pose, elapsed, tolerances = problem
    refuse_table("flow(system=Forced(...))", forced.table)
    group, k = forced.group, forced.rank
    r, g = forced.from_canonical(reduced_momentum), group.matrix_from_pose(pose) @ group.inverse(forced.frame)
    start = np.concatenate([r, g.ravel(), _series.first_heading(group, pose)])
    faults: dict[str, str] = {}
    field = _field(forced.sliding if forced.slips else forced, begins, k, faults)
    rtol = max(_LEAST_IMPLICIT if is_stiff else _LEAST_RTOL, tolerances[0])
    span = 0.0, float(elapsed[-1])
    if forced.slips:
        if span[1] < 0:
            remedy = "Start at the first time: a contact at rest has many pasts."
            raise error("flow(times=...)", "increase where rows of a constraint may yield", "a decrease", remedy)
        places = slice(k - len(forced.contacts.inertia), k)
        nodes, pieces, outcome = phases(forced.contacts, places, field, start, span, rtol)
    else:
        nodes, pieces, outcome = _steps(field, start, span, rtol, is_stiff=is_stiff)

    at = functools.partial(_states_at, forced, start, nodes, pieces)
    good_times = elapsed[np.abs(elapsed) <= abs(nodes[-1])]
    why = " ".join(faults.values()) if outcome == Outcome.nonfinite else ""
    return Solved(at(good_times), outcome, at, lambda: np.array(nodes[:-1]), why)


def _states_at(
    forced: Forced, start: np.ndarray, nodes: list[float], pieces: list[Any], times: Float[np.ndarray, "K"]
) -> States:
    """Return states at times, of a motion without steps the first one."""
    whole = scipy.integrate.OdeSolution(nodes, pieces)(times) if pieces else np.tile(start[:, None], len(times))
    group, rows, k, N = forced.group, whole.T, forced.rank, forced.group.size
    g = rows[:, k : k + N * N].reshape(-1, N, N)
    poses = group.normalize_pose(group.pose_from_matrix(g @ forced.frame))
    headings = turned_near(rows[:, -1], poses) if group == PLANE else None
    return States(forced.to_canonical(rows[:, :k]), poses, headings)


def _steps(
    field: Field, start: np.ndarray, span: tuple[float, float], rtol: float, *, is_stiff: bool, stop: Any = _WHOLE
) -> tuple[list[float], list[Any], Outcome]:
    """Return the ends of the steps in a span, what interpolates within them, and the outcome; they may stop earlier.

    Steps are too many where the whole time needs more than `_MOST` at the rate so far, or `_FEW` if many of them are as
    short as they are for stability alone, or follow others that were too long, as over jumps; or where the last ones
    lead nowhere, as at a jump that drives the motion back to it.
    """
    begin, end = span
    nodes, pieces, tries, vain, first = [begin], [], 0, 0, field(begin, start)
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"), late_bar("flow under forces") as report:
        if not np.isfinite(np.linalg.norm(first / (_SHARE + np.abs(start)) / rtol)):
            return nodes, pieces, Outcome.nonfinite
        if end == begin:
            return nodes, pieces, Outcome.successful
        solver = _solver(field, start, span, rtol, is_stiff=is_stiff)
        while (solver.status, nodes[-1]) == ("running", solver.t):
            before = solver.nfev
            solver.step()
            attempts = 1 if is_stiff else (solver.nfev - before) // solver.n_stages
            if solver.status == "failed":
                return nodes, pieces, _failure(solver.f if is_stiff else solver.K)
            tries, vain = tries + attempts, vain + attempts - 1 + (not is_stiff and _is_short(solver))
            pieces.append(solver.dense_output())
            nodes.append(stop(pieces[-1]))
            report(int(_PARTS * solver.t / end), _PARTS)
            share, last_share = np.abs(solver.t - np.array([begin, nodes[-_FIRST:][0]])) / abs(end - begin)
            if tries > _FIRST and _is_endless(tries, vain, share, last_share):
                return nodes, pieces, Outcome.too_stiff
    return nodes, pieces, Outcome.successful


def _solver(field: Any, start: np.ndarray, span: tuple[float, float], rtol: float, *, is_stiff: bool) -> Any:
    """Return the solver of SciPy, by the implicit Radau or by DOP853."""
    method = scipy.integrate.Radau if is_stiff else scipy.integrate.DOP853
    return method(field, span[0], start, span[1], rtol=rtol, atol=_SHARE * rtol)


def _failure(rates: np.ndarray) -> Outcome:
    """Return why a step with these last rates failed."""
    return Outcome.not_converged if np.isfinite(rates).all() else Outcome.nonfinite


def _is_endless(tries: int, vain: int, share: float, last_share: float) -> bool:
    """Return whether steps are too many, by those so far, those in vain, and the shares of the time behind."""
    return last_share < _NOWHERE or tries > share * (_FEW if vain > tries / 3 else _MOST)


def _is_short(solver: Any) -> bool:
    """Return whether a step is about as long as is stable, by two derivatives at its end, as Hairer's DOP853 does."""
    last = solver.n_stages - 1
    other = solver.y_old + solver.step_size * (solver.K[:last].T @ solver.A[last, :last])
    slope, gap = np.linalg.norm(solver.K[-1] - solver.K[last]), np.linalg.norm(solver.y - other)
    return bool(solver.step_size * slope > _STABLE * gap)


def forced_field(forced: Forced) -> Field:
    """Return the equations of motion as a function of time and states, as `vector_field` does."""
    refuse_table("vector_field(system=Forced(...))", forced.table)
    field = _field(forced, 0.0, forced.rank, None)

    def derivative(now: float, rows: np.ndarray) -> np.ndarray:
        if is_traced(rows):
            if forced.needs_function:
                demand, remedy = "be a NumPy array under forces by functions", "Call it outside jax.jit and jax.grad."
                raise error("vector_field(...)(state=...)", demand, "a traced array", remedy)
            return rows.__array_namespace__().vectorize(lambda row: field(now, row), signature="(n)->(n)")(rows)
        return np.apply_along_axis(lambda row: field(now, row), -1, rows)

    return derivative


def _field(forced: Forced, begins: float, k: int, faults: dict[str, str] | None) -> Field:
    """Return the right-hand side: momenta along the rows of the user, the pose row by row, the heading in the plane.

    Given a place to note it, what is not finite is NaN, so that the solver comes as near to it as it can.
    """
    group, inertia, N = forced.group, forced.inertia_operator, forced.group.size

    def derivative(time: float, state: np.ndarray) -> np.ndarray:
        xp = state.__array_namespace__()
        if faults is not None and not np.isfinite(state).all():
            return np.full_like(state, np.nan)
        g = state[k : k + N * N].reshape(N, N)
        E = forced.directions(g)
        velocity = E @ xp.linalg.solve(E.T @ inertia @ E, state[:k])
        force = np.full(group.dim, np.nan)
        with contextlib.nullcontext() if faults is None else note_fault(faults, "force"):
            force = forced.potential_force(g) + forced.applied_force(begins + time, g, velocity)
        if not forced.is_spatial:
            force = force + group.coad(velocity, inertia @ velocity)
        pose_rate = g @ group.hat(velocity)
        return xp.concatenate([E.T @ force, pose_rate.ravel(), velocity[: len(state) - k - N * N]])

    return derivative


def forced_reaction(forced: Forced, states: Orbit) -> Covectors:
    r"""Return the forces of constraint $\mathbb{I}\dot\omega - \mathrm{ad}^*_\omega p - f$; on LR systems in space.

    They vanish along E, which determines the acceleration.
    """
    group, inertia = forced.group, np.asarray(forced.inertia_operator)
    alone = forced.sliding if forced.slips else forced
    g, velocity = states.configuration, states.body_velocity
    acting = [alone.applied_force(*row) for row in zip(states.time, g, velocity, strict=True)]
    force = group.coad(velocity, applied(inertia, velocity)) + forced.potential_force(g)
    force = force + np.reshape(acting, velocity.shape)
    E = forced.directions(g)
    along = np.swapaxes(E, -1, -2)
    pull = force + _contact_forces(forced, velocity, force) if forced.slips else force
    acceleration = E @ np.linalg.solve(along @ inertia @ E, along @ pull[..., None])
    missing = (inertia @ acceleration)[..., 0] - force
    return forced.constraint_momentum(missing, g)


def _contact_forces(forced: Forced, velocity: Covectors, force: Covectors) -> Covectors:
    """Return the body covectors of contacts at velocities under other forces."""
    body, contacts = cast(Widened, forced.free), forced.contacts
    slips, covectors = applied(body.rows, velocity), []
    for v, free, size in zip(slips, applied(body.duals, force), np.linalg.norm(velocity, axis=1), strict=True):
        least = _SLOW * size * np.array([np.linalg.norm(one.rows) for one in forced.slips])
        covectors.append(Mode.of(contacts, v, least).settle(v, free).forces(v, free) @ body.rows)
    return np.reshape(covectors, velocity.shape)
