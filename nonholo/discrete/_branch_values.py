"""The values over one restricted momentum as matrices, and which of them is the principal one.

The roots come from `_branch_roots`; the questions that users ask are in `_branches`.
"""

import dataclasses
from typing import cast

import numpy as np

from nonholo import kernels
from nonholo._types import Array, Bool, Float, Int
from nonholo.discrete._branch_equations import Frame
from nonholo.discrete._branch_roots import roots_of
from nonholo.discrete._discretization import Discretization
from nonholo.discrete._legendre import legendre
from nonholo.discrete._structured import structured
from nonholo.systems import AbstractLLSystem

SAME = 1e-6  # relative distance of a computed displacement or momentum from the branch that it is


@dataclasses.dataclass(frozen=True, eq=False)
class Branches:
    """Displacements whose momenta have the same components along the constraint subspace.

    Real ones come first, by step angle.

    Attributes:
        displacement: W, complex matrices.
        momentum: P(W), physical.
        is_real: Which displacements are real.
        multiplicity: Two at a fold.
        fold_distance: See `fold_distance`.
        energy: Reduced constrained energy, the same for all.
        principal: Index of the principal one; None if the principal branch does not reach this momentum.
    """

    displacement: Array
    momentum: Array
    is_real: Bool[np.ndarray, "B"]
    multiplicity: Int[np.ndarray, "B"]
    fold_distance: Float[np.ndarray, "B"]
    energy: float
    principal: int | None

    def __len__(self) -> int:
        return len(self.is_real)


def values_over(discrete: Discretization, frame: Frame, r: Float[np.ndarray, "k"]) -> Branches:
    """Return all values over a restricted momentum in the user's frame."""
    system = cast(AbstractLLSystem, discrete.system)
    canonical = system.frame_map @ r
    equations = frame.equations(discrete.time_step * canonical)
    roots = roots_of(equations)
    back = system.group.inverse(system.frame)
    X = np.array([system.frame @ frame.increment(root.point.astype(complex)) @ back for root in roots])
    is_real = np.array([root.is_real for root in roots])
    return Branches(
        displacement=X + system.group.identity,
        momentum=legendre(discrete, X, "left"),
        is_real=is_real,
        multiplicity=np.array([root.multiplicity for root in roots]),
        fold_distance=np.array([equations.regularity(root.point) for root in roots]),
        energy=float(system.constrained_energy(r)),
        principal=_principal(discrete, canonical, X, is_real),
    )


def _principal(discrete: Discretization, canonical: np.ndarray, X: np.ndarray, is_real: np.ndarray) -> int | None:
    """Return the index of the verified principal root among displacements minus the identity."""
    step = structured(discrete)
    if step is None:
        return None
    group, body = discrete.system.group, step.body
    pose = group.pose_from_matrix(discrete.system.frame)
    coded = group.matrix_from_pose(pose).ravel() if isinstance(body, kernels.GeneralBody) else pose
    code, state = kernels.start(body, step.scale * canonical, coded)
    if code != 0:
        return None
    found = discrete.displaced(kernels.chart_of(body, state)) - group.identity
    missed = np.where(is_real, np.linalg.norm(X - found, axis=(1, 2)), np.inf)
    best = int(np.argmin(missed))
    return best if missed[best] <= SAME * max(1.0, float(np.linalg.norm(found))) else None
