"""Viscous friction, rows of a constraint that may yield and the body without these, and what a force is made of."""

import dataclasses
import functools
import operator
from collections.abc import Sequence
from typing import Any, ClassVar

import numpy as np
import scipy  # its parts load on first use

from nonholo.base.checks import array, assign, error, is_traced, number, shape_of, shown, within_memory
from nonholo.base.memo import system_memo
from nonholo.base.numerics import applied
from nonholo.base.types import Array, Float
from nonholo.systems._base import AbstractLLSystem, AbstractSystem, AbstractTree, refuse_fixed_in_space
from nonholo.systems._subspace import independent_rows

_ROUNDING = 1e-13  # relative, of an eigenvalue


@dataclasses.dataclass(frozen=True, eq=False)
class Friction(AbstractTree):
    r"""The force $-C\omega$ against a body velocity, with $\omega\cdot C\omega \ge 0$: it never adds energy.

    In steps of order 2 it never adds energy, at any step size; of higher orders see Proposition 18.5. Under the scheme
    "energy" it is $-C X/h$ over a step, which takes $X\cdot CX/h$ exactly; under "variational" half kicks are the exact
    exponentials of $\dot r = -D r$ along the constraint, which stiff friction needs. The antisymmetric part of C, if
    there is one, does no work.

    Args:
        coefficients: C, a matrix (dim, dim), or its diagonal (dim,).

    Raises:
        ValueError: A wrong shape, a value that is not finite, a symmetric part with a negative eigenvalue.

    Example:
        >>> nh.Friction([0.1, 0.3, 0.2]).covector(np.array([1.0, 2.0, 3.0]))
        array([-0.1, -0.6, -0.6])
    """

    coefficients: Array

    def __post_init__(self) -> None:
        where, shape = "Friction(coefficients=...)", shape_of(self.coefficients)
        sizes = (None,) if len(shape) != 2 else (shape[0], shape[0])
        value = array(where, self.coefficients, sizes, "Pass (dim,) coefficients, or a (dim, dim) matrix.")
        if not value.size:
            raise error(where, "have a coefficient for each direction", "none", "Pass (dim,) coefficients.")
        assign(self, coefficients=value)
        if is_traced(value):
            return
        least = np.linalg.eigvalsh((self.matrix + self.matrix.T) / 2).min()
        if least < -_ROUNDING * np.abs(value).max():
            got = f"a symmetric part with eigenvalue {least:.6g}"
            raise error(where, "never add energy", got, "Pass a function for a force that drives.")

    @property
    def matrix(self) -> Float[Array, "dim dim"]:
        """C as a matrix."""
        C = self.coefficients
        within_memory("Friction(coefficients=...)", 8.0 * len(C) ** 2, "Pass one for each direction of the group.")
        return C[:, None] * np.eye(len(C)) if C.ndim == 1 else C

    def check(self, dim: int) -> None:
        """Refuse a group of another dimension."""
        if len(self.coefficients) != dim:
            got = f"shape {self.coefficients.shape}"
            remedy = f"Pass ({dim},) coefficients, or a matrix of this size."
            raise error("Forced(force=Friction(...))", f"have a coefficient for each of {dim} directions", got, remedy)

    def covector(self, body_velocity: Float[Array, "... dim"]) -> Float[Array, "... dim"]:
        """Return the force at body velocities."""
        return applied(self.matrix, -body_velocity)


_IN_SPAN = 1e-10  # relative, of rows that must lie in a span


