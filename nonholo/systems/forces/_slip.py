"""Rows of a constraint that may yield: they hold up to a grip, and slide with friction beyond it."""

import dataclasses
from typing import Any, ClassVar

import numpy as np

from nonholo.base.checks import array, error, is_traced, number
from nonholo.base.types import Array, Float
from nonholo.systems._subspace import independent_rows

_ROUNDING = 1e-10  # relative, of rows that must lie in a span


@dataclasses.dataclass(frozen=True, eq=False)
class Slip:
    r"""Rows of a constraint that may yield: one contact with dry and viscous friction.

    With the slip velocity $v = A\omega$, A the rows, and the reaction $\lambda$ in $A^T\lambda$:

    $$ v = 0, \quad |\lambda| \le \mu \qquad\text{or}\qquad
       \lambda = -\mu\,\frac{v}{|v|} - c\,v, \quad v \ne 0 . $$

    Several rows are one contact with a cone: $|\lambda|$ is their norm. Rows of unit velocities make $\mu$ a force.

    `discretize` decides at every step whether the rows hold, then takes the step of the system itself, or slide
    (docs/theory/forces.md, Theorem 18.4). T never grows by a slip, at any step size. Momenta and velocities are those
    of the system without these rows, and an orbit shows the slip: `orbit.body_velocity @ rows.T`, zero while they hold.

    Args:
        rows: A, (s, dim) rows of the system's annihilator, or others that span the same as s of them. The other rows of
            the annihilator always hold.
        grip: $\mu$, the largest reaction that holds; 0 for none, infinite for rows that never yield.
        viscous: c of the sliding rows.

    Raises:
        ValueError: Rows that are dependent or not finite, a grip or a coefficient that is negative; by `Forced`, rows
            that are not those of the constraint, a body without one, a constraint fixed in space; by `discretize`, a
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
    leaves: ClassVar[tuple[str, ...]] = ("grip", "viscous")
    structure: ClassVar[tuple[str, ...]] = ("rows",)

    def __post_init__(self) -> None:
        where = "Slip(rows=...)"
        rows = array(where, self.rows, (None, None), "Pass (s, dim) rows of the system's annihilator.")
        rows = independent_rows(where, rows, rows.shape[1])
        if not len(rows):
            raise error(where, "have a row", "none", "Pass (s, dim) rows of the system's annihilator.")
        object.__setattr__(self, "rows", rows)
        for name in ("grip", "viscous"):
            value, given = f"Slip({name}=...)", getattr(self, name)
            endless = name == "grip" and isinstance(given, float) and given == np.inf
            given = given if endless else number(value, given, "Pass one number that is not negative.")
            if not is_traced(given) and given < 0:
                raise error(value, "never add energy", f"{given:.6g}", "Pass a number that is not negative.")
            object.__setattr__(self, name, given)

    def check(self, system: Any) -> None:
        """Refuse a system whose constraint does not have the rows."""
        where, remedy = "Forced(force=Slip(...))", "Pass rows of the system's annihilator."
        if system.is_spatial:
            remedy = "Leave the slip out: rows that yield are fixed in the body."
            raise error(where, "have a constraint fixed in the body", "one fixed in space", remedy)
        if self.rows.shape[1] != system.group.dim:
            got = f"rows of {self.rows.shape[1]} numbers"
            raise error(where, f"have rows of {system.group.dim} numbers", got, remedy)
        if not len(system.annihilator):
            raise error(where, "have a constraint that can yield", "a free body", "Leave the slip out.")
        size = np.abs(self.rows @ system.constraint_subspace.T).max(initial=0.0)
        if size > _ROUNDING * np.abs(self.rows).max() * np.abs(system.constraint_subspace).max(initial=1.0):
            raise error(where, "vanish on the constraint", f"a row that is {size:.6g} along it", remedy)
        if len(system.annihilator) - len(self.remaining(system)) != len(self.rows):
            remedy = "Build the LLSystem of annihilator= with the rows that yield and the rows that hold."
            got = f"{len(self.rows)} rows across them"
            raise error(where, "span the same as rows of the annihilator", got, remedy)

    def remaining(self, system: Any) -> Float[np.ndarray, "j dim"]:
        """Return the rows of the annihilator of a system that never yield."""
        across = system.annihilator - system.annihilator @ np.linalg.pinv(self.rows) @ self.rows
        return system.annihilator[np.linalg.norm(across, axis=1) > _ROUNDING * np.linalg.norm(system.annihilator)]
