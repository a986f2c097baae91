"""Questions asked of systems and orbits."""

from nonholo.analysis._asymptotics import (
    Asymptotics,
    FlowObstruction,
    HeteroclinicOrbit,
    asymptotics,
    flow_obstruction,
    heteroclinic,
    turn_of_flow,
)
from nonholo.analysis._comparison import Comparison, Convergence, Errors, compare
from nonholo.analysis._critical_energies import CriticalEnergies, CriticalPoint, critical_energies
from nonholo.analysis._equilibria import (
    EquilibriumSpectrum,
    InvariantMeasure,
    LyapunovFunction,
    equilibria,
    invariant_measure,
    lyapunov_function,
)
from nonholo.analysis._invariants import ConservedMomenta, Invariants, conserved_momenta, invariants
from nonholo.analysis._linearize import Linearization, SteadyMotion, critical_values, linearize
from nonholo.analysis._loci import (
    Deltoid,
    HalfPlanes,
    InvariantCurve,
    MomentumLocus,
    SingleValuedRegion,
    deltoid,
    half_planes,
    invariant_curve,
    momentum_locus,
    single_valued_region,
)
from nonholo.analysis._tangent import lyapunov_exponents, tangent
from nonholo.analysis.locomotion import Accessibility, GeometricPhase, LocalConnection
