"""Limits that a motion comes from and tends to: velocities, axes in body and in space, the total turn of a sleigh.

An orbit is followed backwards and forwards until its velocity has settled. Theory: docs/theory/limits.md.
"""

import dataclasses
import functools
import math
from typing import Any, NamedTuple, cast

import numpy as np

from nonholo.analysis._critical_energies import critical_energies
from nonholo.analysis._equilibria import EquilibriumSpectrum, equilibria, highest_energy
from nonholo.analysis._loci import single_valued_region
from nonholo.analysis.planar import planar_map, planar_variety
from nonholo.base.checks import bounded_count, choice, error, positive, shown
from nonholo.base.progress import progress_bar
from nonholo.base.results import OutcomeError, result
from nonholo.base.types import Float
from nonholo.discrete import Discretization, as_discretization
from nonholo.orbit import Orbit
from nonholo.simulation import flow, simulate
from nonholo.systems import AbstractLLSystem, NormalForm, one_start, refuse_forces

_ROUNDING = 8 * np.finfo(np.float64).eps
_SETTLED = 34.0  # natural logarithm of the factor by which the distance from the equilibria has fallen: 6e14
_LONGEST = 1_000_000  # steps


class Approach(NamedTuple):
    """The limits of an orbit.

    Attributes:
        constant: The part of the body velocity that never changes.
        energy: The energy of the rest.
        spectrum: The equilibria that the rest tends to.
        beside: Sine of the distance of the first state from the equilibria, in the body's units: near the
            repelling ones it leaves late.
    """

    constant: Float[np.ndarray, "dim"]
    energy: float
    spectrum: EquilibriumSpectrum
    beside: float


def approach(orbit: Orbit) -> Approach | None:
    """Return what an orbit of a top or a sleigh tends to; None if its velocity never changes."""
    system, velocity = cast("AbstractLLSystem", orbit.system), orbit.body_velocity[0]
    family = system.equilibria()
    rows, v = family.subspace / system.displacement_units, velocity / system.displacement_units
    beside = float(np.linalg.norm(v - v @ np.linalg.pinv(rows) @ rows) / (np.linalg.norm(v) or 1))
    if family.attracting is None or beside <= _ROUNDING:
        return None
    constant, energy = kept_velocity(orbit)
    subject = orbit.motion if isinstance(orbit.motion, Discretization) else system
    return Approach(constant, energy, equilibria(subject, energy), beside)


def kept_velocity(orbit: Orbit) -> tuple[Float[np.ndarray, "dim"], float]:
    """Return the part of the velocity that never changes, and the energy of the rest."""
    system, velocity = cast("AbstractLLSystem", orbit.system), orbit.body_velocity[0]
    form, constant = system.normal_form, np.zeros_like(velocity)
    if form is not None and form.is_sleigh and form.arm == 0:  # the advance u
        rows = system.form_map @ system.constraint_subspace
        w = velocity @ np.linalg.pinv(rows)
        constant = (w[-1] + form.offset @ w[:-1]) * rows[-1]
    own = system.constrained_energy(constant @ np.asarray(system.inertia_operator))
    return constant, float(orbit.energy[0]) - float(own)


def both_ends(orbit: Orbit, limits: Approach, where: str = "asymptotics(subject=...)") -> tuple[Orbit, Orbit]:
    """Follow an orbit, from the identity if it has no poses, to both ends; refuse in the name of `where`.

    The first orbit runs backwards, against time, from one step after the first state on. A map runs backwards from the
    inverse displacement: it is reversible. A composition goes back from the opposite momentum.
    """
    discrete, group, decay = orbit.motion, orbit.system.group, _SETTLED - float(np.log(limits.beside))
    g = group.identity if orbit.canonical_pose is None else orbit.configuration[0]
    start = {"momentum": orbit.restricted_momentum[0], "configuration": g}
    if not isinstance(discrete, Discretization):
        time = decay / float(np.abs(limits.spectrum.rates).min())
        run = functools.partial(flow, orbit.system, **start, rtol=1e-12, atol=1e-13)
        method = "closed_form" if group.dim == 3 else None
        return run(times=(0.0, -time), method=method), run(times=(0.0, time), method=method)
    slowest = float(np.abs(np.asarray(limits.spectrum.multipliers)).max())
    step_count = decay / -np.log(slowest) if slowest < 1 else np.inf
    if step_count > _LONGEST:
        remedy = "Take a longer time step, or the limits of the flow."
        got = f"a slowest multiplier of {slowest:.17g}"
        raise error(where, f"settle within {_LONGEST} steps", got, remedy)
    W, steps = orbit.displacement[0], int(np.ceil(step_count)) + 1
    last = simulate(discrete, **start, steps=steps)
    back = {"displacement": group.inverse(W)} if discrete.order == 2 else {"momentum": -last.restricted_momentum[1]}
    return simulate(discrete, **back, configuration=g @ W, steps=steps), last


