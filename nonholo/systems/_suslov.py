"""The Suslov top: a rigid body about a fixed point that may not spin about one of its own axes."""

import dataclasses
from typing import ClassVar

import numpy as np

from nonholo._checks import array, error, is_traced, positive_definite, symmetric
from nonholo._types import Array, Float
from nonholo.groups import SO, AbstractMatrixGroup
from nonholo.systems._base import AbstractLLSystem, Equilibria
from nonholo.systems._mass import inertia_tensor, mass_tensor_from_inertia, rotation_to


@dataclasses.dataclass(frozen=True, repr=False, eq=False)
class SuslovTop(AbstractLLSystem):
    r"""A top on SO(3) whose body angular velocity has no component along the body axis `axis`.

    $$ l(\omega) = \tfrac12 \mathrm{tr}(\hat\omega J \hat\omega^T), \qquad \langle\gamma, \omega\rangle = 0, $$

    with the mass tensor $J = \int r r^T dm$ (not the inertia tensor $\mathrm{tr}(J)\,\mathrm{Id} - J$; `from_inertia`
    takes that one). For $\gamma = e_3$ write $J = \begin{pmatrix} A & c \\ c^T & d\end{pmatrix}$: then
    $B = A + d\,\mathrm{Id}$ is the constrained inertia and $c$ the `coupling`, which drives the top from one permanent
    rotation to another.

    Reference: [fedorov-zenkov-2004], section 4.

    Args:
        mass_tensor: Symmetric (3, 3) with positive definite B; flat and rod-like bodies are allowed.
        axis: Forbidden body axis, a unit vector.

    Raises:
        ValueError: A shape, an asymmetry, a value that is not finite, or B not positive definite.

    Example:
        >>> top = SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]])
        >>> top.constrained_inertia
        array([[2.3, 0.2],
               [0.2, 1.9]])
    """

    mass_tensor: Array
    axis: Array = dataclasses.field(default=(0.0, 0.0, 1.0), kw_only=True)
    group: ClassVar[AbstractMatrixGroup] = SO(3)

    def __post_init__(self) -> None:
        where = "SuslovTop(mass_tensor=...)"
        remedy = "Pass the mass tensor J, not the inertia tensor; `SuslovTop.from_inertia` takes that one."
        tensor = symmetric(where, array(where, self.mass_tensor, (3, 3), remedy), remedy)
        object.__setattr__(self, "mass_tensor", tensor)
        object.__setattr__(self, "axis", _unit_vector("SuslovTop(axis=...)", self.axis))
        positive_definite(where, self.constrained_inertia, "the inertia along the constraint", remedy)

    @classmethod
    def from_inertia(cls, inertia: Array, axis: Array = (0.0, 0.0, 1.0)) -> "SuslovTop":
        """Build a top from its inertia tensor and the forbidden body axis; everything stays in the user's body frame.

        Example:
            >>> SuslovTop.from_inertia(np.diag([3.0, 2.0, 1.5]), axis=(0, 1, 0)).annihilator
            array([[0., 1., 0.]])
        """
        where = "SuslovTop.from_inertia(inertia=...)"
        tensor = symmetric(where, array(where, inertia, (3, 3)), "Pass the inertia tensor about the fixed point.")
        return cls(mass_tensor_from_inertia(tensor), axis=axis)

    def __repr__(self) -> str:
        shown = (np.array2string(np.asarray(m), prefix=" " * 17) for m in (self.mass_tensor, self.inertia_operator))
        mass, inertia = shown
        return (
            f"SuslovTop(axis={np.asarray(self.axis).tolist()},\n  mass tensor J = {mass},\n  inertia tensor  {inertia})"
        )

    @property
    def homogeneous_mass_tensor(self) -> Float[Array, "3 3"]:
        """The mass tensor itself."""
        return self.mass_tensor

    @property
    def inertia_operator(self) -> Float[Array, "3 3"]:
        r"""The inertia tensor $\mathrm{tr}(J)\,\mathrm{Id} - J$."""
        return inertia_tensor(self.mass_tensor)

    @property
    def constraint_subspace(self) -> Float[np.ndarray, "2 3"]:
        """Rows S(0, 1, 0) and S(-1, 0, 0), with S the shortest rotation taking e3 to the axis."""
        return np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]) @ self.frame.T

    @property
    def annihilator(self) -> Float[np.ndarray, "1 3"]:
        """The forbidden axis."""
        return np.array(self.axis)[None, :]

    @property
    def frame(self) -> Float[np.ndarray, "3 3"]:
        """The shortest rotation taking e3 to the forbidden axis."""
        return rotation_to(self.axis)

    @property
    def canonical(self) -> "SuslovTop":
        """The same top in body axes whose third one is the forbidden axis."""
        if np.array_equal(self.axis, (0.0, 0.0, 1.0)):
            return self
        turned = self.frame.T @ self.mass_tensor @ self.frame
        return SuslovTop((turned + turned.T) / 2)

    @property
    def coupling(self) -> Float[Array, "2"]:
        """The vector c of the mass tensor in the canonical frame; zero for a balanced top."""
        return self.canonical.mass_tensor[:2, 2]

    def equilibria(self) -> Equilibria:
        """Return the permanent rotations: the line spanned by c, its negative half attracting; all of d if c = 0.

        Example:
            >>> SuslovTop([[1.0, 0.0, 0.5], [0.0, 1.0, 0.0], [0.5, 0.0, 1.0]]).equilibria().attracting
            array([-0. , -0.5, -0. ])
        """
        if np.linalg.norm(self.coupling) <= 8 * np.finfo(np.float64).eps * np.abs(self.mass_tensor).max():
            return Equilibria(self.constraint_subspace, None)
        line = self.coupling @ self.constraint_subspace
        return Equilibria(line[None, :], -line)


def _unit_vector(where: str, value: Array) -> Array:
    axis = array(where, value, (3,), "Pass a unit vector in body coordinates.")
    if is_traced(axis):
        raise error(where, "be concrete", "a traced value", "Differentiate with respect to mass_tensor instead.")
    length = np.linalg.norm(axis)
    if abs(length - 1) > 1e-12:
        raise error(where, "be a unit vector", f"length {length:.17g}", "Divide it by its length.")
    return axis
