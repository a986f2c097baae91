"""Quantities that a motion keeps or only lets fall: momenta, invariants, densities, a Lyapunov function."""

from nonholo.analysis.conserved._invariants import Invariants, invariants
from nonholo.analysis.conserved._lyapunov import LyapunovFunction, lyapunov_function
from nonholo.analysis.conserved._measure import InvariantMeasure, invariant_measure
from nonholo.analysis.conserved._momenta import ConservedMomenta, conserved_momenta
from nonholo.analysis.conserved._tangent import lyapunov_exponents, tangent
