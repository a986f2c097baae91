r"""The normal form of tops and sleighs of any class: five numbers in the axes of their constraint.

A top on SO(n) turns in the planes $e_i\wedge e_n$ with velocities w; a sleigh on SE(n) in the planes $e_1\wedge e_j$,
while its center of mass advances along $e_1$ with the velocity $u = v_1 + \alpha\cdot w$:

$$ (B + ma_1^2)\,\dot w = (c\cdot w)\,w - |w|^2c - ma_1u\,w, \qquad \dot u = a_1|w|^2 \qquad
   (m = a_1 = 0\ \text{for a top}). $$
"""

import dataclasses
import functools
from typing import TYPE_CHECKING

import numpy as np

from nonholo.base.checks import is_traced, within_memory
from nonholo.base.memo import Keeper
from nonholo.base.numerics import applied
from nonholo.base.types import Array, Float
from nonholo.groups import SE, SO
from nonholo.systems._subspace import sleigh_rows, top_rows

if TYPE_CHECKING:
    from nonholo.systems._base import AbstractLLSystem

_ROUNDING = 1e-13  # relative; what is left of a subspace that is spanned by planes through one axis


@dataclasses.dataclass(frozen=True, eq=False)
class NormalForm(Keeper):
    r"""A top or a sleigh in the axes of its constraint.

    Of many systems in one the numbers have an axis in front.

    The rows of the form are $e_i\wedge e_n$ for a top, $e_1\wedge e_j$ and then the velocity along $e_1$ for a sleigh.

    Attributes:
        across: The mass tensor across the axis, shape (k, k), or its diagonal (k,); of a sleigh about the center of
            mass.
        along: The mass tensor along the axis; together they make the stiffness B.
        coupling: c, shape (k,): the mass tensor between the planes and the axis, for a sleigh with the other sign.
        mass: m; None for a top.
        arm: $a_1$, the coordinate of the center of mass along $e_1$; 0 for a top.
        offset: $\alpha$, its coordinates across, shape (k,); empty for a top.
        frame: These axes as seen from the canonical frame of the system; None where they are the same.
        frame_map: C with r = C r_canonical for momenta along the rows, and y_canonical = y C for charts; None where the
            rows are the same.

    Example:
        >>> sleigh = nh.ChaplyginSleigh(mass=2.0, inertia=1.5, a=0.5).normal_form
        >>> sleigh.stiffness, sleigh.arm, sleigh.is_sleigh, sleigh.is_planar
        (array([[1.5]]), np.float64(0.5), True, True)
        >>> tensor = [[1.0, 0.0, 0.3], [0.0, 2.0, 0.1], [0.3, 0.1, 4.0]]
        >>> nh.LLSystem(nh.SO(3), tensor, annihilator=[[0.0, 0.0, 1.0]]).normal_form.coupling
        array([0.3, 0.1])
        >>> nh.LLSystem(nh.SO(3), tensor, annihilator=np.eye(3)[:2]).normal_form is None
        True
    """

    across: Float[Array, "... k k"] | Float[Array, "k"]
    along: Array
    coupling: Float[Array, "... k"]
    mass: Array = None
    arm: Array = 0.0
    offset: Float[Array, "... j"] = dataclasses.field(default_factory=lambda: np.zeros(0))
    frame: Float[np.ndarray, "... N N"] | None = None
    frame_map: Float[np.ndarray, "... m m"] | None = None

    @functools.cached_property
    def stiffness(self) -> Float[Array, "... k k"] | Float[Array, "k"]:
        r"""B, the mass tensor across the axis plus that along it times Id; its diagonal where that is all there is."""
        if self.is_diagonal:
            return self.across + self.along
        xp = self.across.__array_namespace__()
        along = xp.asarray(self.along)[..., None, None]
        return self.across + along * xp.eye(self.across.shape[-1], dtype=self.across.dtype)

    @property
    def is_sleigh(self) -> bool:
        """Whether the body slides along an axis; otherwise it is a top."""
        return self.mass is not None

    @property
    def is_planar(self) -> bool:
        """Whether two directions are admissible: tops in space and sleighs in the plane, known in closed form."""
        return self.coupling.shape[-1] == (1 if self.is_sleigh else 2)

    @property
    def is_diagonal(self) -> bool:
        """Whether the axes are principal axes of B, which is given by its diagonal."""
        return self.across.ndim == 1

    @property
    def stiffness_matrix(self) -> Float[np.ndarray, "k k"]:
        """The matrix B, whether it is given by its diagonal or not."""
        within_memory("The matrix B of a body", 8.0 * len(self.stiffness) ** 2, "Take a smaller n.")
        return np.diag(self.stiffness) if self.is_diagonal else np.asarray(self.stiffness)

    @property
    def is_coupled(self) -> bool:
        """Whether c is more than rounding."""
        return bool(np.linalg.norm(self.coupling) > 8 * np.finfo(np.float64).eps * np.abs(self.stiffness).max())

    @property
    def turning(self) -> Float[Array, "k k"] | Float[Array, "k"]:
        """The inertia of turning alone, $B + ma_1^2$, as a matrix or a diagonal."""
        if not self.is_sleigh:
            return self.stiffness
        more = self.mass * self.arm**2
        return self.stiffness + (more if self.is_diagonal else more * np.eye(len(self.coupling)))

    @property
    def moments(self) -> Float[np.ndarray, "k"]:
        """The eigenvalues of `turning`, ascending."""
        return np.sort(self.turning) if self.is_diagonal else np.linalg.eigvalsh(self.turning)

    @functools.cached_property
    def principal(self) -> tuple[Float[np.ndarray, "k"], Float[np.ndarray, "k k"] | None]:
        """The diagonal of B in its principal axes, and these as columns; None where they are those of the form."""
        if self.is_diagonal:
            return np.asarray(self.stiffness), None
        b, axes = np.linalg.eigh(self.stiffness)
        return b, axes

    def turned_about(self, momenta: Float[np.ndarray, "... m"], share: float) -> Float[np.ndarray, "... m"]:
        """Return momenta of a sleigh about a point that is moved along the offset by a share of it; those of a top."""
        if not self.is_sleigh:
            return momenta
        along = momenta[..., -1:]
        return np.concatenate([momenta[..., :-1] + share * along * self.offset, along], axis=-1)

    def to_principal(self, vectors: Float[np.ndarray, "... m"]) -> Float[np.ndarray, "... m"]:
        """Return vectors in the principal axes of B; a last component along the blade stays."""
        axes = self.principal[1]
        return vectors if axes is None else _first_turned(vectors, axes)

    def from_principal(self, vectors: Float[np.ndarray, "... m"]) -> Float[np.ndarray, "... m"]:
        """Return vectors in the axes of the form from those in the principal axes of B."""
        axes = self.principal[1]
        return vectors if axes is None else _first_turned(vectors, axes.T)


