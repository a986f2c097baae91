r"""Orbits of given poses: of a camera, of another integrator, of a file. Nothing is simulated or smoothed here.

Between poses there are displacements $W_k = g_k^{-1}g_{k+1}$ over $h_k = t_{k+1} - t_k$. The last one leads back to the
pose before, over a negative time: its momentum is that at which the last step arrives.
"""

import dataclasses
import warnings
from typing import Any, ClassVar

import numpy as np

from nonholo.base.checks import array, error, instance
from nonholo.base.numerics import applied
from nonholo.base.types import Float
from nonholo.discrete._discretize import discretize
from nonholo.discrete._scheme import legendre
from nonholo.groups import AbstractMatrixGroup
from nonholo.orbit import AbstractMotion, AliasingWarning, Orbit, configurations
from nonholo.systems import AbstractSystem, System

_NEAR = 1e-5  # relative distance from the group of poses in single precision, or written with six digits
_WIDE = 90.0  # degrees of a turn; half a turn is the most that poses can tell
_SAME_STEP = 1e-9  # relative difference of time steps that are equal


@dataclasses.dataclass(frozen=True, eq=False)
class MeasuredMotion(AbstractMotion):
    r"""The motion of given poses, made by `Orbit.from_poses`.

    A state's chart coordinates are those of $\log W_k$ (spatial: $\log U_k$) and $h_k$. Nothing is said between states.

    Attributes:
        system: The system.
        time_step: The time between poses; None where it varies.
    """

    system: System
    time_step: float | None = None
    is_measured: ClassVar[bool] = True

    def displaced(self, cayley: Float[np.ndarray, "... m"]) -> Float[np.ndarray, "... N N"]:
        """Return the displacements, in the user's frame, of chart coordinates."""
        return self._increments(cayley) + self.system.group.identity

    def full_momentum(self, states: Orbit) -> Float[np.ndarray, "K dim"]:
        """Return the discrete momenta at the displacements, with the default difference of the system."""
        return self.momenta(states.canonical_chart, self.system.constraint_poses(states))

    def momenta(self, chart: Float[np.ndarray, "K m"], g: Float[np.ndarray, "K N N"] | None) -> np.ndarray:
        """Return the momenta at which displacements from poses set out; the poses count where U is given, not W."""
        X = self.system.in_body(self._increments(chart), g)
        return legendre(discretize(self.system, 1.0), X, "left") / chart[:, -1:]

    def multipliers(self, states: Orbit) -> Float[np.ndarray, "L s"]:
        """Refuse: poses do not tell forces of constraint from others."""
        remedy = "Compare momenta, `orbit.momentum`, with those of a run."
        raise error("Orbit.multipliers", "be read from a run", f"{len(states)} given poses", remedy)

    def constraint_residual(self, states: Orbit) -> Float[np.ndarray, "K j"]:
        """Return the forbidden velocities: parts of (W - W^-1)/2h, or of log W/h where the group has no skew part."""
        system, chart = self.system, states.canonical_chart
        group, D = system.group, self.displaced(chart)
        coordinates = group.vee(D - group.inverse(D)) / 2 if group.has_skew_part else group.log(D)
        return applied(system.annihilator, coordinates) / chart[:, -1:]

    def _increments(self, chart: Float[np.ndarray, "... m"]) -> Float[np.ndarray, "... N N"]:
        """Return displacements less the identity, without cancellation."""
        return self.system.from_canonical_frame(self.system.group.exp_increment(chart[..., :-1]))


def orbit_of_poses(system: Any, time: Any, configuration: Any) -> Orbit:
    """Return the orbit of given poses; see `Orbit.from_poses`."""
    where, remedy = "Orbit.from_poses(system=...)", "Pass a SuslovTop, a sleigh or an LLSystem."
    instance(where, system, AbstractSystem, "be a system on a group", remedy)
    times, g = _times(time), _elements(system.group, configuration)
    if len(times) != len(g):
        got = f"{len(times)} times for {len(g)} poses"
        raise error("Orbit.from_poses(time=...)", "have one time for each pose", got, "Pass as many.")
    group, frame = system.group, system.frame
    pose = group.normalize_pose(group.pose_from_matrix(g @ frame))
    gaps = np.diff(times)
    step = float(gaps.mean()) if np.ptp(gaps) <= _SAME_STEP * gaps.mean() else None
    chart = _chart(system, group.matrix_from_pose(pose), np.append(gaps, -gaps[-1]))
    motion = MeasuredMotion(system, step)
    g = configurations(system, pose)
    # means, linear in time, of momenta that set out and those that arrive: other forces than the constraint's part them
    out = system.restrict_at(motion.momenta(chart, g), g)
    arriving = system.restrict_at(motion.momenta(-chart[:-1], g[1:]), g[1:])[:-1]
    before, after = chart[:-2, -1:], chart[1:-1, -1:]
    out[1:-1] = (before * out[1:-1] + after * arriving) / (before + after)
    return Orbit(motion, times, system.to_canonical(out), chart, pose)


def _chart(system: System, g: Float[np.ndarray, "K N N"], h: Float[np.ndarray, "K"]) -> np.ndarray:
    """Return log W_k, spatial log U_k, in the canonical frame, and h_k; from the last pose back.

    Warn of the first turn that is wider than 90 degrees, by the eigenvalues of its matrix.
    """
    group = system.group
    ahead = np.concatenate([g[1:], g[-2:-1]])
    D = ahead @ group.inverse(g) if system.is_spatial else group.inverse(g) @ ahead
    turns = np.degrees(np.abs(np.angle(np.linalg.eigvals(D[:-1]))).max(axis=1))
    if (wide := turns > _WIDE).any():
        row = int(wide.argmax())
        turn = f"turns by {turns[row]:.3g} degrees from row {row} to row {row + 1}."
        reason = "Velocities are those of the shorter turn, which may not be the one taken."
        message = f"`Orbit.from_poses(configuration=...)` {turn} {reason} Pass poses in shorter steps."
        warnings.warn(message, AliasingWarning, stacklevel=4)
    return np.concatenate([group.log(D), h[:, None]], axis=1)


def _times(time: Any) -> Float[np.ndarray, "K"]:
    where = "Orbit.from_poses(time=...)"
    times = array(where, time, (None,), "Pass a sequence of times.")
    if len(times) < 2:
        raise error(where, "hold two times or more", str(len(times)), "A velocity needs two poses.")
    gaps = np.diff(times)
    if not gaps.min() > 0:
        at = int(gaps.argmin())
        raise error(where, "be strictly increasing", f"{times[at + 1]} after {times[at]}", "Sort the rows by time.")
    return times


def _elements(group: AbstractMatrixGroup, configuration: Any) -> Float[np.ndarray, "K N N"]:
    """Return the poses, refused with the first that is too far from the group."""
    where, n = "Orbit.from_poses(configuration=...)", group.size
    g = array(where, configuration, (None, n, n), f"Pass an element of {group} as a matrix for each time.")
    distance = np.asarray(group.residual(g)) / np.linalg.norm(g, axis=(1, 2))
    if not np.all(distance <= _NEAR):
        at = int(np.argmax(~(distance <= _NEAR)))
        got = f"a matrix at relative distance {distance[at]:.3g} in row {at}"
        raise error(where, f"lie in {group}", got, "Give more digits, or check the order of rows and columns.")
    return g
