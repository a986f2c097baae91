"""Questions asked of systems and orbits."""

from nonholo.analysis._asymptotics import Asymptotics, asymptotics, turn_of_flow
from nonholo.analysis._comparison import Comparison, Convergence, Errors, compare
from nonholo.analysis._critical_energies import CriticalEnergies, CriticalPoint, critical_energies
from nonholo.analysis._deltoid import Deltoid, SingleValuedRegion, deltoid, single_valued_region
from nonholo.analysis._equilibria import EquilibriumSpectrum, equilibria
from nonholo.analysis._heteroclinic import FlowObstruction, HeteroclinicOrbit, flow_obstruction, heteroclinic
from nonholo.analysis._loci import (
    HalfPlanes,
    InvariantCurve,
    MomentumLocus,
    half_planes,
    invariant_curve,
    momentum_locus,
)
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
