r"""Mass tensors, inertia tensors and inertia operators; bodies as people measure them, and of high dimension.

The mass tensor $J = \int r r^T dm$ and the inertia tensor $\mathrm{tr}(J)\,\mathrm{Id} - J$ are distinguished here. Of
a body with mass m, center of mass a and mass tensor $J_C$ about it the tensor about the origin is $J_C + m\,aa^T$
(Steiner), and the homogeneous one has the column $m\,a$ and the corner m besides. Of bodies of high dimension full
momenta and matrices are not made.
"""

import dataclasses
import warnings
from typing import Any

import numpy as np

from nonholo.base.checks import array, check_scale, error, instance, is_traced, scale, shown, symmetric
from nonholo.base.numerics import applied
from nonholo.base.types import Array, Float
from nonholo.groups import AbstractMatrixGroup

_SEEN = 1e-14  # squared, of what a step of a tangent map carries
Tensor = Float[Array, "... N N"]
"""A mass tensor, as large as the matrices of its group."""
LARGEST = 100_000
"""Components of the longest full momentum that is made; a momentum of SO(n) has n (n - 1) / 2."""


def narrow(where: str, components: int) -> None:
    """Refuse to make what grows with the square of n, where n is large."""
    if components > LARGEST:
        remedy = "Use restricted_momentum, chart and energy, and reconstruct=False."
        raise error(where, f"have at most {LARGEST} components", f"{components}", remedy)


def refuse_wide(group: AbstractMatrixGroup) -> None:
    """Refuse to make vectors of all components on a group of large dimension."""
    narrow(f"Full vectors of {group}", group.dim)


@dataclasses.dataclass(frozen=True, eq=False)
class WideInertia:
    r"""An inertia along the constraint that is known without its matrix: $w\cdot Dw + m(v + \alpha\cdot w)^2$.

    Attributes:
        turning: The diagonal of D.
        mass: m; None for a body that does not slide, which has no v.
        offset: $\alpha$.
    """

    turning: Float[np.ndarray, "k"]
    mass: Float[np.ndarray, ""] | np.floating | None
    offset: Float[np.ndarray, "k"]

    @property
    def rank(self) -> int:
        """The number of velocities."""
        return len(self.turning) + (self.mass is not None)

    @property
    def dense(self) -> Float[np.ndarray, "k k"]:
        """The matrix."""
        narrow("An inertia matrix", self.rank**2)
        return self.momenta(np.eye(self.rank))

    def momenta(self, velocity: Float[np.ndarray, "... k"]) -> Float[np.ndarray, "... k"]:
        """Return the momenta of velocities."""
        if self.mass is None:
            return velocity * self.turning
        w, v, xp = velocity[..., :-1], velocity[..., -1:], self.turning.__array_namespace__()
        along = self.mass * (v + applied(self.offset[None], w))
        return xp.concatenate([w * self.turning + along * self.offset, along], axis=-1)

    def velocities(self, momenta: Float[np.ndarray, "... k"]) -> Float[np.ndarray, "... k"]:
        """Return the velocities that have these momenta."""
        if self.mass is None:
            return momenta / self.turning
        along, xp = momenta[..., -1:], self.turning.__array_namespace__()
        w = (momenta[..., :-1] - along * self.offset) / self.turning
        return xp.concatenate([w, along / self.mass - applied(self.offset[None], w)], axis=-1)


_MADE = "Of a mass, an inertia and a center of mass `LLSystem.from_inertia` and `RigidBody.from_inertia` make it."


def inertia_tensor(mass_tensor: Float[Array, "... 3 3"]) -> Float[Array, "... 3 3"]:
    r"""Return $\mathrm{tr}(J)\,\mathrm{Id} - J$, the inertia tensor of a body with mass tensor $J = \int r r^T dm$.

    Example:
        >>> inertia_tensor(np.diag([1.0, 2.0, 3.0])).diagonal()
        array([5., 4., 3.])
    """
    xp = mass_tensor.__array_namespace__()
    return xp.linalg.trace(mass_tensor)[..., None, None] * xp.eye(3) - mass_tensor


