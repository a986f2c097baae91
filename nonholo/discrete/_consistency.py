"""Whether a displacement variety fits the map that its discrete Lagrangian was made with."""

from collections.abc import Callable

import numpy as np

from nonholo.base.checks import error, function, needs
from nonholo.base.types import Array
from nonholo.discrete._discretization import Discretization, as_discretization

_SAMPLES = 16


def consistency_defect(discrete: Discretization, discretization_map: Callable[[Array], Array] | None = None) -> float:
    r"""Return how far a displacement variety is from consistency with a discretization map; zero if it is consistent.

    A discrete Lagrangian that comes from a continuous one by a map $\Psi$ from displacements to velocities,
    $l_d(W) = h\,l(\Psi(W))$, has the consistent variety $\{W : \langle a^j, \Psi(W)\rangle = 0\}$. What is returned is
    the largest $|\langle a^j, \Psi(W)\rangle|$ at displacements W drawn from the variety, with rows $a^j$ and
    velocities of length one. Consistency does not conserve energy, nor does its absence spoil it: "matrix" is
    consistent with "naive" and conserves with "skew".

    Reference: [fedorov-zenkov-2004], section 2, the remark on discretization mappings.

    Args:
        discrete: The discretized system.
        discretization_map: W -> coordinates of the velocity, for one JAX matrix, up to a factor. By default that of the
            difference: the projection of W - I to the algebra for "matrix", log W for "logarithmic".

    Raises:
        ValueError: No map for a difference that is a callable, or one with a wrong result.

    Example:
        >>> sleigh = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1, constraint="naive")
        >>> consistency_defect(sleigh) < 1e-14
        True
        >>> consistency_defect(nh.discretize(sleigh.system, 0.1)) > 0.01
        True
    """
    as_discretization("consistency_defect(discrete=...)", discrete)
    with needs("jax", "consistency_defect(...)"):
        from nonholo.discrete.definition import map_each, sample_displacements

    group, annihilator = discrete.system.group, np.asarray(discrete.system.annihilator)
    where = "consistency_defect(discretization_map=...)"
    own = {"matrix": lambda W: group.vee(W - group.identity), "logarithmic": group.log}
    if discretization_map is not None:
        function(where, discretization_map)
        velocities = map_each(discretization_map, sample_displacements(discrete, _SAMPLES))
    elif callable(discrete.difference):
        got = "none, with a callable difference"
        raise error(where, "be given", got, "Pass the map W -> velocity that the difference was made with.")
    else:
        velocities = own[discrete.difference](sample_displacements(discrete, _SAMPLES))
    if velocities.shape != (_SAMPLES, group.dim) or not np.all(np.isfinite(velocities)):
        got = f"shape {velocities.shape[1:]}" if velocities.shape[1:] != (group.dim,) else "a value that is not finite"
        raise error(where, f"return {group.dim} finite coordinates", got, "Use `vee` on a matrix of the algebra.")
    unit = velocities / np.linalg.norm(velocities, axis=1, keepdims=True)
    rows = annihilator / np.linalg.norm(annihilator, axis=1, keepdims=True)
    return float(np.abs(unit @ rows.T).max(initial=0.0))
