"""Pictures for papers and slides (matplotlib): momenta, tracks in space, energy errors, overviews, animations.

[fedorov-zenkov-2004], figures suslov, mom_dynamics and chsleigh. Nothing is simulated here.
"""

from nonholo.plotting._animation import animate
from nonholo.plotting._blade_track import BladeTrack, blade_track
from nonholo.plotting._body_axis_track import BodyAxisTrack, body_axis_track
from nonholo.plotting._branch_counts import BranchCounts, branch_counts
from nonholo.plotting._branch_tree import BranchTreePicture, branch_tree
from nonholo.plotting._branches import BranchesPicture, branches
from nonholo.plotting._energy_error import EnergyError, energy_error
from nonholo.plotting._invariant_curves import InvariantCurvesPicture, invariant_curves
from nonholo.plotting._locus_section import LocusSection, locus_section
from nonholo.plotting._momentum_locus import MomentumLocusPicture, momentum_locus
from nonholo.plotting._momentum_sphere import MomentumSphere, momentum_sphere
from nonholo.plotting._overview import overview
from nonholo.plotting._phase_portrait import PhasePortrait, phase_portrait
from nonholo.plotting._point_track import PointTrack, point_track
from nonholo.plotting._section import Section, section
from nonholo.plotting._sweep_map import SweepMap, sweep_map

__all__ = [
    "BladeTrack",
    "BodyAxisTrack",
    "BranchCounts",
    "BranchTreePicture",
    "BranchesPicture",
    "EnergyError",
    "InvariantCurvesPicture",
    "LocusSection",
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