def mass_tensor_from_inertia(inertia: Float[Array, "3 3"]) -> Float[Array, "3 3"]:
    r"""Return the mass tensor $J = \tfrac12\mathrm{tr}(I)\,\mathrm{Id} - I$ of a body with inertia tensor $I$.

    Raises:
        ValueError: `inertia` is not a finite symmetric (3, 3) matrix.

    Example:
        >>> mass_tensor_from_inertia(np.diag([5.0, 4.0, 3.0])).diagonal()
        array([1., 2., 3.])
    """
    where = "mass_tensor_from_inertia(inertia=...)"
    tensor = symmetric(where, array(where, inertia, (3, 3)), "Pass the inertia tensor about the fixed point.")
    xp = tensor.__array_namespace__()
    return xp.trace(tensor) / 2 * xp.eye(3) - tensor


def extent_of(numbers: Float[np.ndarray, "d"], units: Float[np.ndarray, "d"]) -> float:
    """Return the largest number in its unit; the least and the largest one that are 1 in the user's bound it."""
    if not len(units):
        return 1.0
    return float(np.clip(np.abs(numbers / units).max(), (1 / units).min(), (1 / units).max()))


def reach_of(numbers: Float[np.ndarray, "d"], units: Float[np.ndarray, "d"]) -> Float[np.ndarray, "d"]:
    """Return lengths beside which a place is measured: 1 in each coordinate, or less by its masses and the place."""
    return np.minimum(1.0, units * extent_of(numbers, units))


def alike_in_time(
    maps: Float[np.ndarray, "L d d"], units: Float[np.ndarray, "d"], places: int, duration: float
) -> Float[np.ndarray, "d"]:
    """Return units of places and velocities for a time in which tangent maps carry the one to the other alike.

    It is the duration where they do not, as in free motions, which have no time scale.
    """
    maps = maps * (units / units[:, None])
    forth, back = np.linalg.norm(maps[:, :places, places:]), np.linalg.norm(maps[:, places:, :places])
    time = np.sqrt(forth / back) if forth * back > _SEEN * len(maps) else duration or 1.0
    return units * np.append(np.full(places, time), np.ones(len(units) - places))


def displacement_units(group: AbstractMatrixGroup, inertia: Float[Array, "... dim dim"]) -> Float[Array, "... dim"]:
    """Return units of the algebra: of a body radians and its length, in which slides have about the energy of turns.

    Of other groups those in which each velocity has the same energy and no bracket of two is above 1; where products of
    inertia show that not all have one, there are no units but the user's.
    """
    xp = inertia.__array_namespace__()
    energies = xp.abs(xp.linalg.diagonal(inertia))
    if not group.is_rigid:
        products = xp.sqrt(energies[..., :, None] * energies[..., None, :])
        is_definite = xp.all(xp.abs(inertia) <= 2 * products, axis=(-2, -1))[..., None]
        units, everything = 1 / xp.sqrt(xp.where(is_definite & (energies > 0), energies, 1.0)), np.eye(group.dim)
        brackets = np.abs(group.bracket(everything[:, None], everything[None]))
        along, across, beside = units[..., :, None, None], units[..., None, :, None], units[..., None, None, :]
        largest = xp.max(brackets * (along * across / beside), axis=(-3, -2, -1))
        return units / xp.where((largest > 0)[..., None] & is_definite, largest[..., None], 1.0)
    slides = ~np.any(group.basis[:, : group.point_size, : group.point_size], axis=(1, 2))
    if not slides.any():
        return xp.ones_like(energies)
    length = xp.sqrt(xp.mean(energies[..., ~slides], axis=-1) / xp.mean(energies[..., slides], axis=-1))
    return xp.where(xp.asarray(slides), xp.where(length > 0, length, 1.0)[..., None], 1.0)


def direction_lengths(rows: Float[np.ndarray, "k dim"], units: Float[np.ndarray, "... dim"]) -> Any:
    """Return lengths of rows in units of displacements: momenta are alike to them, velocities to their inverse."""
    return np.linalg.norm(rows / units[..., None, :], axis=-1)


