r"""A system with a potential and a force: again a system, with kinetic energy and constraint of the one inside.

Questions about free motions (equilibria, conserved momenta, closed forms) are refused; what serves forces says so.
"""

import dataclasses
from collections.abc import Callable
from typing import Any, ClassVar

import numpy as np

from nonholo.base.checks import array, as_floats, error, shape_of, shown
from nonholo.base.types import Array, Float
from nonholo.systems._base import AbstractSystem
from nonholo.systems.forces._friction import Friction
from nonholo.systems.forces._gravity import Gravity

_OFFSET = 8e-3  # of a body direction, for central differences: its sixth power is at rounding
_DIFFERENCES = np.array([45.0, -9.0, 1.0]) / 60  # of order 6, at one, two and three offsets

Potential = Callable[[Any], Any] | Gravity
Force = Callable[[float, Any, Any], Any] | Friction | Array


def _same(name: str) -> Any:
    """Return an attribute that is that of the system inside."""
    return property(lambda self: getattr(self.system, name), doc=f"`{name}` of the system inside.")


@dataclasses.dataclass(frozen=True, eq=False)
class Forced(AbstractSystem):
    r"""A system under a potential U and a force f, a body covector; both act along the constraint alone.

    $$ \dot p = \mathrm{ad}^*_\omega p - dU + f(t, g, \omega) + \sum_j\lambda_ja^j, \qquad \omega\in\mathfrak{d}. $$

    `discretize` gives the forced discrete map: half the impulse of a step at each of its ends, and the free map
    between them (docs/theory/forces.md). It is of order 2, symmetric in time, explicit where f does not depend on the
    velocity, and keeps group and constraint as the free map does. Momenta and energies of its orbits are those at the
    nodes. Nothing is conserved exactly. Under a potential alone the error of T + U is of order 2; it stays bounded for
    a body without constraint, whose map is symplectic, and on orbits that are their own time reversal; on others it may
    grow in proportion to time, at a rate of order 2. Under friction alone T never grows. In general $E_k - E_0$ is the
    work of f (`Orbit.work`) up to an error of order 2.

    Args:
        system: A system on a group, `LLSystem` or `LRSystem` or one of their kinds.
        potential: U, a function from a configuration (N, N) to a number, or `Gravity`. The derivative of a function is
            taken by central differences of order 6 along the body directions; their error is about 1e-13 of what U
            changes by over one radian or one unit of length.
        force: f, a function (time, configuration, body_velocity) -> (dim,); or `Friction`; or an array (steps, dim),
            whose row k acts constantly over step k: for maps only. Time is that of the orbit, from zero.

    Raises:
        ValueError: A system in coordinates, one that is forced already or that has no matrices; a potential or force
            of another kind or shape.

    Example:
        A heavy top that is not let spin about its own axis:

        >>> top = nh.SuslovTop(np.diag([1.0, 1.2, 0.6]))
        >>> heavy = nh.Forced(top, nh.Gravity(force=[0.0, 0.0, -9.81], point=[0.0, 0.0, 0.3]))
        >>> orbit = nh.simulate(nh.discretize(heavy, 0.01), body_velocity=(0.2, 0.1, 0.0), steps=1000)
        >>> float(np.ptp(orbit.energy) / abs(orbit.energy[0])) < 1e-3
        True
    """

    system: AbstractSystem
    potential: Any = None
    force: Any = None
    leaves: ClassVar[tuple[str, ...]] = ()
    structure: ClassVar[tuple[str, ...]] = ("system", "potential", "force")
    normal_form: ClassVar[None] = None
    group = _same("group")
    is_spatial = _same("is_spatial")
    has_blade = _same("has_blade")
    homogeneous_mass_tensor = _same("homogeneous_mass_tensor")
    inertia_operator = _same("inertia_operator")
    constraint_subspace = _same("constraint_subspace")
    annihilator = _same("annihilator")
    canonical = _same("canonical")
    frame = _same("frame")
    frame_map = _same("frame_map")
    frame_pose = _same("frame_pose")
    inertia_along = _same("inertia_along")
    rank = _same("rank")
    to_canonical = _same("to_canonical")
    from_canonical = _same("from_canonical")
    carried = _same("carried")
    moved = _same("moved")
    restrict_at = _same("restrict_at")
    restricted_velocity = _same("restricted_velocity")
    restricted_momentum = _same("restricted_momentum")
    constrained_energy = _same("constrained_energy")

    def __post_init__(self) -> None:
        inside = self.system
        if not isinstance(inside, AbstractSystem) or isinstance(inside, Forced) or inside.is_wide:
            remedy = "Pass a SuslovTop, a sleigh or an LLSystem, with all forces at once."
            raise error("Forced(system=...)", "be a system on a group, with matrices", shown(inside), remedy)
        if isinstance(self.potential, Gravity):
            self.potential.check(inside.group)
        elif self.potential is not None and not callable(self.potential):
            remedy = "Pass a function of a configuration, or Gravity."
            raise error("Forced(potential=...)", "be a potential", shown(self.potential), remedy)
        if isinstance(self.force, Friction):
            self.force.check(inside.group.dim)
        elif self.force is not None and not callable(self.force):
            remedy = "Pass a function of time, configuration and body velocity, Friction, or one body covector a step."
            shape = (None, inside.group.dim)
            object.__setattr__(self, "force", array("Forced(force=...)", self.force, shape, remedy))

    @property
    def table(self) -> Float[np.ndarray, "steps dim"] | None:
        """The forces of the steps, where they are given one by one."""
        return None if self.force is None or callable(self.force) or isinstance(self.force, Friction) else self.force

    @property
    def is_free(self) -> bool:
        """Whether there is neither a potential nor a force."""
        return self.potential is None and self.force is None

    @property
    def needs_function(self) -> bool:
        """Whether a Python function has to be called, which no kernel does and no store holds."""
        return callable(self.potential) or callable(self.force)

    def potential_energy(self, configuration: Float[Array, "... N N"]) -> Float[np.ndarray, "..."]:
        """Return U at configurations; zero without a potential.

        Example:
            >>> heavy = nh.Gravity(force=[0.0, -2.0], point=[0.5, 0.0])
            >>> forced = nh.Forced(nh.ChaplyginSleigh(1.0, 1.0, 0.5), heavy)
            >>> float(forced.potential_energy(nh.SE(2).exp([0.0, 0.0, 3.0])))
            6.0
        """
        g = np.asarray(configuration)
        if isinstance(self.potential, Gravity):
            return self.potential.energy(self.group, g)
        if self.potential is None:
            return np.zeros(g.shape[:-2])
        return _each(self._value, g)

    def potential_force(self, configuration: Float[Array, "... N N"]) -> Float[np.ndarray, "... dim"]:
        """Return -dU, body covectors at configurations: exact of `Gravity`, by differences of a function."""
        g = np.asarray(configuration)
        if isinstance(self.potential, Gravity):
            return self.potential.covector(self.group, g)
        if self.potential is None:
            return np.zeros((*g.shape[:-2], self.group.dim))
        return _each(self._slope, g)

    def applied_force(self, time: float, configuration: np.ndarray, body_velocity: np.ndarray) -> np.ndarray:
        """Return f, one body covector, of `Friction` or of a function; zero of a table, which belongs to steps."""
        if isinstance(self.force, Friction):
            return self.force.covector(body_velocity)
        if not callable(self.force):
            return np.zeros(self.group.dim)
        found = as_floats(self.force(float(time), configuration, body_velocity))
        if found.shape != (self.group.dim,) or found.dtype.kind != "f":
            got = f"{found.dtype} numbers of shape {found.shape}"
            raise error("Forced(force=...)", f"return {self.group.dim} real numbers", got, "Return a body covector.")
        return found

    def rows(self, steps: np.ndarray) -> Float[np.ndarray, "K dim"]:
        """Return the rows of the table for numbers of steps; zero after its end, and without one."""
        found, table = np.zeros((len(steps), self.group.dim)), self.table
        if table is not None:
            inside = (steps >= 0) & (steps < len(table))
            found[inside] = table[steps[inside]]
        return found

    def _value(self, g: np.ndarray) -> np.float64:
        found = self.potential(g)  # type: ignore[misc]
        if shape_of(found) != () or as_floats(found).dtype.kind != "f":
            raise error("Forced(potential=...)", "return one real number", shown(found), "Return U of a configuration.")
        return np.float64(found)

    def _slope(self, g: np.ndarray) -> np.ndarray:
        moves, total = _OFFSET * np.eye(self.group.dim), np.zeros(self.group.dim)
        for count, weight in enumerate(_DIFFERENCES, start=1):
            there, back = self.group.exp(count * moves), self.group.exp(-count * moves)
            total -= weight * (_each(self._value, g @ there) - _each(self._value, g @ back))
        return total / _OFFSET


def _each(function: Callable[[np.ndarray], Any], g: np.ndarray) -> np.ndarray:
    """Return the values of a function of one matrix at all of them."""
    found = np.array([function(each) for each in g.reshape(-1, *g.shape[-2:])])
    return found.reshape(*g.shape[:-2], *found.shape[1:])


def as_forced(system: AbstractSystem) -> Forced | None:
    """Return a system with forces; None of a free one."""
    return system if isinstance(system, Forced) else None


def refuse_forced(where: str, system: Any) -> None:
    """Refuse a system with forces where only free motions are known."""
    if isinstance(system, Forced):
        remedy = "Ask it of the system inside, or measure it on an orbit of simulate or flow."
        raise error(where, "be a system without forces", "Forced", remedy)
