"""Pictures of a discretization: its surface of momenta, its invariant curves, values of the map; of a connection."""

from nonholo.plotting.geometry._branch_counts import BranchCounts, branch_counts
from nonholo.plotting.geometry._branch_tree import BranchTreePicture, branch_tree
from nonholo.plotting.geometry._branches import BranchesPicture, branches
from nonholo.plotting.geometry._curvature import CurvaturePicture, curvature
from nonholo.plotting.geometry._invariant_curves import InvariantCurvesPicture, invariant_curves
from nonholo.plotting.geometry._locus_section import LocusSection, locus_section
from nonholo.plotting.geometry._momentum_locus import MomentumLocusPicture, momentum_locus
