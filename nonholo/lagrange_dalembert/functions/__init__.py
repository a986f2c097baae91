"""Functions of users as JAX traces them, with or without the time step; their parameters; tables of forces."""

from nonholo.lagrange_dalembert.functions._system import (
    SYSTEM,
    AbstractParametricSystem,
    Parameters,
    configurations,
    in_blocks,
    in_double,
    in_rows,
    place,
    places,
)
from nonholo.lagrange_dalembert.functions._traced import (
    LOOK_UP,
    ROWS,
    ForceTable,
    checked_rows,
    checked_value,
    room,
    takes_time,
    trace,
    with_parameters,
    with_time_step,
)