def inertia_form(group: AbstractMatrixGroup, matrices: Array, mass_tensor: Tensor) -> Float[Array, "... k k"]:
    r"""Return $\bigl(\mathrm{tr}(D_i\mathbb{J}D_j^*)\bigr)_{ij}$ for velocities $D_i$ and a (homogeneous) mass tensor.

    A body that moves with the velocity $\xi$, a matrix, has kinetic energy $\tfrac12\mathrm{tr}(\xi\mathbb{J}\xi^*)$;
    the star is the transpose but for a group with a form (`AbstractMatrixGroup.form_adjoint`).
    """
    matrices = mass_tensor.__array_namespace__().asarray(matrices)
    entries, momenta = matrices.shape[-1] ** 2, matrices @ mass_tensor[..., None, :, :]
    duals = group.form_adjoint(matrices).mT.reshape(-1, entries)
    return momenta.reshape(*momenta.shape[:-2], entries) @ duals.T


def inertia_from_mass_tensor(group: AbstractMatrixGroup, mass_tensor: Tensor) -> Float[Array, "... dim dim"]:
    r"""Return the inertia operator $\mathbb{I}_{ij} = \mathrm{tr}(E_i\mathbb{J}E_j^*)$ in the basis $E_i$.

    Example:
        >>> inertia_from_mass_tensor(SO(3), np.diag([1.0, 2.0, 3.0])).diagonal()
        array([5., 4., 3.])
    """
    narrow(f"The inertia operator on {group}", group.dim)
    return inertia_form(group, group.basis, mass_tensor)


def body_tensor(where: str, value: Array, remedy: str) -> Array:
    """Return a symmetric (n, n) mass tensor, n >= 3."""
    tensor = array(where, value, (None, None), remedy)
    rows, columns = tensor.shape
    if rows != columns or rows < 3:
        raise error(where, "have shape (n, n) with n >= 3", f"shape {tensor.shape}", remedy)
    return symmetric(where, tensor, remedy)


def checked_group(where: str, group: Any) -> AbstractMatrixGroup:
    """Refuse what is not a matrix group."""
    remedy = "Pass SO(n), SE(n), or MatrixGroup(basis)."
    return instance(where, group, AbstractMatrixGroup, "be a matrix group", remedy)


def group_mass_tensor(where: str, group: AbstractMatrixGroup, value: Array, instead: str) -> Array:
    """Return a symmetric mass tensor on which the matrices of SO(n) or SE(n) act; refuse it on other groups."""
    if not group.is_rigid:
        reason = f"the group {group!r}, which does not move the points of a rigid body"
        raise error(where, "be used on SO(n) or SE(n)", reason, instead)
    size = group.identity.shape[0]
    remedy = f"On {group!r} the mass tensor is ({size}, {size}): J on SO(n), homogeneous on SE(n). {_MADE}"
    return symmetric(where, array(where, value, (size, size), remedy), remedy)


def form_mass_tensor(where: str, group: AbstractMatrixGroup, value: Array) -> Array:
    r"""Return a mass tensor of a group with a form, refused unless $J^* = G^{-1}J^TG = J$."""
    size = group.identity.shape[0]
    remedy = "If G is symmetric or antisymmetric pass (J + J*)/2, which has the same kinetic energy."
    tensor = array(where, value, (size, size), f"On {group!r} the mass tensor is ({size}, {size}).")
    if is_traced(tensor):
        return tensor
    check_scale(where, tensor)
    gap, G = np.abs(group.form_adjoint(tensor) - tensor).max(), np.asarray(group.form)
    sizes = np.abs(np.linalg.inv(G)) @ np.abs(tensor).T @ np.abs(G)
    if gap > 64 * np.finfo(np.float64).eps * sizes.max():
        raise error(where, "satisfy J* = G^-1 J^T G = J", f"a residual of {gap:.3g}", remedy)
    return tensor


def rotation_to(axis: np.ndarray) -> np.ndarray:
    """Return the shortest rotation taking e3 to the unit vector `axis`; diag(1, -1, -1) for -e3, to 1e-150."""
    x, y, z = axis
    if z < 0 and x * x + y * y < 1e-300:  # whose squares underflow
        return np.diag([1.0, -1.0, -1.0])
    scale = 1 / (1 + z) if z > -0.5 else (1 - z) / (x * x + y * y)
    return np.array([[1 - scale * x * x, -scale * x * y, x], [-scale * x * y, 1 - scale * y * y, y], [-x, -y, z]])


