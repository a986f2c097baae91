"""Routes around another one, whose units, axes and poses they have; that of a composition runs it over substeps."""

import dataclasses
import functools
from operator import attrgetter
from typing import Any, ClassVar

from nonholo import kernels
from nonholo.discrete._composition import weights
from nonholo.discrete.routes._base import AbstractCompiledRoute


class AbstractOuterRoute(AbstractCompiledRoute):
    """A route that runs the kernel of another one, its `single`, and has its units, axes and poses."""

    name = property(attrgetter("single.name"))
    needs_pose: Any = property(attrgetter("single.needs_pose"))
    system: Any = property(attrgetter("single.system"))
    time_step = property(attrgetter("single.time_step"))
    scale = property(attrgetter("single.scale"))
    encode: Any = property(attrgetter("single.encode"))
    decode: Any = property(attrgetter("single.decode"))
    to_kernel: Any = property(attrgetter("single.to_kernel"))
    from_kernel: Any = property(attrgetter("single.from_kernel"))
    encode_poses: Any = property(attrgetter("single.encode_poses"))
    decode_poses: Any = property(attrgetter("single.decode_poses"))


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
