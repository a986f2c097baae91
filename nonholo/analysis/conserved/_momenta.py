r"""Linear integrals: the components of body and of spatial momentum that a constrained motion conserves.

They follow from linear algebra on the quadratic terms of the equations; no motion is computed.
"""

import dataclasses

import numpy as np

from nonholo.base.checks import instance
from nonholo.base.types import Array, Float
from nonholo.groups import AbstractMatrixGroup
from nonholo.systems import AbstractSystem, gyroscopic_form, null_space, refuse_forces, row_space

_RANK = 1e-11  # relative size below which a rate of change counts as zero


@dataclasses.dataclass(frozen=True, eq=False)
class ConservedMomenta:
    r"""The linear integrals of a system.

    Attributes:
        body: Orthonormal rows x with $\langle p, x\rangle$ constant, p the body momentum; shape (m, dim). For an LL
            system x lies in the constraint subspace.
        spatial: Orthonormal rows $\eta$ with $\langle\mu, \eta\rangle$ constant, $\mu = \mathrm{Ad}^*_{g^{-1}}p$ the
            spatial momentum; shape (m', dim).
    """

    body: Float[np.ndarray, "m dim"]
    spatial: Float[np.ndarray, "mm dim"]


def conserved_momenta(system: AbstractSystem) -> ConservedMomenta:
    r"""Return the components of body and spatial momentum that every motion of a system conserves.

    With the reaction $\rho = \sum_j\lambda_j a^j$, a quadratic function of the velocity, an LL system has

    $$ \langle p, x\rangle^{\textstyle\cdot} = \langle\mathbb{I}\omega, [\omega, x]\rangle \quad (x \in \mathfrak{d}),
       \qquad \langle\mu, \eta\rangle^{\textstyle\cdot} = \langle\rho(\omega), \mathrm{Ad}_{g^{-1}}\eta\rangle. $$

    A body component is conserved if the first form vanishes on $\mathfrak{d}$; components outside $\mathfrak{d}$ add
    nothing, since $p = \mathbb{I}\omega$ is known from its restriction to $\mathfrak{d}$. A spatial one is conserved if
    $\eta$ lies in the largest ideal that the reactions annihilate: the horizontal symmetries, ideals inside
    $\mathfrak{d}$, and those that the body's symmetry adds. For an LR system, with $\dot\mu = \rho(g, \xi)$, the
    conditions are imposed at dim + 1 random configurations (a fixed seed), which decides them with probability one;
    the spatial components always contain $\mathfrak{d}$.

    The lists are complete for connected groups: a linear function of p or of $\mu$ that is not in their span changes
    along some motion. A discrete map keeps the spatial components along ideals inside $\mathfrak{d}$, whatever its
    Lagrangian. That it keeps the others is not implied.

    Args:
        system: An LL or LR system with concrete numbers.

    Raises:
        ValueError: `system` is not a system.

    Example:
        A balanced top keeps its momenta along the constraint; the sleigh keeps nothing.

        >>> conserved_momenta(nh.SuslovTop(np.diag([1.0, 2.0, 3.0]))).body
        array([[1., 0., 0.],
               [0., 1., 0.]])
        >>> conserved_momenta(nh.ChaplyginSleigh(1.0, 1.0, 0.5)).body.shape
        (0, 3)
    """
    remedy = "Pass a SuslovTop, an LLSystem, ..."
    instance("conserved_momenta(system=...)", system, AbstractSystem, "be a system", remedy)
    refuse_forces("conserved_momenta(system=...)", system)
    return _right(system) if system.is_spatial else _left(system)


def _left(system: AbstractSystem) -> ConservedMomenta:
    group, rows = system.group, row_space(system.constraint_subspace)
    inertia, everything = np.asarray(system.inertia_operator), np.eye(group.dim)
    form = gyroscopic_form(inertia, _brackets(group, rows, rows), rows)
    coefficients = _vanishing(form.reshape(len(rows) ** 2, len(rows)), _scale(group, inertia))
    reactions = _reactions(inertia, rows, _brackets(group, rows, everything))
    return ConservedMomenta(coefficients @ rows, _largest_ideal(group, _vanishing(reactions, _scale(group, inertia))))


def _right(system: AbstractSystem) -> ConservedMomenta:
    group, rows, everything = system.group, row_space(system.constraint_subspace), np.eye(system.group.dim)
    inertia, rng = np.asarray(system.inertia_operator), np.random.default_rng(0)
    brackets, rates, reactions = _brackets(group, rows, everything), [], []
    for _ in range(group.dim + 1):
        back = group.adjoint(group.inverse(group.random(rng)))
        spatial = back.T @ inertia @ back
        reactions.append(_reactions(spatial, rows, brackets))
        gyroscopic = gyroscopic_form(spatial, brackets, rows).reshape(-1, group.dim)
        rates.append((gyroscopic + reactions[-1]) @ np.linalg.inv(back))
    scale = _scale(group, inertia)
    return ConservedMomenta(_vanishing(np.concatenate(rates), scale), _vanishing(np.concatenate(reactions), scale))


def _reactions(
    inertia: Float[np.ndarray, "dim dim"], rows: Float[np.ndarray, "k dim"], brackets: Float[np.ndarray, "k dim dim"]
) -> Float[np.ndarray, "kk dim"]:
    r"""Return covectors that span the reactions.

    They are $\mathbb{I}S^T(S\mathbb{I}S^T)^{-1}S\tau - \tau$ with $\tau = \mathrm{ad}^*_\omega p$, also in space for
    an LR system, where the inertia is that of the turned body.
    """
    torque = gyroscopic_form(inertia, brackets, rows).reshape(-1, len(inertia))
    along = rows @ inertia
    return torque @ rows.T @ np.linalg.solve(along @ rows.T, along) - torque


def _largest_ideal(group: AbstractMatrixGroup, subspace: Float[np.ndarray, "m dim"]) -> Float[np.ndarray, "n dim"]:
    """Return the largest subspace of the given one that all brackets map to itself."""
    everything, scale = np.eye(group.dim), _bracket_scale(group)
    while len(subspace):
        escape = _brackets(group, subspace, everything) @ null_space(subspace).T
        kept = _vanishing(escape.reshape(len(subspace), -1).T, scale) @ subspace
        if len(kept) == len(subspace):
            break
        subspace = kept
    return subspace


def _vanishing(conditions: Float[np.ndarray, "c m"], scale: float) -> Float[np.ndarray, "n m"]:
    """Return orthonormal rows on which the conditions vanish; entries that are small beside `scale` count as zero."""
    return null_space(np.where(np.abs(conditions) > _RANK * scale, conditions / scale, 0.0), _RANK)


def _scale(group: AbstractMatrixGroup, inertia: Array) -> float:
    return max(float(np.abs(inertia).max()) * _bracket_scale(group), np.finfo(np.float64).tiny)


def _bracket_scale(group: AbstractMatrixGroup) -> float:
    """Return the largest structure constant; 1 for a commutative group."""
    everything = np.eye(group.dim)
    return float(np.abs(_brackets(group, everything, everything)).max()) or 1.0


def _brackets(group: AbstractMatrixGroup, x: np.ndarray, y: np.ndarray) -> Float[np.ndarray, "i j dim"]:
    return group.bracket(x[:, None, :], y[None, :, :])