@dataclasses.dataclass(frozen=True, eq=False)
class Slip(AbstractTree):
    r"""Rows of a constraint that may yield: one contact with dry and viscous friction.

    With the slip velocity $v = A\omega$, A the rows, and the reaction $\lambda$ in $A^T\lambda$:

    $$ v = 0, \quad |\lambda| \le \mu \qquad\text{or}\qquad
       \lambda = -\mu\,\frac{v}{|v|} - c\,v, \quad v \ne 0 . $$

    Several rows are one contact with a cone: $|\lambda|$ is their norm. With rows of unit velocities $\mu$ is a force.
    Several slips in a tuple are contacts with separate grips, each of which holds or slides.

    `discretize` decides at every step whether the rows hold, then takes the step of the system itself, or slide
    (docs/theory/forces.md, Theorem 18.4). T never grows by a slip, at any step size. `flow` goes through phases in
    which each contact holds or slides. Momenta and velocities are those of the system without these rows, and an orbit
    shows the slip: `orbit.body_velocity @ rows.T`, zero while they hold.

    Args:
        rows: A, (s, dim) rows of the system's annihilator, or rows with the span of s of them. The other rows of the
            annihilator always hold.
        grip: $\mu$, the largest reaction that holds; 0 for none, infinite for rows that never yield.
        viscous: c of the sliding rows.

    Raises:
        ValueError: Rows that are dependent or not finite, a grip or a coefficient that is negative; by `Forced`, rows
            that are not of the constraint, a body without one, a constraint fixed in space; by `discretize`, a
            free map that does not keep its energy, the scheme "variational", an order above 2.

    Example:
        A sleigh whose blade holds up to a sideward force of 0.8:

        >>> blade = nh.Slip([[0.0, 0.0, 1.0]], grip=0.8)
        >>> car = nh.Forced(nh.ChaplyginSleigh(1.0, 1.0, 0.5), force=blade)
        >>> orbit = nh.simulate(nh.discretize(car, 0.01), body_velocity=(2.0, 1.0, 0.0), steps=500)
        >>> slip = orbit.body_velocity @ blade.rows[0]
        >>> bool(slip.any()), bool(slip[-1] == 0), bool((np.diff(orbit.energy) < 1e-14).all())
        (True, True, True)
    """

    rows: Array
    grip: Array
    viscous: Array = 0.0
    structure: ClassVar[tuple[str, ...]] = ("rows",)

    def __post_init__(self) -> None:
        where = "Slip(rows=...)"
        rows = array(where, self.rows, (None, None), "Pass (s, dim) rows of the system's annihilator.")
        rows = independent_rows(where, rows, rows.shape[1])
        if not len(rows):
            raise error(where, "have a row", "none", "Pass (s, dim) rows of the system's annihilator.")
        assign(self, rows=rows)
        for name in ("grip", "viscous"):
            place, value = f"Slip({name}=...)", getattr(self, name)
            endless = name == "grip" and isinstance(value, float) and value == np.inf
            value = value if endless else number(place, value, "Pass one number that is not negative.")
            if not is_traced(value) and value < 0:
                raise error(place, "never add energy", f"{value:.6g}", "Pass a number that is not negative.")
            assign(self, **{name: value})


def remaining_rows(system: Any, slips: Sequence[Slip]) -> tuple[Float[np.ndarray, "s dim"], Float[np.ndarray, "j dim"]]:
    """Return the rows of all contacts, checked, and the rows of the annihilator that never yield."""
    where, remedy = "Forced(force=Slip(...))", "Pass rows of the system's annihilator."
    refuse_fixed_in_space(where, system, "Leave the slip out: rows that yield are fixed in the body.")
    for each in slips:
        if each.rows.shape[1] != system.group.dim:
            got = f"rows of {each.rows.shape[1]} numbers"
            raise error(where, f"have rows of {system.group.dim} numbers", got, remedy)
    annihilator, rows = system.annihilator, np.concatenate([each.rows for each in slips])
    if not len(annihilator):
        raise error(where, "have a constraint that can yield", "a free body", "Leave the slip out.")
    size = np.abs(rows @ system.constraint_subspace.T).max(initial=0.0)
    if size > _IN_SPAN * np.abs(rows).max() * np.abs(system.constraint_subspace).max(initial=1.0):
        raise error(where, "vanish on the constraint", f"a row that is {size:.6g} along it", remedy)
    rows = independent_rows("Forced(force=Slip(...))", rows, system.group.dim)
    across = annihilator - annihilator @ np.linalg.pinv(rows) @ rows
    remaining = annihilator[np.linalg.norm(across, axis=1) > _IN_SPAN * np.linalg.norm(annihilator)]
    if len(annihilator) - len(remaining) != len(rows):
        remedy = "Build the LLSystem of annihilator= with the rows that yield and the rows that hold."
        raise error(where, "span the same as rows of the annihilator", f"{len(rows)} rows across them", remedy)
    return rows, remaining


