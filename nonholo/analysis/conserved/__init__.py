"""Quantities that a motion keeps or only lets fall: momenta, invariants, densities, a Lyapunov function."""

from nonholo.analysis.conserved._invariants import ConservedMomenta, Invariants, conserved_momenta, invariants
from nonholo.analysis.conserved._measure import InvariantMeasure, LyapunovFunction, invariant_measure, lyapunov_function
from nonholo.analysis.conserved._tangent import lyapunov_exponents, tangent