def _first_turned(vectors: np.ndarray, axes: np.ndarray) -> np.ndarray:
    k = len(axes)
    return np.concatenate([applied(axes.T, vectors[..., :k]), vectors[..., k:]], axis=-1)


def top_form(mass_tensor: Float[Array, "... n n"]) -> NormalForm:
    """Return the form of a top whose axis is the last one."""
    return NormalForm(mass_tensor[..., :-1, :-1], mass_tensor[..., -1, -1], mass_tensor[..., :-1, -1])


def sleigh_form(mass: Array, center_of_mass: Float[Array, "... n"], mass_tensor: Float[Array, "... n n"]) -> NormalForm:
    """Return the form of a sleigh that slides along the first axis, from its mass tensor about the center of mass."""
    J, a = (x if is_traced(x) else np.asarray(x) for x in (mass_tensor, center_of_mass))
    return NormalForm(J[..., 1:, 1:], J[..., 0, 0], -J[..., 0, 1:], mass, a[..., 0], a[..., 1:])


def recognized_form(system: "AbstractLLSystem") -> NormalForm | None:
    """Return the form of a system with a mass tensor, in any axes; None if it has none."""
    tensor, group = system.homogeneous_mass_tensor, system.group
    if tensor is None or is_traced(tensor) or not group.is_rigid or group.size < 3:
        return None
    recognize = {SO(group.size): _recognized_top, SE(group.size - 1): _recognized_sleigh}.get(group)
    return recognize and recognize(system, np.asarray(tensor))