_ROUNDING = 1e-12  # of the largest eigenvalue


class ImpossibleBodyWarning(UserWarning):
    """An inertia tensor that no distribution of mass has: one principal moment is larger than the other two together.

    The mass tensor has a negative eigenvalue then. The equations still hold, as long as kinetic energies are positive.

    Example:
        >>> import warnings
        >>> with warnings.catch_warnings(record=True) as caught:
        ...     warnings.simplefilter("always")
        ...     top = nh.SuslovTop.from_inertia(np.diag([5.0, 1.0, 1.0]))
        >>> caught[0].category.__name__, top.mass_tensor.diagonal()
        ('ImpossibleBodyWarning', array([-1.5,  2.5,  2.5]))
    """


def mass_tensor_of_body(owner: str, mass: Any, inertia: Any, center_of_mass: Any, group: Any) -> Float[Array, "N N"]:
    r"""Return the mass tensor on which the matrices of SO(n) or SE(n), n = 2 or 3, act; refuse other groups.

    $$ J_C = \tfrac12\mathrm{tr}(I_C)\,\mathrm{Id} - I_C, \qquad
       \mathbb{J} = J_C + m\,aa^T \ \text{on SO(n)}, \qquad
       \mathbb{J} = \begin{pmatrix} J_C + m\,aa^T & m\,a\\ m\,a^T & m\end{pmatrix} \ \text{on SE(n)}; $$

    in the plane $J_C = \tfrac12 I_C\,\mathrm{Id}$, of which the motion knows the trace alone.

    Example:
        >>> from nonholo.groups import SE
        >>> mass_tensor_of_body("RigidBody", 2.0, 1.0, [0.5, 0.0], SE(2))
        array([[1. , 0. , 1. ],
               [0. , 0.5, 0. ],
               [1. , 0. , 2. ]])
    """
    where = f"{owner}.from_inertia(group=...)"
    if not _has_inertia_tensor(checked_group(where, group)):
        remedy = "Elsewhere pass a mass tensor to the class itself: about the origin it is J_C + m a a^T."
        raise error(where, "be SO(2), SO(3), SE(2) or SE(3), where inertia tensors are", shown(group), remedy)
    n, slides = group.point_size, group.is_affine
    m = scale(f"{owner}.from_inertia(mass=...)", mass, "Pass the mass of the body.")
    remedy = f"Pass {n} body coordinates, from the {'reference' if slides else 'fixed'} point."
    a = array(f"{owner}.from_inertia(center_of_mass=...)", center_of_mass, (n,), remedy)
    tensor = _about_center(f"{owner}.from_inertia(inertia=...)", inertia, n)
    xp = (m * a @ tensor).__array_namespace__()
    a, tensor = xp.asarray(a), xp.asarray(tensor)
    return with_mass(tensor, m, a) if slides else tensor + m * a[:, None] * a


def with_mass(tensor: Float[Array, "k k"], mass: Array, center: Float[Array, "k"]) -> Float[Array, "k+1 k+1"]:
    r"""Return a form about a center with one more row, that of the mass there: $J + m\,(a, 1)(a, 1)^T$."""
    xp = center.__array_namespace__()
    lever = xp.concatenate([center, xp.ones_like(center[:1])])
    return xp.pad(tensor, ((0, 1), (0, 1))) + mass * lever[:, None] * lever


def possible(where: str, mass_tensor: Float[Array, "n n"], depth: int = 3) -> Float[Array, "n n"]:
    """Return a mass tensor, with a warning if no distribution of mass has it; flat bodies have an eigenvalue 0.

    Args:
        where: Its source, for errors.
        mass_tensor: Symmetric.
        depth: Calls up to that of the user.
    """
    if is_traced(mass_tensor):
        return mass_tensor
    eigenvalues = np.linalg.eigvalsh(mass_tensor)
    if eigenvalues[0] < -_ROUNDING * np.abs(eigenvalues).max():
        message = f"No distribution of mass has `{where}`: its mass tensor has the eigenvalue {eigenvalues[0]:.6g}."
        remedy = "No principal moment of inertia is larger than the other two together. Check the numbers."
        warnings.warn(f"{message} {remedy}", ImpossibleBodyWarning, stacklevel=depth)
    return mass_tensor


