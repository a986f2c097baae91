"""Questions asked of systems and orbits."""

from nonholo.analysis._invariants import Invariants, invariants

__all__ = ["Invariants", "invariants"]
