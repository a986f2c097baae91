"""Energies at which something changes: critical ones, folds, where the map is single valued."""

from nonholo.analysis.energies._critical import CriticalEnergies, CriticalPoint, critical_energies
from nonholo.analysis.energies._single_valued_region import SingleValuedRegion, single_valued_region
