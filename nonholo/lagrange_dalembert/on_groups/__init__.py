"""The discrete Lagrange-d'Alembert principle on groups."""

from nonholo.lagrange_dalembert._orbit import GroupOrbit
from nonholo.lagrange_dalembert.on_groups._system import GroupLagrangeDAlembert, mass_tensor_lagrangian