def _recognized_top(system: "AbstractLLSystem", tensor: np.ndarray) -> NormalForm | None:
    n, rows = tensor.shape[-1], system.constraint_subspace
    if len(rows) != n - 1:
        return None
    planes = system.group.hat(np.linalg.qr(rows.T)[0].T)
    axis = np.linalg.eigh(np.einsum("kia,kib->ab", planes, planes))[1][:, -1]
    if not _pass_through(planes, axis):
        return None
    turn = _rotation(np.eye(n)[-1], axis)
    in_axes = turn.T @ tensor @ turn
    return _seen_from(system, top_form((in_axes + in_axes.mT) / 2), turn, top_rows(system.group))


def _recognized_sleigh(system: "AbstractLLSystem", tensor: np.ndarray) -> NormalForm | None:
    n, rows = tensor.shape[-1] - 1, system.constraint_subspace
    if len(rows) != n:
        return None
    velocities = system.group.hat(rows)
    left, sizes, _ = np.linalg.svd(velocities[:, :n, :n].reshape(n, -1))
    if sizes[-1] > _ROUNDING * sizes[0] or sizes[-2] <= _ROUNDING * sizes[0]:
        return None
    along = left[:, -1] @ velocities[:, :n, n]  # the one velocity without rotation
    axis = along / np.linalg.norm(along)
    turning = np.einsum("ki,kab->iab", left[:, :-1] / sizes[:-1], velocities)
    across = -axis @ turning[:, :n, :n]  # x_j of the planes x_j ^ axis
    sideways = turning[:, :n, n] - np.outer(turning[:, :n, n] @ axis, axis)
    shift = float(np.sum(sideways * across) / np.sum(across * across))
    size = np.abs(sideways).max() + abs(shift)
    if not _pass_through(turning[:, :n, :n], axis) or np.abs(sideways - shift * across).max() > _ROUNDING * size:
        return None
    mass, center = tensor[..., -1, -1], tensor[..., :-1, -1] / tensor[..., -1:, -1]
    arm = (axis * center).sum(-1) + shift
    arm = np.where(np.abs(arm) <= _ROUNDING * (np.linalg.norm(center, axis=-1) + abs(shift)), 0.0, arm)[..., None]
    frame = np.broadcast_to(np.eye(n + 1), tensor.shape).copy()
    frame[..., :n, :n] = turn = _rotation(np.eye(n)[0], axis)
    frame[..., :n, n] = center - arm * axis  # the contact point beside the center of mass
    moments = mass[..., None, None] * center[..., :, None] * center[..., None, :]
    about = turn.T @ (tensor[..., :-1, :-1] - moments) @ turn
    form = sleigh_form(mass, turn.T @ axis * arm, (about + about.mT) / 2)
    if n == 2:  # in the plane the moment of inertia is all that counts
        form = dataclasses.replace(form, coupling=np.zeros_like(form.coupling))
    return _seen_from(system, form, frame, sleigh_rows(system.group))


def _pass_through(planes: Float[np.ndarray, "k n n"], axis: Float[np.ndarray, "n"]) -> bool:
    """Return whether bivectors are planes that contain an axis."""
    across = np.eye(len(axis)) - np.outer(axis, axis)
    return bool(np.abs(across @ planes @ across).max() <= _ROUNDING * np.abs(planes).max())


def _rotation(start: Float[np.ndarray, "n"], axis: Float[np.ndarray, "n"]) -> Float[np.ndarray, "n n"]:
    """Return the shortest rotation that takes a unit vector to an axis, or to its opposite where that is nearer."""
    end = axis if start @ axis >= 0 else -axis
    middle = start + end
    return np.eye(len(start)) - np.outer(middle, middle) / (1 + start @ end) + 2 * np.outer(end, start)


def _seen_from(
    system: "AbstractLLSystem", form: NormalForm, frame: Float[np.ndarray, "... N N"], rows: Float[np.ndarray, "m dim"]
) -> NormalForm:
    """Return a form with its frame, and the map of momenta to its rows, as seen from the system."""
    own = None if np.all(frame == system.group.identity) else frame
    if own is None and np.array_equal(rows, system.constraint_subspace):
        return form
    images = rows @ system.group.adjoint(frame).mT
    return dataclasses.replace(form, frame=own, frame_map=images @ np.linalg.pinv(system.constraint_subspace))
