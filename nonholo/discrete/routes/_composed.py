"""The route of a composition: the kernel of another route, run over substeps."""

import dataclasses
import functools
from typing import ClassVar

from nonholo import kernels
from nonholo.discrete._composition import weights
from nonholo.discrete.routes._base import AbstractCompiledRoute
from nonholo.discrete.routes._outer import AbstractOuterRoute


@dataclasses.dataclass(frozen=True, eq=False)
class ComposedRoute(AbstractOuterRoute):
    """Momenta, charts and poses are those of the route that is composed.

    Attributes:
        composed: The route of a step of order 2 with the same time step.
        order: 4, 6 or 8.
    """

    composed: AbstractCompiledRoute
    order: int
    is_scalar: ClassVar[bool] = False

    @functools.cached_property
    def body(self) -> kernels.ComposedBody:
        """The body and the weights of the substeps."""
        return kernels.ComposedBody(self.single.body, weights(self.order).copy())

    @property
    def single(self) -> AbstractCompiledRoute:
        """The discretization that is composed."""
        return self.composed
