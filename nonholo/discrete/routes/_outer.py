"""The interface of a route around another one, whose units, axes and poses it has."""

from operator import attrgetter
from typing import Any

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
