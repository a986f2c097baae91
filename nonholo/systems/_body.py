r"""Bodies as people measure them: mass, center of mass, inertia about it; and what a mass tensor says in those words.

The mass tensor $J = \int r r^T dm$ and the inertia tensor $\mathrm{tr}(J)\,\mathrm{Id} - J$ are distinguished here. Of
a body with mass m, center of mass a and mass tensor $J_C$ about it the tensor about the origin is $J_C + m\,aa^T$
(Steiner), and the homogeneous one has the column $m\,a$ and the corner m besides.
"""

import warnings
from typing import Any

import numpy as np

from nonholo.base.checks import array, error, is_traced, scale, shown, symmetric
from nonholo.base.types import Array, Float
from nonholo.groups import AbstractMatrixGroup
from nonholo.systems._mass import checked_group, inertia_tensor, mass_tensor_from_inertia

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


def mass_tensor_of_body(
    owner: str, mass: Any, inertia: Any, center_of_mass: Any, group: AbstractMatrixGroup
) -> Float[Array, "N N"]:
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
    space = _space(checked_group(where, group))
    if space is None:
        remedy = "Elsewhere pass a mass tensor to the class itself: about the origin it is J_C + m a a^T."
        raise error(where, "be SO(2), SO(3), SE(2) or SE(3), where inertia tensors are", shown(group), remedy)
    n, slides = space
    m = scale(f"{owner}.from_inertia(mass=...)", mass, "Pass the mass of the body.")
    remedy = f"Pass {n} body coordinates, from the {'reference' if slides else 'fixed'} point."
    a = array(f"{owner}.from_inertia(center_of_mass=...)", center_of_mass, (n,), remedy)
    tensor = _about_center(f"{owner}.from_inertia(inertia=...)", inertia, n)
    xp = (m * a @ tensor).__array_namespace__()
    a, tensor = xp.asarray(a), xp.asarray(tensor)
    if not slides:
        return tensor + m * a[:, None] * a
    lever = xp.concatenate([a, xp.ones_like(a[:1])])
    return xp.pad(tensor, ((0, 1), (0, 1))) + m * lever[:, None] * lever


def possible(where: str, mass_tensor: Float[Array, "n n"], depth: int = 3) -> Float[Array, "n n"]:
    """Return a mass tensor, with a warning if no distribution of mass has it; flat bodies have an eigenvalue 0.

    Args:
        where: What gave it.
        mass_tensor: Symmetric.
        depth: Calls up to that of the user.
    """
    if is_traced(mass_tensor):
        return mass_tensor
    eigenvalues = np.linalg.eigvalsh(mass_tensor)
    if eigenvalues[0] < -_ROUNDING * np.abs(eigenvalues).max():
        message = f"`{where}` is of no distribution of mass: the mass tensor has the eigenvalue {eigenvalues[0]:.6g}."
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
    J, space = np.asarray(mass_tensor), _space(group)
    if space is None:
        return {"mass tensor J": J}
    if not space[1]:
        return {"mass tensor J": J, "inertia tensor tr(J) I - J": _inertia(J)}
    found = {"homogeneous mass tensor J": J}
    if J[-1, -1] > 0:
        m, a = J[-1, -1], J[:-1, -1] / J[-1, -1]
        inertia = _inertia(J[:-1, :-1] - m * np.outer(a, a))
        found |= {"mass": np.asarray(m), "center of mass": a, "inertia about the center of mass": inertia}
    return found


def lines_of(shown: dict[str, Float[np.ndarray, "..."]]) -> str:
    """Return named arrays as the lines of a `repr`."""
    lines = (f"{name} = {np.array2string(value, prefix=' ' * (len(name) + 5))}" for name, value in shown.items())
    return ",\n  ".join(lines)


def _inertia(J: np.ndarray) -> np.ndarray:
    return np.asarray(np.trace(J)) if len(J) == 2 else inertia_tensor(J)


def _space(group: AbstractMatrixGroup) -> tuple[int, bool] | None:
    """Return the dimension of space, 2 or 3, and whether bodies move in it or turn about a point; None elsewhere."""
    if not group.is_rigid or group.size > 4:
        return None
    slides = not np.any(group.basis[:, -1])
    n = group.size - int(slides)
    return (n, slides) if n in (2, 3) else None


def _about_center(where: str, inertia: Any, n: int) -> Array:
    """Return the mass tensor about the center of mass."""
    if n == 2:
        moment = scale(where, inertia, "Pass the moment of inertia about the center of mass, a number.")
        return moment / 2 * np.eye(2)
    remedy = "Pass the inertia tensor about the center of mass, (3, 3)."
    tensor = symmetric(where, array(where, inertia, (3, 3), remedy), remedy)
    return possible(where, mass_tensor_from_inertia(tensor), depth=5)