@dataclasses.dataclass(frozen=True, eq=False)
class Widened(AbstractLLSystem):
    r"""A body whose velocity may leave $\mathfrak{d}$ along vectors V with $AV^T = I$ that are orthogonal to it.

    They are orthogonal in the kinetic energy. So momenta along $\mathfrak{d}$ are those of the system inside, and
    $\pi = Mv$ with the slip velocity v and $M = V\mathbb{I}V^T$ are the others.

    Attributes:
        system: The system with its whole constraint.
        rows: A, (s, dim), what may not vanish.
        annihilator: The rows of its annihilator that never yield.
    """

    system: AbstractSystem
    rows: Float[np.ndarray, "s dim"]
    annihilator: Array = None
    structure: ClassVar[tuple[str, ...]] = ("rows", "annihilator")

    def __post_init__(self) -> None:
        """Refuse a slip without inertia, as that of a rod about itself."""
        if is_traced(self.inertia_operator):
            return
        terms = np.abs(self.duals) @ np.abs(self.inertia_operator) @ np.abs(self.duals).T
        units = np.sqrt(np.maximum(terms.diagonal(), np.finfo(np.float64).tiny))
        if not np.abs(np.linalg.eigvalsh(self.slip_inertia / units / units[:, None])).min() > _ROUNDING:
            got, remedy = f"inertia {self.slip_inertia.tolist()}", "Leave the slip out, or give the body this inertia."
            raise error("Forced(force=Slip(...))", "have an inertia along the rows that yield", got, remedy)

    group = property(operator.attrgetter("system.group"))  # type: ignore[assignment]
    homogeneous_mass_tensor = property(operator.attrgetter("system.homogeneous_mass_tensor"))
    inertia_operator = property(operator.attrgetter("system.inertia_operator"))
    frame = property(operator.attrgetter("system.frame"))

    @system_memo
    def duals(self) -> Float[np.ndarray, "s dim"]:
        """V, the velocities of unit slips."""
        system, s = self.system, len(self.rows)
        S = np.asarray(system.constraint_subspace)
        equations = np.concatenate([S @ np.asarray(system.inertia_operator), self.annihilator, self.rows])
        return np.linalg.solve(equations, np.eye(len(equations))[:, -s:]).T

    @system_memo
    def slip_inertia(self) -> Float[np.ndarray, "s s"]:
        """M, by which momenta of slips are their velocities."""
        inertia = self.duals @ np.asarray(self.inertia_operator) @ self.duals.T
        return (inertia + inertia.T) / 2

    @system_memo
    def constraint_subspace(self) -> Float[np.ndarray, "k dim"]:
        """The rows of the system inside, and V."""
        return np.concatenate([self.system.constraint_subspace, self.duals])

    @system_memo
    def inertia_along(self) -> Float[np.ndarray, "k k"]:
        """The operator of the system inside beside M: nothing couples them, not even a rounding error."""
        return scipy.linalg.block_diag(self.system.constrained_inertia, self.slip_inertia)

    @functools.cached_property
    def canonical(self) -> "Widened":  # type: ignore[override]
        """The same body in the canonical frame of the system inside."""
        if self.system.canonical is self.system:
            return self
        adjoint = self.group.adjoint(self.frame)
        return Widened(self.system.canonical, self.rows @ adjoint, self.annihilator @ adjoint)

    @system_memo
    def frame_map(self) -> Float[Array, "k k"]:
        """The frame map of the system inside; the slip is the same in every frame."""
        return scipy.linalg.block_diag(self.system.frame_map, np.eye(len(self.rows)))


def parts_of(force: Any) -> dict[str, Any]:
    """Return friction, slips, table and function of a force, or of a tuple or list of them; of None nothing.

    Rows in a tuple or list are a table, unless friction or a function stands beside them.
    """
    several = isinstance(force, tuple | list) and any(_kind(each) != "table" for each in force)
    forces = force if several else () if force is None else (force,)
    kinds = [_kind(each) for each in forces]
    names = [kind + f" {k}" * (kind == "slip" and "slip" in kinds[:k]) for k, kind in enumerate(kinds)]
    parts = dict(zip(names, forces, strict=True))
    if len(parts) < len(forces):
        remedy = "Add coefficients, rows or functions of one kind together."
        raise error("Forced(force=...)", "have at most one force of each kind but Slip", shown(force), remedy)
    return parts


def slips_of(parts: dict[str, Any]) -> tuple[Slip, ...]:
    """Return the contacts among parts of a force."""
    return tuple(each for name, each in parts.items() if name.startswith("slip"))


def without_slips(parts: dict[str, Any]) -> dict[str, Any]:
    """Return the parts of a force that are no contacts."""
    return {name: each for name, each in parts.items() if not name.startswith("slip")}


def terms_of(potential: Any) -> tuple[Any, ...]:
    """Return the potentials of one, or of a tuple or list of them, with at most one function; of None nothing."""
    terms = tuple(potential) if isinstance(potential, tuple | list) else () if potential is None else (potential,)
    where = "Forced(potential=...)"
    remedy = "Pass a function of a configuration, Gravity, Linear or Spring; Friction and other forces as force=."
    for each in terms:
        if not (callable(each) or hasattr(each, "mean_covector")):
            raise error(where, "be a potential", shown(each), remedy)
    if sum(map(callable, terms)) > 1:
        raise error(where, "have at most one function", shown(potential), "Add them together in one function.")
    return terms


def force_of(parts: dict[str, Any]) -> Any:
    """Return the force of parts: None of nothing, a single one as it is, a tuple of several."""
    forces = tuple(parts.values())
    return forces if len(forces) > 1 else forces[0] if forces else None


def with_later_force(system: Any, force: Any) -> Any:
    """Return the force of a system with one that comes later: beside others a table, which is added."""
    own, parts = parts_of(system.force), parts_of(force)
    tables = [each["table"] for each in (own, parts) if "table" in each]
    if own and parts and (parts.keys() != {"table"} or np.shape(tables[0]) != np.shape(tables[-1])):
        remedy = "Pass all forces at once; a table alone may come later."
        raise error("Forced(system=...)", "have no force yet", shown(system), remedy)
    return force_of(own | parts | ({"table": functools.reduce(operator.add, tables)} if tables else {}))


def refuse_table(where: str, table: Any) -> None:
    """Refuse forces that belong to steps, where they are needed at times."""
    if table is not None:
        remedy = "Discretize the system, or pass a function of time."
        raise error(where, "have forces at times", "one force for each step", remedy)


def _kind(force: Any) -> str:
    return {Friction: "friction", Slip: "slip"}.get(type(force)) or ("function" if callable(force) else "table")