_SAME = 1e-6  # relative distance of displacements beyond which two orbits are on different branches


@result
class Asymptotics:
    r"""Limits at $t \to -\infty$ (before) and $t \to \infty$ (after); None where a quantity is not defined.

    Attributes:
        velocity_before: Limit of the body velocity; for an orbit alone.
        velocity_after: The same.
        axis_before: Limit of the unit body velocity, for a top with n = 3: the axis it turns about, as seen in the
            body; opposite to `axis_after`.
        axis_after: The same.
        spatial_axis_before: That axis in space; for an orbit alone.
        spatial_axis_after: The same.
        heading_turn: The total turn of a sleigh; its size alone for a system, with its sign for an orbit.
        motion_turn: The same for its direction of motion, modulo full turns: the sleigh starts out backwards.
        persists: Whether the orbit is known to continue forever. It is for a flow, for a principal orbit of a plane
            sleigh below its `principal_energy` of `single_valued_region` and of a top below its `fold` of
            `critical_energies`. Elsewhere the limits are those of an orbit that does, on any branches.
    """

    velocity_before: Float[np.ndarray, "dim"] | None = None
    velocity_after: Float[np.ndarray, "dim"] | None = None
    axis_before: Float[np.ndarray, "3"] | None = None
    axis_after: Float[np.ndarray, "3"] | None = None
    spatial_axis_before: Float[np.ndarray, "3"] | None = None
    spatial_axis_after: Float[np.ndarray, "3"] | None = None
    heading_turn: float | None = None
    motion_turn: float | None = None
    persists: bool = True


def asymptotics(subject: AbstractLLSystem | Orbit) -> Asymptotics:
    r"""Return where the motions of a system, or one orbit of a flow or of a discrete map, come from and go to.

    Every motion goes from the repelling to the attracting equilibrium of its energy. For the discrete map this holds
    for every real orbit that continues forever and is not stationary, on any branches, in every dimension,
    at every energy; where no equilibrium has the energy (above `line` of `critical_energies`, `highest_energy` of
    `equilibria`) none continues forever, and there are no limits. The heading of a sleigh turns by

    $$ \theta(\infty) - \theta(-\infty) = \mathrm{sgn}(\omega)\,\pi\sqrt{1 + J/(ma^2)} $$

    along the flow. A discrete orbit has the same limits of the velocity, exactly, and a turn that differs by O(h^2);
    its turn and the axes in space are found by following the principal orbit of its first state to both ends. They are
    None if that ends on the way or is another orbit. Of a composition (order > 2) the limits are observed, not proved.

    Reference: [fedorov-zenkov-2004], sections 5 and 6, "bi-asymptotic".

    Args:
        subject: A top, a sleigh, or an orbit of one. An orbit that starts on an equilibrium, to rounding, stays there.

    Raises:
        ValueError: Another system or orbit; a discrete orbit that needs more than a million steps.

    Example:
        >>> print(f"{asymptotics(nh.ChaplyginSleigh(1.0, 0.75, 0.5)).heading_turn / np.pi:.12f}")
        2.000000000000
        >>> top = nh.SuslovTop([[1.0, 0.0, 0.5], [0.0, 1.0, 0.0], [0.5, 0.0, 1.0]])
        >>> asymptotics(top).axis_after
        array([-0., -1., -0.])
    """
    where, orbit = "asymptotics(subject=...)", subject if isinstance(subject, Orbit) else None
    system: Any = subject if orbit is None else orbit.system
    refuse_forces(where, system)
    if orbit is not None and orbit.has_impacts.any():
        raise error(where, "be an orbit without impacts", "some", "Pass the system.")
    form = getattr(system, "normal_form", None)
    if form is None:
        remedy = "Pass a SuslovTop, a sleigh, or an orbit of one."
        raise error(where, "be a top or a sleigh, or its orbit", type(subject).__name__, remedy)
    if orbit is not None:
        if len(orbit) == 0:
            raise error(where, "have at least one state", "none", "See the orbit's outcome.")
        return _of_orbit(form, orbit)
    attracting = system.equilibria().attracting
    if attracting is None:
        return Asymptotics()
    if _turns_once(form):
        turn = float(turn_of_flow(form.mass, form.stiffness[0, 0], form.arm))
        return Asymptotics(heading_turn=turn, motion_turn=turn - np.pi)
    return Asymptotics(axis_before=_axis(form, -attracting), axis_after=_axis(form, attracting))


