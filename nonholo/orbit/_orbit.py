r"""Orbits store compact states in the canonical body frame of their system; matrices are computed on access.

A state is the momentum along the constraint subspace (spatial momentum for a right-invariant constraint), for a
discrete orbit the chart coordinates of the displacement, and the compact pose. `AbstractMotion` is what a
discretization or a flow must know to decode them.
"""

import abc
import dataclasses
import functools
import importlib
from typing import Any, ClassVar, cast

import numpy as np

from nonholo.base.checks import error, instance, shown
from nonholo.base.memo import Keeper, memo
from nonholo.base.numerics import applied
from nonholo.base.results import Outcome
from nonholo.base.types import Float, Int
from nonholo.groups import SE, AbstractMatrixGroup
from nonholo.orbit._base import AbstractOrbit
from nonholo.orbit._decoder import Decoder, decoder_of, poses, turned_near, unwrap
from nonholo.orbit._stepper import First
from nonholo.systems import System

STATES = ("time", "reduced_momentum", "cayley", "canonical_pose", "turned")
"""The arrays of an orbit as stores keep them, a row for each state; `step` follows from their place."""

_ROWS = ("step", *STATES)


def as_orbit(where: str, value: Any, coordinates: str) -> "Orbit":
    """Refuse what is not an orbit on a group; `coordinates` is the remedy for an orbit in coordinates."""
    remedy = f"Pass what `simulate` or `flow` returned; {coordinates}"
    return instance(where, value, Orbit, "be an orbit of a system on a group", remedy)


def any_orbit(where: str, value: Any) -> AbstractOrbit:
    """Refuse what is not an orbit, on a group or in coordinates."""
    return instance(where, value, AbstractOrbit, "be an orbit", "Pass what `simulate` or `flow` returned.")


def step_poses(states: Any) -> Float[np.ndarray, "K N N"]:
    """Return the poses of states where the constraint needs them; else the identity: steps are the same from each."""
    eye, g = states.system.group.identity, states.system.constraint_poses(states)
    return np.broadcast_to(eye, (len(states), *eye.shape)) if g is None else g


