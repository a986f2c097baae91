"""Viscous friction: a force against the body velocity, linear in it."""

import dataclasses
from typing import ClassVar

import numpy as np

from nonholo.base.checks import array, error, is_traced, shape_of
from nonholo.base.limits import within_memory
from nonholo.base.numerics import applied
from nonholo.base.types import Array, Float

_ROUNDING = 1e-13  # relative, of an eigenvalue


@dataclasses.dataclass(frozen=True, eq=False)
class Friction:
    r"""The force $-C\omega$ against a body velocity, with $\omega\cdot C\omega \ge 0$: it never adds energy.

    It never adds energy, at any step size. Under the scheme "energy" it is $-C X/h$ over a step, which takes
    $X\cdot CX/h$ exactly; under "variational" half kicks are the exact exponentials of $\dot r = -D r$ along the
    constraint, which stiff friction needs. The antisymmetric part of C, if there is one, does no work.

    Args:
        coefficients: C, a matrix (dim, dim), or its diagonal (dim,).

    Raises:
        ValueError: A wrong shape, a value that is not finite, a symmetric part with a negative eigenvalue.

    Example:
        >>> nh.Friction([0.1, 0.3, 0.2]).covector(np.array([1.0, 2.0, 3.0]))
        array([-0.1, -0.6, -0.6])
    """

    coefficients: Array
    leaves: ClassVar[tuple[str, ...]] = ("coefficients",)
    structure: ClassVar[tuple[str, ...]] = ()

    def __post_init__(self) -> None:
        where, shape = "Friction(coefficients=...)", shape_of(self.coefficients)
        wanted = (None,) if len(shape) != 2 else (shape[0], shape[0])
        value = array(where, self.coefficients, wanted, "Pass (dim,) coefficients, or a (dim, dim) matrix.")
        if not value.size:
            raise error(where, "have a coefficient for each direction", "none", "Pass (dim,) coefficients.")
        object.__setattr__(self, "coefficients", value)
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
