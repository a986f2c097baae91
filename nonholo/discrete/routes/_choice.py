"""Which route a discretization takes: the first of its system that computes what is asked for."""

import dataclasses
import functools
from typing import Any, cast

from nonholo.discrete._scheme import Scheme
from nonholo.discrete._variety import variety_of
from nonholo.discrete.routes._balanced import balanced_route
from nonholo.discrete.routes._base import AbstractRoute
from nonholo.discrete.routes._closed_forms import closed_form
from nonholo.discrete.routes._composed import ComposedRoute
from nonholo.discrete.routes._definition import DefinitionRoute
from nonholo.discrete.routes._forced import forced_route
from nonholo.discrete.routes._matrix import MatrixRoute
from nonholo.discrete.routes._scalar import ScalarRoute
from nonholo.discrete.routes._secular import SecularRoute
from nonholo.discrete.routes._slipping import slip_route
from nonholo.systems import Forced

_SCALAR = (None, "scalar")
_SECULAR = (*_SCALAR, "secular")
_MATRIX = (*_SECULAR, "matrix")


def make_route(scheme: Scheme, wanted: str | None = None) -> AbstractRoute:
    """Return the route of a discretization.

    Args:
        scheme: The discretization, or what has its parts.
        wanted: None for the best one; or the name of one, which then, or where it is not known for the system the next
            more general one, is taken. Stores name the route that began them.
    """
    if scheme.system.is_forced:
        forced = cast(Forced, scheme.system)
        free = dataclasses.replace(cast(Any, scheme), system=forced.system)
        is_balanced = forced.forces is not None and forced.is_balanced(free.conserves_energy, scheme.order > 2)
        if forced.slip is not None:
            return slip_route(scheme, forced, functools.partial(make_route, wanted=wanted))
        if is_balanced:
            system, variety = forced.system.canonical, variety_of(forced.system, "skew")
            matrix = functools.partial(MatrixRoute, system, variety, scheme.time_step)
            return balanced_route(_single(free, wanted), matrix, forced, scheme.order)
        return forced_route(make_route(free, wanted), forced)
    single = _single(scheme, wanted)
    compiled = single.compiled
    return single if compiled is None or scheme.order == 2 else ComposedRoute(compiled, scheme.order)


def _single(scheme: Scheme, wanted: str | None) -> AbstractRoute:
    compiled = None
    if scheme.difference == "matrix" and scheme.constraint in ("skew", "exponential"):
        compiled = _of_form(scheme, wanted) or _of_matrices(scheme, wanted)
    if compiled is not None:
        return compiled
    return DefinitionRoute(scheme.system, scheme.time_step, scheme.difference, scheme.constraint, scheme.order)


def _of_form(scheme: Scheme, wanted: str | None) -> AbstractRoute | None:
    """Return the route of a top or a sleigh, by the numbers of its normal form."""
    form = scheme.system.normal_form
    if form is None:
        return None
    if wanted in _SCALAR and (closed := closed_form(form)):
        return ScalarRoute(scheme.system, form, closed, scheme.time_step)
    if wanted in _SECULAR and SecularRoute.covers(form):
        return SecularRoute(scheme.system, form, scheme.time_step)
    return None


def _of_matrices(scheme: Scheme, wanted: str | None) -> AbstractRoute | None:
    """Return the route of any system whose variety is no exponential."""
    if wanted not in _MATRIX or (variety := variety_of(scheme.system, scheme.constraint)).exponential:
        return None
    return MatrixRoute(scheme.system, variety, scheme.time_step)
