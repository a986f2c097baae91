"""How changes of shape move a body: its local connection, gaits, and where brackets lead."""

from nonholo.analysis.locomotion._connection import (
    Accessibility,
    LocalConnection,
    ShapedBody,
    accessibility,
    local_connection,
)
from nonholo.analysis.locomotion._phase import GeometricPhase, geometric_phase