def turn_of_flow(mass: Any, inertia: Any, a: Any) -> Any:
    r"""Return the total turn of sleighs along the flow, $\pi\sqrt{1 + J/(ma^2)}$; of numbers or arrays."""
    return np.pi * np.sqrt(1 + inertia / mass / a / a)


def _turns_once(form: NormalForm) -> bool:
    """Return whether a body in the plane has a center of mass before or behind its blade, so that its turn ends."""
    return form.is_planar and form.arm != 0


def _axis(form: NormalForm, velocity: Float[np.ndarray, "dim"]) -> Float[np.ndarray, "3"] | None:
    """Return the unit vector of a velocity on SO(3); None at rest and in other groups."""
    size = float(np.linalg.norm(velocity))
    return velocity / size if form.is_planar and not form.is_sleigh and size > 0 else None


def _of_orbit(form: NormalForm, orbit: Orbit) -> Asymptotics:
    if _is_bound_to_end(orbit):
        return Asymptotics(persists=False)
    velocity, limits = orbit.body_velocity[0], approach(orbit)
    if limits is None:
        return _resting(form, orbit, velocity)
    change = np.zeros_like(limits.constant) if limits.spectrum.velocity is None else limits.spectrum.velocity
    persists = _known_to_persist(form, orbit, limits.energy)
    before, after = limits.constant - change, limits.constant + change
    if _turns_once(form):
        turn = _heading_turn(form, orbit, limits)
        forwards = None if turn is None else turn - float(np.copysign(np.pi, velocity[0]))
        return Asymptotics(before, after, heading_turn=turn, motion_turn=forwards, persists=persists)
    axes: Any = _axis(form, before), _axis(form, after)
    ends = None if axes[1] is None or orbit.canonical_pose is None else _ends(orbit, limits)
    in_space = () if ends is None else (end.configuration[-1] @ axis for end, axis in zip(ends, axes, strict=True))
    return Asymptotics(before, after, *axes, *in_space, persists=persists)


def _resting(form: NormalForm, orbit: Orbit, velocity: Float[np.ndarray, "dim"]) -> Asymptotics:
    """Return the limits of a motion with constant velocity: the heading of a balanced sleigh turns forever."""
    axis = _axis(form, velocity)
    in_space = None if axis is None or orbit.canonical_pose is None else orbit.configuration[0] @ axis
    turn = 0.0 if _turns_once(form) else None
    return Asymptotics(velocity, velocity, axis, axis, in_space, in_space, turn, turn)


def _is_bound_to_end(orbit: Orbit) -> bool:
    """Return whether an orbit of a map that keeps it has more energy than every equilibrium."""
    if not isinstance(orbit.motion, Discretization) or not orbit.motion.conserves_energy:
        return False
    highest = highest_energy(orbit.motion)
    return highest is not None and kept_velocity(orbit)[1] > highest


