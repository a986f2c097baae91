r"""The step in O(n) of tops on SO(n) and sleighs on SE(n): axes, units and signs between the system and its kernel.

Reference: docs/theory/secular-step.md.
"""

from typing import TYPE_CHECKING, NamedTuple, cast

import numpy as np

from nonholo import kernels
from nonholo._types import Array, Float
from nonholo.systems import ArrowheadSleigh, ArrowheadTop, MultidimensionalSleigh, SuslovTop

if TYPE_CHECKING:
    from nonholo.discrete._discretization import Discretization


class SecularStep(NamedTuple):
    r"""The body of the secular kernel, the factor to its momenta, and the axes that diagonalise B.

    The kernel's momenta of a sleigh are $h\,(\pi, p_1)/2$ with $\pi = p|_{e_1\wedge e_j} - \alpha_j p_1$ along those
    axes.

    Attributes:
        body: The body.
        scale: h / 2.
        axes: Columns are the axes, (k, k); None where they are those of the system.
        offset: $\alpha$, in the axes of the system; None for a top.
    """

    body: kernels.SecularBody
    scale: Array
    axes: Float[np.ndarray, "k k"] | None
    offset: Float[np.ndarray, "k"] | None

    def encoded(self, momenta: np.ndarray) -> np.ndarray:
        """Return the kernel's momenta."""
        if self.offset is not None:
            along = momenta[..., -1:]
            momenta = np.concatenate([momenta[..., :-1] - along * self.offset, along], axis=-1)
        return self.turned(self.scale * momenta)

    def decoded(self, momenta: np.ndarray) -> np.ndarray:
        """Return canonical momenta from the kernel's."""
        momenta = self.turned_back(momenta) / self.scale
        if self.offset is not None:
            momenta[..., :-1] += momenta[..., -1:] * self.offset
        return momenta

    def turned(self, vectors: np.ndarray) -> np.ndarray:
        """Return vectors in the kernel's axes; a last component along the blade stays."""
        return vectors if self.axes is None else _first_turned(vectors, self.axes)

    def turned_back(self, vectors: np.ndarray) -> np.ndarray:
        """Return vectors in the axes of the system."""
        return vectors if self.axes is None else _first_turned(vectors, self.axes.T)

    def posed(self, g: np.ndarray) -> np.ndarray:
        """Return matrices of poses of the kernel's axes."""
        return g if self.axes is None else g @ _turned_frame(self.axes, self.offset is not None, g.shape[-1])

    def posed_back(self, g: np.ndarray) -> np.ndarray:
        """Return matrices of poses of the axes of the system."""
        return g if self.axes is None else g @ _turned_frame(self.axes, self.offset is not None, g.shape[-1]).T


def _first_turned(vectors: np.ndarray, axes: np.ndarray) -> np.ndarray:
    k = len(axes)
    return np.concatenate([vectors[..., :k] @ axes, vectors[..., k:]], axis=-1)


def _turned_frame(axes: np.ndarray, slides: bool, size: int) -> np.ndarray:
    """Return the body frame of the kernel as seen from that of the system."""
    turn, first = np.eye(size), 1 if slides else 0
    planes = slice(first, first + len(axes))
    turn[planes, planes] = axes
    return turn


def is_secular(discrete: "Discretization") -> bool:
    """Tell whether the system has a step in O(n): tops on SO(n), n >= 4, and sleighs on SE(n), n >= 3."""
    wide = isinstance(discrete.system, ArrowheadTop | ArrowheadSleigh | MultidimensionalSleigh | SuslovTop)
    planar = isinstance(discrete.system, SuslovTop) and discrete.system.axis is not None
    return wide and not planar and discrete.difference == "matrix" and discrete.constraint in ("skew", "exponential")


def secular_step(discrete: "Discretization") -> SecularStep:
    """Return that step."""
    system, half = discrete.system, discrete.time_step / 2
    if isinstance(system, ArrowheadTop):
        body = kernels.secular_top(system.inertia_along.turning, system.coupling)
        return SecularStep(body, half, None, None)
    if isinstance(system, SuslovTop):
        b, axes = np.linalg.eigh(system.inertia_along)
        return SecularStep(kernels.secular_top(b, system.coupling @ axes), half, axes, None)
    if isinstance(system, ArrowheadSleigh):
        a, d = system.center_of_mass, system.diagonal
        body = kernels.secular_sleigh(d[1:] + d[0], system.coupling, float(system.mass), float(a[0]), a[1:])
        return SecularStep(body, half, None, a[1:])
    sleigh = cast(MultidimensionalSleigh, system)
    J, a = np.asarray(sleigh.mass_tensor), np.asarray(sleigh.center_of_mass)
    b, axes = np.linalg.eigh(J[1:, 1:] + J[0, 0] * np.eye(len(J) - 1))
    body = kernels.secular_sleigh(b, J[0, 1:] @ axes, float(sleigh.mass), float(a[0]), a[1:] @ axes)
    return SecularStep(body, half, axes, a[1:])
