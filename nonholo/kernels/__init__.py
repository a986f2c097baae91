"""The compiled steps: scalar arithmetic written once for numba and JAX, the matrix step for any body, the loops."""

import functools
from collections.abc import Callable

from nonholo.kernels._composition import ComposedBody, whole_steps
from nonholo.kernels._driver import CHART, CORRECTIONS, SETTLED, STATE_SIZE, converged, start
from nonholo.kernels._ensemble import LANES, MemberAxes, MemberRows, advance_members, canonical, tables_of
from nonholo.kernels._entry import AnyBody, runs_of, sizes, step_each
from nonholo.kernels._flat import flat_arrowhead_run, flat_forced_run, flat_run, flat_secular_run
from nonholo.kernels._scalar import (
    Body,
    correction,
    increment,
    inertia,
    is_certain,
    move,
    quadratic,
    residual,
    tangent,
)
from nonholo.kernels._sleigh import SleighBody
from nonholo.kernels._suslov import SuslovBody, suslov_body, suslov_table
from nonholo.kernels.forced import Balanced, Drive, ForcedBody, Impulses, Kick, Pull, friction_flow
from nonholo.kernels.general import GeneralBody
from nonholo.kernels.general.coordinates import (
    CONTRACTION,
    ITERATIONS,
    SINGULAR,
    TOLERANCE,
    CoordinateBody,
    advance_coordinates,
    each_root,
    each_row,
    set_out_coordinates,
)
from nonholo.kernels.secular import SecularBody, secular_sleigh, secular_top
from nonholo.kernels.secular.nearest import NearestBody
from nonholo.kernels.secular.nearest import advance as advance_to_nearest
from nonholo.kernels.taylor import (
    Arrowhead,
    Columns,
    Quadratic,
    order_for,
    revisit_series,
    solve_arrowhead,
    solve_members,
    solve_series,
    sparse_products,
)

FLAT_RUNS: dict[str, Callable[[], Callable[..., int]]] = {
    "top": functools.partial(flat_run, SuslovBody),
    "sleigh": functools.partial(flat_run, SleighBody),
    "forced_top": functools.partial(flat_forced_run, SuslovBody),
    "forced_sleigh": functools.partial(flat_forced_run, SleighBody),
    "top4": functools.partial(flat_secular_run, 3),
    "flow4": functools.partial(flat_arrowhead_run, 3, 1e-14 / 64),
}
"""Functions that make runs on bare memory, for hosts without Python: those of a page."""
