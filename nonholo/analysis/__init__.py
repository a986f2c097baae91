"""Questions asked of systems and orbits."""

from nonholo.analysis._asymptotics import Asymptotics, asymptotics
from nonholo.analysis._conserved import ConservedMomenta, conserved_momenta
from nonholo.analysis._critical_energies import CriticalEnergies, CriticalPoint, critical_energies
from nonholo.analysis._deltoid import Deltoid, deltoid
from nonholo.analysis._equilibria import EquilibriumSpectrum, equilibria
from nonholo.analysis._flow_obstruction import FlowObstruction, flow_obstruction
from nonholo.analysis._half_planes import HalfPlanes, half_planes
from nonholo.analysis._heteroclinic import HeteroclinicOrbit, heteroclinic
from nonholo.analysis._invariant_curve import InvariantCurve, invariant_curve
from nonholo.analysis._invariant_measure import InvariantMeasure, invariant_measure
from nonholo.analysis._invariants import Invariants, invariants
from nonholo.analysis._lyapunov import LyapunovFunction, lyapunov_function
from nonholo.analysis._momentum_locus import MomentumLocus, momentum_locus
from nonholo.analysis._single_valued_region import SingleValuedRegion, single_valued_region
from nonholo.analysis._step_jacobian import step_jacobians

__all__ = [
    "Asymptotics",
    "ConservedMomenta",
    "CriticalEnergies",
    "CriticalPoint",
    "Deltoid",
    "EquilibriumSpectrum",
    "FlowObstruction",
    "HalfPlanes",
    "HeteroclinicOrbit",
    "InvariantCurve",
    "InvariantMeasure",
    "Invariants",
    "LyapunovFunction",
    "MomentumLocus",
    "SingleValuedRegion",
    "asymptotics",
    "conserved_momenta",
    "critical_energies",
    "deltoid",
    "equilibria",
    "flow_obstruction",
    "half_planes",
    "heteroclinic",
    "invariant_curve",
    "invariant_measure",
    "invariants",
    "lyapunov_function",
    "momentum_locus",
    "single_valued_region",
    "step_jacobians",
]