class AbstractMotion(Keeper, abc.ABC):
    """A rule of motion of a system: a discretization or the continuous flow.

    Attributes:
        system: The system.
        span: The first and the last time between which `at` knows all states; None if saved states are all there is.
        is_balanced: Whether forces act by equal half impulses at the displacement, so that T + U and every balance is
            exact.
        is_measured: Whether poses were given, and everything else follows from them.
        conserves_energy: Whether a discrete map conserves the energy exactly; None for a flow, which does up to its
            solver.
        route_name: How stores call the way in which steps are computed; None for a flow.
        columns: The arrays of its orbits, as stores keep them.
    """

    system: System
    span: tuple[float, float] | None = None
    is_balanced: bool = False
    is_measured: bool = False
    conserves_energy: bool | None = None
    route_name: str | None = None
    columns: ClassVar[tuple[str, ...]] = STATES

    @functools.cached_property
    def decoder(self) -> Decoder:
        """The decoder of the momenta and poses of its orbits."""
        return decoder_of(self.system)

    @functools.cached_property
    def forces(self) -> Any:
        """The system with its forces; None of a free one."""
        return self.system.forces

    def orbit(self, **rows: Any) -> "Orbit":
        """Return the orbit of rows of its columns, and what else an orbit has."""
        return Orbit(self, **rows)

    def at(self, states: "Orbit", times: Any) -> "Orbit":
        """Return the states at any times in between, where they are known."""
        got = f"a discrete orbit of {len(states)} states, and times {shown(times)}"
        raise error("Orbit.at(...)", "be called on a flow", got, "Slice the orbit, or run with another time step.")

    def work(self, states: "Orbit", forced: Any) -> Float[np.ndarray, "K"]:
        """Return the work of a force along states since the first, by the trapezoidal rule."""
        return forced.work(states.time, states.configuration, states.body_velocity, states.step)

    def after_parts(self, states: Any, fractions: Float[np.ndarray, "K"]) -> Any:
        """Return what is reached from states after parts of the steps that begin there; refused where none do."""
        del fractions
        got = f"{len(states)} states of a motion that is no map"
        raise error("Orbit.work", "have all states of the run", got, "Take all states.")

    @abc.abstractmethod
    def full_momentum(self, states: "Orbit") -> Float[np.ndarray, "K dim"]:
        """Return body momenta in the user's body frame."""

    @abc.abstractmethod
    def multipliers(self, states: "Orbit") -> Float[np.ndarray, "L s"]:
        """Return the multipliers that belong to the states."""

    @abc.abstractmethod
    def constraint_residual(self, states: "Orbit") -> Float[np.ndarray, "K j"]:
        """Return what the constraint wants to be zero."""

    def displacements(self, states: "Orbit") -> Float[np.ndarray, "K N N"]:
        """Return the displacements of whole steps from the states, in the user's frame; spatial ones of LR systems."""
        return self.displaced(states.canonical_chart)

    def displaced(self, cayley: Float[np.ndarray, "... m"]) -> Float[np.ndarray, "... N N"]:
        """Return the elements of the displacement variety, in the user's frame, with canonical chart coordinates.

        Refused by default: a continuous motion has no displacements.
        """
        got = f"chart coordinates {cayley} of a continuous flow"
        raise ValueError(f"`Orbit.displacement` needs a discrete orbit. Got {got}. Use `simulate`.")


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class Orbit(AbstractOrbit):
    r"""A motion at K saved states, from `simulate` or `flow`.

    Its quantities are in the user's body frame, momenta in physical units, and computed once: its arrays are
    read-only. The compact states that it is made of are in the canonical frame of the system, where this is noted. In a
    discrete orbit $W_k = g_k^{-1} g_{k+1}$ is the displacement and $P_k$ the momentum at $W_k$; with `save_every` > 1
    displacements and multipliers are those of the single steps at the saved k. In a step with impacts the displacement
    and the momentum are those of the step that there would be without a wall. Of a composition (order > 2) the
    momentum is that at the first substep, the displacement that of the whole step.

    Attributes:
        motion: The discretization or flow that made it.
        time: Times of the saved states, shape (K,).
        reduced_momentum: Compact momenta, canonical frame, shape (K, k).
        cayley: Chart coordinates of the displacements, canonical frame, shape (K, m), m = k where the constraint is
            built into the chart; None for a flow.
        canonical_pose: Compact poses, canonical frame, shape (K, size); None if not reconstructed.
        outcome: How the run ended.
        save_every: Steps between saved states.
        turned: Heading without ambiguity of full turns, where the run knows it, shape (K,).
        branch: The branch rule of a discrete run; "callable" for a function.
        events: Crossings of `events=`, an `EventLog`: by name or position `Crossings` with their times and
            states. None without `events=`. It stays whole in slices of the orbit. `save_orbit` does not
            keep it; the store of a run does.
        step: The number of the step of each state, counted from 0 at the start of the run, for all rows, shape (K,); of
            a state within a step the number of its beginning. Of a flow it is the number of the requested time, of
            given poses that of the row.

    Example:
        >>> sleigh = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1)
        >>> orbit = nh.simulate(sleigh, body_velocity=(1, 0, 0), steps=3)
        >>> orbit.configuration.shape, orbit.multipliers.shape, str(orbit.outcome)
        ((4, 3, 3), (3, 1), 'successful')
        >>> orbit[1::2].step
        array([1, 3])
    """

    motion: AbstractMotion
    time: Float[np.ndarray, "K"]
    reduced_momentum: Float[np.ndarray, "K k"]
    cayley: Float[np.ndarray, "K m"] | None
    canonical_pose: Float[np.ndarray, "K size"] | None
    outcome: Outcome = Outcome.successful
    save_every: int = 1
    turned: Float[np.ndarray, "K"] | None = None
    branch: str = "principal"
    events: Any = None
    step: Int[np.ndarray, "K"] = dataclasses.field(default_factory=lambda: cast(Any, None))  # none of the class
    is_compact: ClassVar[bool] = True
    momenta: ClassVar[tuple[str, ...]] = ("reduced_momentum",)

    @staticmethod
    def from_poses(system: System, time: Any, configuration: Any) -> "Orbit":
        r"""Return the orbit of given poses, of a camera or another integrator: it has pictures, invariants and tables.

        With $W_k = g_k^{-1}g_{k+1}$ and $h_k = t_{k+1} - t_k$ the momentum of a state is the discrete momentum at
        $W_k$ over $h_k$; the displacement of the last state leads back. Momenta along the constraint, and with them
        `body_velocity` and `energy`, are means of the discrete momenta before and after each pose: of second order
        under all forces (at both ends of first order, unless there are none). Of a free orbit of `simulate` they
        are its own. Noise of size e in the poses is noise of size e/h in velocities: nothing is smoothed. The
        `constraint_residual` of `nh.invariants`, a velocity, measures whether the poses are admissible.

        Args:
            system: The system.
            time: Times of the poses, strictly increasing, in steps of any length.
            configuration: The poses, matrices (K, N, N) of the group. Small errors, up to the digits of single
                precision, are removed: the nearest element of the group is taken.

        Raises:
            ValueError: No system on a group, fewer than two rows, times that do not increase, a matrix that is far
                from the group (the message names its row).

        Warns:
            AliasingWarning: From one row to the next it turns by more than 90 degrees: velocities are those of the
                shorter turn, which a body that turns fast did not take.

        Example:
            >>> t = np.linspace(0.0, 6.0, 61)
            >>> g = nh.SE(2).exp(np.stack([0.5 * t, t, 0 * t], axis=1))  # a circle, its tangent along the blade
            >>> orbit = nh.Orbit.from_poses(nh.ChaplyginSleigh(1.0, 1.0, 0.5), t, g)
            >>> orbit.body_velocity[30].round(3), bool(nh.invariants(orbit).constraint_residual < 1e-13)
            (array([0.5, 1. , 0. ]), True)
        """
        return importlib.import_module("nonholo.discrete").orbit_of_poses(system, time, configuration)

    def __repr__(self) -> str:
        span = f", time {self.time[0]:g} to {self.time[-1]:g}" if len(self) else ""
        return f"<Orbit of {type(self.system).__name__}: {len(self)} states{span}, {self.outcome}>"

    def rows(self) -> dict[str, np.ndarray]:
        """Return the arrays with a row for each state."""
        return {name: rows for name in _ROWS if (rows := getattr(self, name)) is not None}

    def with_headings(self, before: float | None) -> "Orbit":
        """Return states of the plane with headings that continue from the given one; others as they are."""
        pose = self.canonical_pose
        if self.space != SE(2) or pose is None or self.turned is not None or not len(self):
            return self
        return dataclasses.replace(self, turned=unwrap(pose, before=before))

    def as_start(self) -> First:
        """Return the momentum and the pose of the first state."""
        return First((self.reduced_momentum[0], cast(Any, self.canonical_pose)[0]))

    def beside(self, offsets: Float[np.ndarray, "K dim"]) -> "Orbit":
        """Return the states at poses beside theirs, by body directions."""
        pose = self.group.pose_from_matrix(self.configuration @ self.group.exp(offsets) @ self.system.frame)
        headings = None if self.turned is None else turned_near(self.turned, pose)
        return dataclasses.replace(self, canonical_pose=pose, turned=headings)

    def with_step(self, ahead: "Orbit", outcome: Outcome) -> "Orbit":
        """Return one state with the displacement of the step of a run that began there; NaN if that failed."""
        chart = ahead.canonical_chart
        return dataclasses.replace(self, cayley=chart if outcome == Outcome.successful else np.full_like(chart, np.nan))

    def push(self, normal: Float[np.ndarray, "dim"], change: float) -> "Orbit":
        """Return one state after the impulse along a covector, that of a gap, which changes the rate of the gap."""
        nu, answer = self._answer_to(normal)
        impulse = self.system.to_canonical(change / (answer @ nu) * nu)
        return dataclasses.replace(self, reduced_momentum=self.after_impulse(self.reduced_momentum, impulse))

    def rate_along(self, normal: Float[np.ndarray, "dim"]) -> float:
        """Return the rate of a gap in the first state, whose derivative is a covector; zero if it is rounding."""
        return self.sum_of_rates(self._answer_to(normal)[1] * self.restricted_momentum[0])

    def _answer_to(self, normal: Float[np.ndarray, "dim"]) -> tuple[np.ndarray, np.ndarray]:
        """Return a covector along the constraint, and the velocity of this momentum."""
        nu = self.system.restrict_at(normal, self.configuration[0])
        return nu, self.system.restricted_velocity(nu, self.configuration[0])

    def at(self, times: Any) -> "Orbit":
        """Return the states of a flow at any of its times, from its Taylor series or closed form, without a new run.

        Args:
            times: One or many, in any order, between the first and the last time of the flow.

        Returns:
            An orbit with these times. Its numbers are those that `flow` returns at these times.

        Raises:
            ValueError: Times outside, a discrete orbit, or a flow from a file, whose states alone are known.

        Example:
            >>> sleigh = nh.ChaplyginSleigh(mass=1.0, inertia=0.75, a=0.5)
            >>> orbit = nh.flow(sleigh, body_velocity=(1.0, 0.5, 0.0), times=(0.0, 10.0))
            >>> orbit.at(3.7).position.round(6)
            array([[0.746477, 2.997487]])
        """
        return self.motion.at(self, times)

    @property
    def system(self) -> System:
        """The system that moves."""
        return self.motion.system

    @property
    def group(self) -> AbstractMatrixGroup:  # type: ignore[override]
        """The group."""
        return self.system.group

    @property
    def time_step(self) -> float | None:
        """The time step of a discrete orbit; None for a flow."""
        step = getattr(self.motion, "time_step", None)
        return None if step is None else float(step)

    @property
    def span(self) -> tuple[float, float] | None:
        """The first and the last time between which `at` knows all states; None if saved states are all there is."""
        return self.motion.span

    @property
    def is_discrete(self) -> bool:
        """Whether it has displacements: a flow has none."""
        return self.cayley is not None

    @property
    def is_measured(self) -> bool:
        """Whether poses were given, and everything else follows from them."""
        return self.motion.is_measured

    @property
    def conserves_energy(self) -> bool | None:
        """Whether the map conserves the energy exactly; None for a flow and for given poses."""
        return self.motion.conserves_energy

    @property
    def has_poses(self) -> bool:
        """Whether poses were reconstructed."""
        return self.canonical_pose is not None

    @memo
    def restricted_momentum(self) -> Float[np.ndarray, "K k"]:
        """Momenta along the rows of the constraint subspace; spatial ones for a right-invariant constraint."""
        return self.system.from_canonical(self.reduced_momentum)

    @property
    def canonical_chart(self) -> Float[np.ndarray, "K m"]:
        """Coordinates of the displacements in the canonical frame, those that steps work with.

        Of a composition (order > 2) they are those of the first substep, here and in `chart`.
        """
        if self.cayley is None:
            raise ValueError("`Orbit.displacement` needs a discrete orbit. Got a continuous flow. Use `simulate`.")
        return self.cayley

    @memo
    def chart(self) -> Float[np.ndarray, "K k"]:
        """Coordinates of the displacements in rows S of the constraint subspace.

        Where a retraction of the subspace covers the variety (Cayley on SO(n), SE(n) and groups with a form, else exp)
        they are the y of W = retract(2 y S); otherwise the coordinates of (W - W^-1)/2.
        """
        y, system = self.canonical_chart, self.system
        if y.shape[1] == system.rank:
            return y if system.canonical is system else applied(system.frame_map.T, y)
        D = self.motion.displaced(y)
        back = np.linalg.pinv(system.constraint_subspace)
        return applied(back.T, system.group.vee((D - system.group.inverse(D)) / 2))

    @memo
    def momentum(self) -> Float[np.ndarray, "K dim"]:
        """Body momenta."""
        return self.motion.full_momentum(self)

    @memo
    def multipliers(self) -> Float[np.ndarray, "L s"]:
        """Impulses of a discrete orbit, (K - 1, s), or forces at the times of a flow, (K, s).

        Row j is the impulse at the end of the step from state j; divided by the time step it is the continuous force at
        state j + 1 to second order. In steps with impacts it is NaN.
        """
        rows = self.motion.multipliers(self)
        if not self.is_discrete or not self.has_impacts.any():
            return rows
        return np.where(self.has_impacts[:-1, None], np.nan, rows)

    @memo
    def displacement(self) -> Float[np.ndarray, "K N N"]:
        """Displacements W_k = g_k^-1 g_(k+1) of single steps at the saved states."""
        return self.system.in_body(self.motion.displacements(self), self.system.constraint_poses(self))

    @memo
    def spatial_displacement(self) -> Float[np.ndarray, "K N N"]:
        """Displacements U_k = g_(k+1) g_k^-1 seen from space; on the variety for a right-invariant constraint."""
        D = self.motion.displacements(self)
        if self.system.is_spatial:
            return D
        g = self.configuration
        return g @ D @ self.system.group.inverse(g)

    @memo
    def pose(self) -> Float[np.ndarray, "K size"] | None:
        """Compact poses of the group in the user's body frame; None if not reconstructed.

        A quaternion and its opposite are one pose; signs need not continue from row to row, as those of `to_dataset`
        do.
        """
        return None if self.canonical_pose is None else poses(self.system, self.canonical_pose)

    @memo
    def configuration(self) -> Float[np.ndarray, "K N N"]:
        """Poses as matrices."""
        self._pose_rows()
        return self.motion.decoder.configuration(self)

    @memo
    def body_velocity(self) -> Float[np.ndarray, "K dim"]:
        """Admissible body velocities whose momenta along the constraint are those of the states."""
        return self.motion.decoder.body_velocity(self)

    @memo
    def spatial_momentum(self) -> Float[np.ndarray, "K dim"]:
        """Momenta carried to space, the plain transpose of Ad at the inverse pose."""
        group = self.system.group
        return group.coadjoint(group.inverse(self.configuration), self.momentum)

    @memo
    def position(self) -> Float[np.ndarray, "K n"]:
        """Translation parts of the poses; for groups of motions."""
        group = self.system.group
        if not group.is_affine:
            raise ValueError(f"`Orbit.position` needs a group of motions. Got {group}. Use configuration.")
        self._pose_rows()
        return self.motion.decoder.position(self)

    @memo
    def heading(self) -> Float[np.ndarray, "K"]:
        """Unwrapped angle of the body on SE(2); between saved states the shorter turn is assumed unless it is known."""
        if self.turned is not None:
            return self.turned
        pose = self._pose_rows()
        if self.system.group != SE(2):
            raise ValueError(f"`Orbit.heading` needs motions of the plane. Got {self.system.group}.")
        return unwrap(pose)

    @memo
    def energy(self) -> Float[np.ndarray, "K"]:
        """Reduced constrained energy; with the potential energy under forces, that of the nodes."""
        forced = self.system.forces
        potential = None if forced is None or forced.potential is None else forced.potential_energy(self.configuration)
        kinetic = self.motion.decoder.kinetic_energy(self)
        return kinetic if potential is None else kinetic + potential

    @memo
    def work(self) -> Float[np.ndarray, "K"]:
        r"""Work of the force on the motion since the first state; zero without one.

        Of friction it is minus the dissipated energy. Of steps of order 2 under the scheme "energy" it is the sum of
        $\langle f_k, X_k\rangle$, and the energy less this work is constant to rounding. Of other motions, and between
        states with some left out, it is that of the trapezoidal rule, and the energy less this work is constant up to
        an error of order 2 in the time between states. Under a table it is that of every step, also of those between
        the states.

        Raises:
            ValueError: Poses that are not reconstructed; under a table given poses with some left out, or states that
                are not at steps of one run, in their order.
        """
        return self._work_of(self.system.forces)

    @memo
    def dissipation(self) -> Float[np.ndarray, "K"]:
        r"""Energy that `Friction` and `Slip` have taken since the first state; it never falls, but by rounding.

        It is as exact as `work`, and `work + dissipation` is the work of the other forces: of motors. Friction that is
        part of a function counts as a motor. Under the scheme "energy" a step of order 2 takes
        $\langle CX, X\rangle/h$, and by slips what Theorem 18.4 says (docs/theory/forces.md).

        Raises:
            ValueError: As `work`.

        Example:
            A cart with a motor and friction:

            >>> force = nh.Friction([0.0, 0.5, 0.0]), np.tile([0.0, 2.0, 0.0], (40, 1))
            >>> cart = nh.discretize(nh.Forced(nh.ChaplyginSleigh(1.0, 1.0, 0.0), force=force), 0.1)
            >>> orbit = nh.simulate(cart, body_velocity=(0.0, 0.0, 0.0), steps=40)
            >>> float((orbit.work + orbit.dissipation)[-1].round(6)), float(2 * orbit.position[-1, 0].round(6))
            (18.164462, 18.164462)
        """
        forced = self.system.forces
        return 0.0 - self._work_of(None if forced is None else forced.resistance)

    def _work_of(self, forced: Any) -> Float[np.ndarray, "K"]:
        """Return the work of the forces of a system that moves as this one."""
        if forced is None or forced.force is None:
            return np.zeros(len(self))
        if self.lacks_forces:
            return self.with_every_step()._work_of(forced)[self.step - self.step[0]]
        return self.motion.work(self, forced)

    @property
    def lacks_forces(self) -> bool:
        """Whether forces of steps between the states are needed: those of a table, or of slips."""
        forced = self.system.forces
        return forced is not None and (forced.table is not None or bool(forced.slips)) and not self.has_every_step

    @memo
    def tangent(self) -> Float[np.ndarray, "L k k"]:
        """Derivatives of restricted momenta after each step of an orbit by those before it, (K - 1, k, k).

        `nonholo.analysis.tangent` has the method, and the case in which poses count too; `lyapunov_exponents`
        multiplies them.
        """
        return importlib.import_module("nonholo.analysis").tangent(self)

    def to_dataset(self, *, decoded: bool = False) -> Any:
        """Return the orbit as a labeled `xarray.Dataset`, in the user's body frame.

        `nonholo.io.orbit_to_dataset` names its variables; with `decoded` there are matrices and multipliers too.
        """
        return importlib.import_module("nonholo.io").orbit_to_dataset(self, decoded=decoded)

    def _pose_rows(self) -> np.ndarray:
        if self.canonical_pose is None:
            raise ValueError("`Orbit.configuration` needs poses. Got reconstruct=False. Run with reconstruct=True.")
        return self.canonical_pose
