"""Ways to compute the steps of a discretization: one route for each way, chosen and built once.

| route | bodies and method |
|---|---|
| `ScalarRoute` | tops in space and sleighs in the plane, in closed form with scalars |
| `SecularRoute` | tops on SO(n) and sleighs on SE(n), with two unknowns |
| `MatrixRoute` | any constraint with difference "matrix", by the matrix equations |
| `DefinitionRoute` | everything, by derivatives of the discrete Lagrangian in JAX |
| `ComposedRoute` | compositions of one of the first three |
| `ForcedRoute` | one of the first three, with half an impulse at each end of its steps, compiled or in plain Python |
| `FunctionRoute` | the definition of the impulses, for constraints fixed in space and around `DefinitionRoute` |
"""

from nonholo.discrete.routes._base import AbstractBodyStepper, AbstractCompiledRoute, Compact, reversal_defects
from nonholo.discrete.routes._choice import make_route
from nonholo.discrete.routes._normal_forms import ScalarRoute, ScalarStep, SecularRoute
