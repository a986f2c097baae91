"""Mechanics in coordinates: the discrete Lagrange-d'Alembert principle on R^n, and the flow it discretizes."""

from nonholo.base.checks import needs

with needs("jax", "nonholo.lagrange_dalembert"):
    from nonholo.lagrange_dalembert import _equations as equations
    from nonholo.lagrange_dalembert._discretization import CoordinateDiscretization
    from nonholo.lagrange_dalembert._motion import CoordinateFlow, RecordedSystem
    from nonholo.lagrange_dalembert._orbit import AbstractCoordinateOrbit, CoordinateOrbit
    from nonholo.lagrange_dalembert._precision import in_double
    from nonholo.lagrange_dalembert._start import of_flow as checked_state
    from nonholo.lagrange_dalembert._system import LagrangeDAlembert
    from nonholo.lagrange_dalembert._tracing import check_forms, check_value
    from nonholo.lagrange_dalembert.on_groups import (
        GroupDiscretization,
        GroupLagrangeDAlembert,
        GroupOrbit,
        mass_tensor_lagrangian,
    )
