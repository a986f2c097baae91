"""`accessibility`: the directions in which brackets of admissible velocities lead."""

import dataclasses
from typing import Any

import numpy as np

from nonholo.analysis.locomotion._connection import checked_system
from nonholo.base.checks import array, count, error, needs
from nonholo.base.types import Float

_MOST = 8  # the longest bracket: their derivatives are tensors of that order
_RANK = 1e-9  # of singular values, relative to the largest


@dataclasses.dataclass(frozen=True, eq=False)
class Accessibility:
    r"""How the brackets of admissible velocities grow at a configuration.

    Attributes:
        growth: The ranks of $D \subset D + [D, D] \subset \dots$, as far as they were computed.
        directions: An orthonormal basis of the last of them, in rows.
        is_accessible: Whether every direction is among them; under holonomic constraints every one along their surface.
    """

    growth: tuple[int, ...]
    directions: Float[np.ndarray, "r n"]
    is_accessible: bool


def accessibility(system: Any, configuration: Any, *, depth: int | None = None) -> Accessibility:
    r"""Return the directions to which brackets of admissible velocities lead from a configuration.

    $$ D_1 = D = \{v : A(q)\,v = 0\}, \qquad D_{i+1} = D_i + [D, D_i], \qquad
       \text{growth} = (\dim D_1, \dim D_2, \dots). $$

    If some $D_i$ is all of $\mathbb R^n$, motions along the constraint lead to every neighbor (Chow and Rashevskii). Of
    a kinematic system, whose shape moves as its owner likes, this is controllability. Otherwise it says that no
    part of the constraint is integrable; what can be reached with forces on the shape alone is another question. The
    gradients of holonomic constraints are rows of A.

    Derivatives of the constraints are by JAX; ranks count singular values above $10^{-9}$ of the largest, so
    choose units in which coordinates are of one size.

    Args:
        system: A `LagrangeDAlembert` system whose constraints do not depend on time, or a `ShapedBody`, whose
            directions are $(\xi, \dot s)$. Prescribed motions and forces are left aside.
        configuration: q; of a `ShapedBody` the shape s, which is all that matters.
        depth: The longest brackets, at most 8; by default n - dim D + 1, enough wherever the ranks are constant nearby.

    Raises:
        ValueError: Another system, a wrong shape, constraints that are dependent or infinite at q, or holonomic ones
            that q does not satisfy.

    Example:
        >>> ready = nh.examples.kinematic_car()
        >>> nh.accessibility(ready.system, ready.configuration).growth
        (2, 3, 4, 5)
    """
    with needs("jax", "accessibility"):
        from nonholo.analysis.locomotion import _brackets
    where = "accessibility(configuration=...)"
    rows, q, whole = _constraints(where, system, configuration)
    forms = _brackets.forms_at(rows, q)
    rank = np.linalg.matrix_rank(forms) if np.isfinite(forms).all() else -1
    if rank < len(forms):
        remedy = "Choose another configuration, or drop constraints that follow from others."
        raise error(where, "have independent constraints", f"{forms.tolist()}", remedy)
    longest = rank + 1 if depth is None else count("accessibility(depth=...)", depth, "Pass a length of brackets.")
    if longest > _MOST:
        remedy = "Pass a smaller `depth=`: higher derivatives grow too large."
        raise error("accessibility(depth=...)", f"be at most {_MOST}", str(longest), remedy)
    growth, fields = [], np.zeros((len(q), 0))
    for longer in _brackets.brackets(rows, q, longest):
        fields = np.hstack([fields, longer])
        growth.append(int(np.linalg.matrix_rank(fields, rtol=_RANK)))
        if growth[-1] == whole:
            break
    directions = np.linalg.svd(fields)[0][:, : growth[-1]].T
    return Accessibility(tuple(growth), directions, growth[-1] == whole)


def _constraints(where: str, system: Any, configuration: Any) -> tuple[Any, Float[np.ndarray, "n"], int]:
    """Return the function of the constraint forms with its system, the checked place, and the reach of brackets."""
    from nonholo.analysis.locomotion import _reduction
    from nonholo.lagrange_dalembert import checked_state, equations

    has_shape = hasattr(system, "shape_coordinates")
    own: Any = _reduction.Reduced(system) if has_shape else checked_system("accessibility", system)
    names = system.shape_coordinates if has_shape else own.coordinates
    q = array(where, configuration, (len(names),), f"Pass {len(names)} coordinates.")
    if has_shape:
        q = np.append(np.zeros(system.group.dim), q)
        return (_reduction.Reduced.constraint_forms, own), q, len(q)
    if own.holonomic is not None:
        checked_state(own, q, {"body_velocity": np.zeros(len(q))}, 0.0, "accessibility")
    return (equations.forms, own), q, len(q) - (own.constraints - own.velocity_constraints)
