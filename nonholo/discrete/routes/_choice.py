"""Which route a discretisation takes: the first of its system that computes what is asked for."""

from nonholo.discrete._scheme import Scheme
from nonholo.discrete._variety import variety_of
from nonholo.discrete.routes._base import AbstractRoute
from nonholo.discrete.routes._closed_forms import closed_form
from nonholo.discrete.routes._composed import ComposedRoute
from nonholo.discrete.routes._definition import DefinitionRoute
from nonholo.discrete.routes._matrix import MatrixRoute
from nonholo.discrete.routes._scalar import ScalarRoute
from nonholo.discrete.routes._secular import SecularRoute

_SCALAR = (None, "scalar")
_SECULAR = (*_SCALAR, "secular")
_MATRIX = (*_SECULAR, "matrix")


def make_route(scheme: Scheme, wanted: str | None = None) -> AbstractRoute:
    """Return the route of a discretisation.

    Args:
        scheme: The discretisation, or what has its parts.
        wanted: None for the best one; or the name of one, which then, or where it is not known for the system the next
            more general one, is taken. Stores name the route that began them.
    """
    single = _single(scheme, wanted)
    compiled = single.compiled
    return single if compiled is None or scheme.order == 2 else ComposedRoute(compiled, scheme.order)


def _single(scheme: Scheme, wanted: str | None) -> AbstractRoute:
    system, step, difference, constraint = scheme.system, scheme.time_step, scheme.difference, scheme.constraint
    form = system.normal_form
    if difference == "matrix" and constraint in ("skew", "exponential"):
        if wanted in _SCALAR and form is not None and (closed := closed_form(form)):
            return ScalarRoute(system, form, closed, step)
        if wanted in _SECULAR and form is not None and SecularRoute.covers(form):
            return SecularRoute(system, form, step)
        if wanted in _MATRIX and not (variety := variety_of(system, constraint)).exponential:
            return MatrixRoute(system, variety, step)
    return DefinitionRoute(system, step, difference, constraint, scheme.order)