def _known_to_persist(form: NormalForm, orbit: Orbit, energy: float) -> bool:
    discrete = orbit.motion
    if not isinstance(discrete, Discretization):
        return True
    if orbit.branch != "principal" or discrete.order > 2:
        return False
    if not form.is_sleigh:
        return energy < critical_energies(discrete).fold
    return form.is_planar and energy < single_valued_region(discrete).principal_energy


def _ends(orbit: Orbit, limits: Approach) -> tuple[Orbit, Orbit] | None:
    """Return both ends of an orbit; None where its principal branch ends, or is not the one that the orbit took."""
    try:
        ends = both_ends(orbit, limits)
    except OutcomeError:
        return None
    return ends if orbit.branch == "principal" or _is_start_of(ends[1], orbit) else None


def _is_start_of(principal: Orbit, orbit: Orbit) -> bool:
    """Return whether two discrete orbits with one first momentum have the same displacements as far as both go."""
    both = orbit.chosen(orbit.step < orbit.step[0] + len(principal))
    again, mine = principal.displacement[both.step - orbit.step[0]], both.displacement
    return bool(np.abs(again - mine).max() <= _SAME * np.abs(orbit.displacement).max())


def _heading_turn(form: NormalForm, orbit: Orbit, limits: Approach) -> float | None:
    """Return the signed turn: in closed form for a flow, summed over all steps for a discrete orbit."""
    if not isinstance(orbit.motion, Discretization):
        turn = turn_of_flow(form.mass, form.stiffness[0, 0], form.arm)
        return float(np.copysign(turn, orbit.body_velocity[0, 0]))
    ends = _ends(orbit, limits)
    if ends is None:
        return None
    first, last = ends
    return float(last.heading[-1] - last.heading[0] + first.heading[1] - first.heading[-1])


@result
class HeteroclinicOrbit:
    """An orbit traced both ways.

    Attributes:
        orbit: All states, the past first; the point that was given has time zero. At both ends the distance from the
            equilibria has fallen by 6e14, to rounding.
        limits: Its limits in the past and in the future.
    """

    orbit: Orbit
    limits: Asymptotics


def heteroclinic(
    discrete: Discretization,
    *,
    energy: Any = None,
    momentum: Any = None,
    displacement: Any = None,
    configuration: Any = None,
    side: int = 1,
) -> HeteroclinicOrbit:
    r"""Trace an orbit of the discrete map from near the repelling to near the attracting equilibrium.

    Forwards the map is run from W; backwards from $W^{-1}$, whose orbit is the past of W, inverted. Each value is
    the principal one of its direction, so the way back is on the branch on which the map was run.

    Reference: [fedorov-zenkov-2004], theorem (discr_sus_dyn) and the theorem of section 7.

    Args:
        discrete: A top or a sleigh of any dimension, discretized with "matrix" and "skew".
        energy: The energy, where the constraint leaves two directions (n = 3, the plane); the orbit then passes
            through the momentum half way between the equilibria.
        momentum: A momentum on the orbit, full or along the constraint subspace.
        displacement: A displacement on the orbit.
        configuration: The pose at time zero; the identity by default.
        side: With `energy`, which of the two half-planes of `half_planes`: 1 or -1.

    Raises:
        ValueError: Another system or discretization, a balanced body, a start on an equilibrium, none or several
            starts, an energy for other systems, an orbit that needs more than a million steps.
        OutcomeError: The start is not on the principal branch, or that ends on the way, forwards or backwards.

    Example:
        >>> sleigh = nh.discretize(nh.ChaplyginSleigh(mass=1.0, inertia=0.75, a=0.5), 0.2)
        >>> connection = heteroclinic(sleigh, energy=0.5)
        >>> connection.orbit.body_velocity[[0, -1], 1].round(12)
        array([-1.,  1.])
        >>> bool(np.ptp(connection.orbit.energy) < 1e-14)
        True
    """
    where = "heteroclinic(discrete=...)"
    system = cast("AbstractLLSystem", as_discretization(where, discrete).system)
    if system.normal_form is None or not discrete.conserves_energy:
        remedy = "Discretize a SuslovTop or a sleigh with the defaults."
        raise error(where, "be a top or a sleigh whose map keeps energy", shown(discrete), remedy)
    if system.equilibria().attracting is None:
        raise error(where, "have attracting equilibria", f"the balanced {system!r}", "Its velocity is constant.")
    one_start("heteroclinic", energy=energy, momentum=momentum, displacement=displacement)
    sign = choice("heteroclinic(side=...)", side, (1, -1))
    if energy is not None:
        momentum = middle(system, energy, sign)
    start = {"momentum": momentum, "displacement": displacement, "configuration": configuration}
    point = simulate(discrete, **start, steps=1)[:1]
    return HeteroclinicOrbit(both_ways("heteroclinic(...)", point), asymptotics(point))


