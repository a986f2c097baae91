"""Questions asked of systems and orbits."""

from nonholo.analysis._conserved import ConservedMomenta, conserved_momenta
from nonholo.analysis._invariants import Invariants, invariants

__all__ = ["ConservedMomenta", "Invariants", "conserved_momenta", "invariants"]