def tensors_shown(group: AbstractMatrixGroup, mass_tensor: Float[Array, "N N"]) -> dict[str, Float[np.ndarray, "..."]]:
    r"""Return what a mass tensor says of a body, by name: itself, and for n = 2, 3 the inertia that belongs to it.

    Example:
        >>> from nonholo.groups import SE
        >>> list(tensors_shown(SE(2), np.diag([1.0, 2.0, 2.0])).values())[1:]
        [array(2.), array([0., 0.]), array(3.)]
    """
    J = np.asarray(mass_tensor)
    if not _has_inertia_tensor(group):
        return {"mass tensor J": J}
    if not group.is_affine:
        return {"mass tensor J": J, "inertia tensor tr(J) I - J": _inertia(J)}
    facts = {"homogeneous mass tensor J": J}
    if J[-1, -1] > 0:
        m, a = J[-1, -1], J[:-1, -1] / J[-1, -1]
        inertia = _inertia(J[:-1, :-1] - m * np.outer(a, a))
        facts |= {"mass": np.asarray(m), "center of mass": a, "inertia about the center of mass": inertia}
    return facts


def lines_of(arrays: dict[str, Float[np.ndarray, "..."]]) -> str:
    """Return named arrays as the lines of a `repr`."""
    lines = (f"{name} = {np.array2string(value, prefix=' ' * (len(name) + 5))}" for name, value in arrays.items())
    return ",\n  ".join(lines)


def _inertia(J: np.ndarray) -> np.ndarray:
    return np.asarray(np.trace(J)) if len(J) == 2 else inertia_tensor(J)


def _has_inertia_tensor(group: AbstractMatrixGroup) -> bool:
    """Return whether a body moves in the plane or in space, or turns there about a point."""
    return group.is_rigid and group.size <= 4 and group.point_size <= 3


def _about_center(where: str, inertia: Any, n: int) -> Array:
    """Return the mass tensor about the center of mass."""
    if n == 2:
        moment = scale(where, inertia, "Pass the moment of inertia about the center of mass, a number.")
        return moment / 2 * np.eye(2)
    remedy = "Pass the inertia tensor about the center of mass, (3, 3)."
    tensor = symmetric(where, array(where, inertia, (3, 3), remedy), remedy)
    return possible(where, mass_tensor_from_inertia(tensor), depth=5)


def arrow_numbers(owner: str, diagonal: object, coupling: object) -> tuple[np.ndarray, np.ndarray]:
    """Return the checked numbers of an arrowhead, a mass tensor of a diagonal and one row and column.

    Every mass tensor takes this form in the axes that diagonalize the constrained inertia, so nothing is lost; and
    nothing of size n x n is ever made.
    """
    where = f"{owner}(diagonal=...)"
    d = array(where, diagonal, (None,), "Pass the n entries of the diagonal.")
    if len(d) < 3:
        raise error(where, "have at least 3 entries", f"{len(d)}", "In the plane use `ChaplyginSleigh`.")
    check_scale(where, d)
    c = array(f"{owner}(coupling=...)", coupling, (len(d) - 1,), f"Pass the {len(d) - 1} entries beside the corner.")
    return d, c


def arrowhead(owner: str, diagonal: Array, coupling: Array, corner: int) -> Float[Array, "n n"]:
    """Return the matrix of an arrowhead, whose row and column meet in the first corner, 0, or the last, -1."""
    n, xp = len(diagonal), diagonal.__array_namespace__()
    narrow(f"A dense mass tensor of {owner}", n * (n - 1) // 2)
    place, row = xp.eye(n)[corner], xp.roll(xp.concatenate([xp.zeros(1), coupling]), corner)
    return xp.diag(diagonal) + xp.outer(place, row) + xp.outer(row, place)


def refuse_negative(where: str, inertia: WideInertia) -> None:
    """Refuse an inertia along the constraint that is not positive."""
    turning = inertia.turning
    if not is_traced(turning) and not turning.min() > 0:
        got = f"{turning.min():.3g} at entry {int(np.argmin(turning))}"
        raise error(where, "give a positive inertia along the constraint", got, "Pass the mass tensor of a body.")