def both_ways(where: str, point: Orbit) -> Orbit:
    r"""Return the whole orbit of a state, refused in the name of `where` on an equilibrium.

    State j of its past has $W_{-j}^{-1}$, the momentum $-r_{1-j}$ and the pose $g_{1-j}$.
    """
    limits = approach(point)
    if limits is None:
        raise error(where, "start off the equilibria", "a constant velocity", "Start beside it.")
    past, future = both_ends(point, limits, where)
    earlier, later = slice(-2, 0, -1), slice(-1, 1, -1)
    h = float(future.time[1] - future.time[0])
    return dataclasses.replace(
        future,
        time=h * np.arange(2 - len(past), len(future)),
        reduced_momentum=np.concatenate([-past.reduced_momentum[later], future.reduced_momentum]),
        cayley=np.concatenate([-past.canonical_chart[earlier], future.canonical_chart]),
        canonical_pose=np.concatenate([np.asarray(past.canonical_pose)[later], np.asarray(future.canonical_pose)]),
    )


def middle(system: AbstractLLSystem, energy: Any, side: int) -> Float[np.ndarray, "2"]:
    """Return the restricted momentum of an energy half way between the equilibria, where the Lyapunov function is 0."""
    level = float(positive("heteroclinic(energy=...)", energy, "Pass the energy of the orbit."))
    attracting = np.linalg.pinv(system.constraint_subspace).T @ np.asarray(system.equilibria().attracting)
    variety = planar_variety(system)
    if variety is None:
        got = f"{len(attracting)} admissible directions, where many orbits have one energy"
        raise error("heteroclinic(energy=...)", "determine the orbit", got, "Pass a momentum or a displacement.")
    r = np.array([-attracting[1], attracting[0]])
    r = r * np.sqrt(level / float(system.constrained_energy(r)))
    return side * np.sign(variety.sides_of_momenta(r).side) * r


@result
class FlowObstruction:
    r"""The conjugacy invariant of the map on one side of the equilibria, on one energy.

    Attributes:
        multiplier: $\mu$ at the attracting end; $1/\mu$ at the repelling one.
        phase: Values of $s_-$ modulo 1, which grows by 1 in a step, ascending, shape (samples,).
        difference: $s_+ - s_-$ at these orbits, less its mean, shape (samples,).
    """

    multiplier: float
    phase: Float[np.ndarray, "samples"]
    difference: Float[np.ndarray, "samples"]

    @property
    def amplitude(self) -> float:
        """The largest less the smallest difference; zero for the map of a flow."""
        return float(np.ptp(self.difference))


