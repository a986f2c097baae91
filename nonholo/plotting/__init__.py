"""Pictures for papers and slides (matplotlib): momenta, tracks in space, energy errors, overviews, animations.

[fedorov-zenkov-2004], figures suslov, mom_dynamics and chsleigh. Nothing is simulated here.
"""

from nonholo.plotting.animation import animate
from nonholo.plotting.comparisons import comparison, convergence
from nonholo.plotting.geometry import (
    BranchCounts,
    BranchesPicture,
    BranchTreePicture,
    CurvaturePicture,
    InvariantCurvesPicture,
    LocusSection,
    MomentumLocusPicture,
    branch_counts,
    branch_tree,
    branches,
    curvature,
    invariant_curves,
    locus_section,
    momentum_locus,
)
from nonholo.plotting.motion import (
    BladeTrack,
    BodyAxisTrack,
    EnergyError,
    MomentumSphere,
    PhasePortrait,
    PointTrack,
    Section,
    blade_track,
    body_axis_track,
    energy_error,
    momentum_sphere,
    phase_portrait,
    point_track,
    section,
)
from nonholo.plotting.overviews import overview
from nonholo.plotting.sweeps import SweepMap, sweep_map
from nonholo.plotting.theme import Look

__all__ = [
    "BladeTrack",
    "BodyAxisTrack",
    "BranchCounts",
    "BranchTreePicture",
    "BranchesPicture",
    "CurvaturePicture",
    "EnergyError",
    "InvariantCurvesPicture",
    "LocusSection",
    "Look",
    "MomentumLocusPicture",
    "MomentumSphere",
    "PhasePortrait",
    "PointTrack",
    "Section",
    "SweepMap",
    "animate",
    "blade_track",
    "body_axis_track",
    "branch_counts",
    "branch_tree",
    "branches",
    "comparison",
    "convergence",
    "curvature",
    "energy_error",
    "invariant_curves",
    "locus_section",
    "momentum_locus",
    "momentum_sphere",
    "overview",
    "phase_portrait",
    "point_track",
    "section",
    "sweep_map",
]
