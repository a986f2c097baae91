"""Questions asked of systems and orbits."""

from nonholo.analysis._comparison import Comparison, Convergence, Errors, compare
from nonholo.analysis._deltoid import Deltoid, deltoid
from nonholo.analysis._equilibria import EquilibriumSpectrum, equilibria
from nonholo.analysis._invariant_curve import InvariantCurve, invariant_curve
from nonholo.analysis._momentum_locus import MomentumLocus, momentum_locus
from nonholo.analysis.conserved import (
    ConservedMomenta,
    InvariantMeasure,
    Invariants,
    LyapunovFunction,
    conserved_momenta,
    invariant_measure,
    invariants,
    lyapunov_exponents,
    lyapunov_function,
    tangent,
)
from nonholo.analysis.energies import (
    CriticalEnergies,
    CriticalPoint,
    SingleValuedRegion,
    critical_energies,
    single_valued_region,
)
from nonholo.analysis.limits import (
    Asymptotics,
    FlowObstruction,
    HalfPlanes,
    HeteroclinicOrbit,
    asymptotics,
    flow_obstruction,
    half_planes,
    heteroclinic,
)
from nonholo.analysis.linearization import Linearization, SteadyMotion, critical_values, linearize
from nonholo.analysis.locomotion import (
    Accessibility,
    GeometricPhase,
    LocalConnection,
    ShapedBody,
    accessibility,
    geometric_phase,
    local_connection,
)