def flow_obstruction(
    discrete: Discretization, energy: Any, samples: int = 16, *, progress: bool = False
) -> FlowObstruction:
    r"""Return the periodic function that would be constant if the map were that of a smooth flow.

    On a half of an energy level the side $\sigma_k$ of the momentum (`half_planes`) tends to zero at both ends. There

    $$ s_+ = \lim_{k\to\infty}\Bigl(\frac{\log|\sigma_k|}{\log\mu} - k\Bigr), \qquad
       s_- = -\lim_{k\to-\infty}\Bigl(\frac{\log|\sigma_k|}{\log\mu} + k\Bigr) $$

    are coordinates in which the map is $s \mapsto s + 1$, the only smooth ones up to a constant. If the map were the
    time-h map of a smooth flow on the closed half level, both would be times of that flow, and their difference
    constant. It is a function of period 1 of $s_-$. Since $\sigma_{k+1}/\sigma_k = (\Lambda - Q)/(\Lambda + Q)$ is
    a function of the displacement, the limits are sums without cancellation; they are right to about $10^{-14}$ over
    $|\log\mu|$. Smaller amplitudes, those of short steps, are beyond double precision.

    Args:
        discrete: A top with n = 3 or a sleigh, discretized with "matrix" and "skew".
        energy: The energy of the level; on it orbits have to stay on their side.
        samples: Orbits, spread over one step.
        progress: Show a progress bar on standard error.

    Raises:
        ValueError: Another system or discretization, a balanced body, an energy that is not positive or so large that
            orbits change sides.
        OutcomeError: The branch ends on the way.

    Example:
        >>> obstruction = flow_obstruction(nh.discretize(nh.ChaplyginSleigh(1.0, 0.2, 1.0), 1.0), energy=1.125)
        >>> print(f"{obstruction.amplitude:.1e}")
        4.5e-03
    """
    where = "flow_obstruction(discrete=...)"
    discrete = planar_map(where, discrete)[0]
    number = bounded_count("flow_obstruction(samples=...)", samples, 100.0, "Pass the number of orbits.")
    spectrum = equilibria(discrete, energy)
    if spectrum.multipliers is None or spectrum.attracting is None:
        got = f"the balanced {discrete.system!r}"
        raise error(where, "have attracting equilibria", got, "Its momenta are constant.")
    multiplier = float(spectrum.multipliers[0])
    ends = np.empty((number, 2))
    with progress_bar("orbits", progress) as report:
        for sample, r in enumerate(_one_step(discrete, energy, number)):
            ends[sample] = _phases(discrete, multiplier, r)
            report(sample + 1, number)
    order = np.argsort(ends[:, 0] % 1.0)
    difference = ends[order, 1] - ends[order, 0]
    return FlowObstruction(multiplier, ends[order, 0] % 1.0, difference - difference.mean())


def _one_step(discrete: Discretization, energy: Any, number: int) -> Float[np.ndarray, "samples 2"]:
    """Return momenta from the middle of the half level to where one step takes it."""
    system = cast("AbstractLLSystem", discrete.system)
    first = middle(system, energy, 1)
    after = simulate(discrete, momentum=first, steps=1, reconstruct=False).restricted_momentum[1]
    level = 2 * float(system.constrained_energy(first))
    cosine = float(after @ system.restricted_velocity(first)) / level
    across = after - cosine * first
    angles = np.arctan2(np.sqrt(2 * system.constrained_energy(across) / level), cosine) * np.arange(number) / number
    toward = across * np.sqrt(level / (2 * system.constrained_energy(across)))
    return np.cos(angles)[:, None] * first + np.sin(angles)[:, None] * toward


def _phases(discrete: Discretization, multiplier: float, r: Float[np.ndarray, "2"]) -> tuple[float, float]:
    """Return the linearizing coordinates of a momentum at the repelling and at the attracting end."""
    point = simulate(discrete, momentum=r, steps=1)[:1]
    orbit, variety = both_ways("flow_obstruction(...)", point), planar_map("flow_obstruction(...)", discrete)[1]
    (_, forward), weight = variety.sides(variety.points(orbit.displacement))
    ratio = (weight - forward) / (weight + forward)
    if multiplier <= 0 or ratio.min() <= 0:
        remedy = "Take a smaller energy or time step."
        got = f"a step that multiplies the side by {ratio.min():.3g}"
        raise error("flow_obstruction(energy=...)", "keep orbits on their side", got, remedy)
    here, rate = math.log(abs(float(variety.sides_of_momenta(r).side))), math.log(multiplier)
    factors, now = np.log(ratio), int(np.flatnonzero(orbit.time == 0)[0])
    after = here + math.fsum(factors[now:] - rate)
    before = here - math.fsum(factors[:now] + rate)
    return -before / rate, after / rate
