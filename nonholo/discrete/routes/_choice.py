"""Which route a discretization takes: the first of its system that computes the map, else the definition."""

import dataclasses
import functools
from typing import Any, ClassVar, cast

import numpy as np

from nonholo.base.types import Float
from nonholo.discrete._scheme import Scheme, definition, variety_of, weights
from nonholo.discrete.routes._base import AbstractBodyStepper, AbstractCompiledRoute, Compact
from nonholo.discrete.routes._forced import ComposedRoute, balanced_route, forced_route
from nonholo.discrete.routes._matrix import MatrixRoute
from nonholo.discrete.routes._normal_forms import ScalarRoute, SecularRoute, closed_form
from nonholo.discrete.routes._slipping import SlipRoute
from nonholo.orbit import Orbit, step_poses
from nonholo.systems import Forced, NormalForm


@dataclasses.dataclass(frozen=True, eq=False)
class DefinitionRoute(Scheme, AbstractCompiledRoute):
    """Steps of one length or compositions, by derivatives of the discrete Lagrangian in JAX.

    Its numbers are canonical, its poses matrices.
    """

    name: ClassVar[str] = "definition"
    compiled_route: ClassVar[None] = None
    scale: ClassVar[float] = 1.0
    body: ClassVar[None] = None

    @property
    def sizes(self) -> tuple[int, int, int]:
        """Numbers of momenta, chart coordinates and pose entries."""
        return self.system.rank, len(self.variety.chart), self.system.group.size**2

    def stepper(self, motion: Any, *, with_poses: bool, branch: str = "principal") -> AbstractBodyStepper:
        """Return what takes the steps by the definition."""
        return definition("simulate(...) of a step that is not compiled").DefinitionStepper(motion, with_poses, branch)

    def next_charts(self, states: Orbit) -> Float[np.ndarray, "K m"]:
        """Return the displacements that follow, one step of order 2 from each state."""
        return definition("A step that is not compiled").next_charts(self, states.canonical_chart, step_poses(states))

    def start(self, momenta: np.ndarray, pose: np.ndarray) -> tuple[int, np.ndarray, np.ndarray]:
        """Return the outcome of the first root, its chart, and a state one step ahead."""
        code, chart, after, place = self._leap(momenta, pose, weights(self.order)[:1])
        place = self.encode_poses(self.system.group.normalize_pose(self.decode_poses(place)))
        return code, chart, np.concatenate((after, 0 * after, place))

    set_out = start

    def follow(self, state: np.ndarray) -> tuple[int, np.ndarray]:
        """Take the step from a state that is one ahead, in place; return the outcome and the chart of the step."""
        k = self.system.rank
        code, chart, state[:] = self.start(state[:k], state[2 * k :])
        return code, chart

    def parts_of_steps(self, momenta: np.ndarray, poses: np.ndarray, fraction: float = 1.0) -> Compact:
        """Take a fraction of a step from each row of momenta and poses; return both, and the outcomes."""
        parts = fraction * weights(self.order)
        ends = [self._leap(m, pose, parts) for m, pose in zip(momenta, poses, strict=True)]
        codes, _, *after = zip(*ends, strict=True)
        return np.array(after[0]), np.array(after[1]), np.array(codes)

    def _leap(self, m: np.ndarray, pose: np.ndarray, parts: np.ndarray) -> Any:
        """Return the outcome, the chart of the first part of a step, and momenta and pose after all parts."""
        return definition("A part of a step that is not compiled").leap(self, m, pose, parts)

    def whole_steps(self, momenta: Float[np.ndarray, "K k"], g: Float[np.ndarray, "K N N"]) -> Compact:
        """Take one step from each row of momenta and poses; return both after it, and the outcomes."""
        return definition("A step that is not compiled").whole_steps_by_definition(self, momenta, g)


_SCALAR = (None, "scalar")
_SECULAR = (*_SCALAR, "secular")
_MATRIX = (*_SECULAR, "matrix")


def make_route(scheme: Scheme, route_name: str | None = None) -> AbstractCompiledRoute:
    """Return the route of a discretization.

    Args:
        scheme: The discretization, or what has its parts.
        route_name: None for the best one; or the name of one, which then, or where it is not known for the system the
            next more general one, is taken. Stores name the route that began them.
    """
    if scheme.system.is_forced:
        whole, forced = cast(Any, scheme), cast(Forced, scheme.system)
        free, is_balanced = dataclasses.replace(whole, system=forced.system), whole.is_balanced
        if forced.slips:
            slide, hold = (dataclasses.replace(whole, system=each) for each in (forced.sliding, forced.holding))
            return SlipRoute(cast(Any, make_route(slide, route_name)), forced, make_route(hold, route_name), hold)
        if is_balanced:
            system, variety = forced.system.canonical, variety_of(forced.system, "skew")
            matrix = functools.partial(MatrixRoute, system, variety, scheme.time_step)
            return balanced_route(_single(free, route_name), matrix, forced, scheme.order)
        return forced_route(make_route(free, route_name), forced)
    single = _single(scheme, route_name)
    route = single.compiled_route
    return single if route is None or scheme.order == 2 else ComposedRoute(route, scheme.order)


def _single(scheme: Scheme, route_name: str | None) -> AbstractCompiledRoute:
    """Return the route of steps of order 2: by the normal form of a top or a sleigh, on matrices, by the definition."""
    system, form, h = scheme.system, scheme.system.normal_form, scheme.time_step
    if scheme.difference == "matrix" and scheme.constraint in ("skew", "exponential"):
        if route_name in _SCALAR and (entry := closed_form(form)):
            return ScalarRoute(system, cast(NormalForm, form), entry, h)
        if route_name in _SECULAR and SecularRoute.covers(form):
            return SecularRoute(system, cast(NormalForm, form), h)
        if route_name in _MATRIX and not (variety := variety_of(system, scheme.constraint)).exponential:
            return MatrixRoute(system, variety, h)
    return DefinitionRoute(system, h, scheme.difference, scheme.constraint, scheme.order)
