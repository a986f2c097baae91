"""The discrete Lagrange-d'Alembert principle on R^n and on groups, and the flow it discretizes."""

from nonholo.base.checks import needs

with needs("jax", "nonholo.lagrange_dalembert"):
    from nonholo.lagrange_dalembert import _equations as equations
    from nonholo.lagrange_dalembert import _places as places
    from nonholo.lagrange_dalembert import _tangents as tangents
    from nonholo.lagrange_dalembert._discretization import CoordinateDiscretization, GroupDiscretization, checked_state
    from nonholo.lagrange_dalembert._flow import flights, flow, vector_field
    from nonholo.lagrange_dalembert._group_system import GroupLagrangeDAlembert, mass_tensor_lagrangian
    from nonholo.lagrange_dalembert._orbit import (
        AbstractCoordinateOrbit,
        CoordinateFlow,
        CoordinateOrbit,
        GroupOrbit,
        RecordedSystem,
    )
    from nonholo.lagrange_dalembert._rollout import CoordinateRollout
    from nonholo.lagrange_dalembert._rollout import roll as rolled_in_coordinates
    from nonholo.lagrange_dalembert._start import forms_and_units, momentum
    from nonholo.lagrange_dalembert._system import LagrangeDAlembert
    from nonholo.lagrange_dalembert.functions import checked_rows, checked_value, in_double, place, trace
