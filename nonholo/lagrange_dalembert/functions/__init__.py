"""Functions of the user: checked by JAX's traces, called with or without a time, and with parameters put in."""

from nonholo.lagrange_dalembert.functions._parameters import Bound, Parameters
from nonholo.lagrange_dalembert.functions._tracing import (
    ForceTable,
    check_forms,
    check_rows_of_places,
    check_value,
    count_of,
    takes_time,
    with_parameters,
    with_time_step,
)
