"""Geometric mechanics of nonholonomic systems: bodies whose velocity, but not whose position, is constrained."""

import importlib
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from nonholo import literature as examples  # noqa: F401
    from nonholo import plotting as plot  # noqa: F401
    from nonholo import testing as testing
    from nonholo.analysis import accessibility as accessibility
    from nonholo.analysis import asymptotics as asymptotics
    from nonholo.analysis import compare as compare
    from nonholo.analysis import conserved_momenta as conserved_momenta
    from nonholo.analysis import critical_energies as critical_energies
    from nonholo.analysis import equilibria as equilibria
    from nonholo.analysis import flow_obstruction as flow_obstruction
    from nonholo.analysis import geometric_phase as geometric_phase
    from nonholo.analysis import half_planes as half_planes
    from nonholo.analysis import heteroclinic as heteroclinic
    from nonholo.analysis import invariant_curve as invariant_curve
    from nonholo.analysis import invariant_measure as invariant_measure
    from nonholo.analysis import invariants as invariants
    from nonholo.analysis import local_connection as local_connection
    from nonholo.analysis import lyapunov_exponents as lyapunov_exponents
    from nonholo.analysis import lyapunov_function as lyapunov_function
    from nonholo.analysis import momentum_locus as momentum_locus
    from nonholo.analysis import single_valued_region as single_valued_region
    from nonholo.analysis.inverse import fit as fit
    from nonholo.analysis.inverse import steer as steer
    from nonholo.base.results import Outcome as Outcome
    from nonholo.base.results import OutcomeError as OutcomeError
    from nonholo.continuous import vector_field as vector_field
    from nonholo.discrete import Discretization as Discretization
    from nonholo.discrete import branch_tree as branch_tree
    from nonholo.discrete import branches as branches
    from nonholo.discrete import consistency_defect as consistency_defect
    from nonholo.discrete import discrete_legendre as discrete_legendre
    from nonholo.discrete import discretize as discretize
    from nonholo.discrete import displacements_over as displacements_over
    from nonholo.discrete import fold_distance as fold_distance
    from nonholo.discrete import inverse_discrete_legendre as inverse_discrete_legendre
    from nonholo.discrete import moser_veselov_displacement as moser_veselov_displacement
    from nonholo.discrete._step import step as step
    from nonholo.discrete.definition import allow_float32 as allow_float32
    from nonholo.ensembles import Choice as Choice
    from nonholo.ensembles import Direction as Direction
    from nonholo.ensembles import EnsembleTask as EnsembleTask
    from nonholo.ensembles import Grid as Grid
    from nonholo.ensembles import LogUniform as LogUniform
    from nonholo.ensembles import MassTensor as MassTensor
    from nonholo.ensembles import MemberBlock as MemberBlock
    from nonholo.ensembles import Normal as Normal
    from nonholo.ensembles import RandomDesign as RandomDesign
    from nonholo.ensembles import Uniform as Uniform
    from nonholo.ensembles import load_sweep as load_sweep
    from nonholo.ensembles import resume as resume
    from nonholo.ensembles import sweep as sweep
    from nonholo.explorer import explore as explore
    from nonholo.groups import SE as SE
    from nonholo.groups import SO as SO
    from nonholo.groups import MatrixGroup as MatrixGroup
    from nonholo.groups import ProductGroup as ProductGroup
    from nonholo.groups import Translations as Translations
    from nonholo.io import load_orbit as load_orbit
    from nonholo.io import save_orbit as save_orbit
    from nonholo.lagrange_dalembert import GroupLagrangeDAlembert as GroupLagrangeDAlembert
    from nonholo.lagrange_dalembert import LagrangeDAlembert as LagrangeDAlembert
    from nonholo.lagrange_dalembert import mass_tensor_lagrangian as mass_tensor_lagrangian
    from nonholo.orbit import Orbit as Orbit
    from nonholo.simulation import Crossings as Crossings
    from nonholo.simulation import Ensemble as Ensemble
    from nonholo.simulation import Event as Event
    from nonholo.simulation import EventLog as EventLog
    from nonholo.simulation import FlowEnsemble as FlowEnsemble
    from nonholo.simulation import crossings as crossings
    from nonholo.simulation import cusp as cusp
    from nonholo.simulation import ensemble as ensemble
    from nonholo.simulation import extend as extend
    from nonholo.simulation import flow as flow
    from nonholo.simulation import iterate as iterate
    from nonholo.simulation import simulate as simulate
    from nonholo.simulation.traced import rollout as rollout
    from nonholo.systems import ChaplyginSleigh as ChaplyginSleigh
    from nonholo.systems import Forced as Forced
    from nonholo.systems import Friction as Friction
    from nonholo.systems import Gravity as Gravity
    from nonholo.systems import ImpossibleBodyWarning as ImpossibleBodyWarning
    from nonholo.systems import LLSystem as LLSystem
    from nonholo.systems import LRSystem as LRSystem
    from nonholo.systems import MultidimensionalSleigh as MultidimensionalSleigh
    from nonholo.systems import RigidBody as RigidBody
    from nonholo.systems import SuslovTop as SuslovTop
    from nonholo.systems import VeselovaTop as VeselovaTop
    from nonholo.systems import euler_angle_discrete_lagrangian as euler_angle_discrete_lagrangian
    from nonholo.systems import in_exp_d as in_exp_d
    from nonholo.systems import is_symmetric_pair as is_symmetric_pair
    from nonholo.systems import reference_point_subspace as reference_point_subspace
    from nonholo.systems import trace_constraints as trace_constraints

_HOMES = {
    "ChaplyginSleigh": "systems",
    "Choice": "ensembles",
    "Crossings": "simulation",
    "Direction": "ensembles",
    "Discretization": "discrete",
    "Ensemble": "simulation",
    "EnsembleTask": "ensembles",
    "FlowEnsemble": "simulation",
    "Event": "simulation",
    "EventLog": "simulation",
    "Forced": "systems",
    "Friction": "systems",
    "Gravity": "systems",
    "Grid": "ensembles",
    "GroupLagrangeDAlembert": "lagrange_dalembert",
    "ImpossibleBodyWarning": "systems",
    "LLSystem": "systems",
    "LRSystem": "systems",
    "LagrangeDAlembert": "lagrange_dalembert",
    "LogUniform": "ensembles",
    "MassTensor": "ensembles",
    "MatrixGroup": "groups",
    "MemberBlock": "ensembles",
    "MultidimensionalSleigh": "systems",
    "Normal": "ensembles",
    "Orbit": "orbit",
    "Outcome": "base.results",
    "OutcomeError": "base.results",
    "ProductGroup": "groups",
    "RandomDesign": "ensembles",
    "RigidBody": "systems",
    "SE": "groups",
    "SO": "groups",
    "SuslovTop": "systems",
    "Translations": "groups",
    "Uniform": "ensembles",
    "VeselovaTop": "systems",
    "accessibility": "analysis",
    "allow_float32": "discrete.definition",
    "asymptotics": "analysis",
    "branch_tree": "discrete",
    "branches": "discrete",
    "compare": "analysis",
    "conserved_momenta": "analysis",
    "consistency_defect": "discrete",
    "critical_energies": "analysis",
    "crossings": "simulation",
    "cusp": "simulation",
    "discrete_legendre": "discrete",
    "discretize": "discrete",
    "displacements_over": "discrete",
    "ensemble": "simulation",
    "equilibria": "analysis",
    "euler_angle_discrete_lagrangian": "systems",
    "explore": "explorer",
    "extend": "simulation",
    "fit": "analysis.inverse",
    "flow": "simulation",
    "flow_obstruction": "analysis",
    "fold_distance": "discrete",
    "geometric_phase": "analysis",
    "half_planes": "analysis",
    "heteroclinic": "analysis",
    "in_exp_d": "systems",
    "invariant_curve": "analysis",
    "invariant_measure": "analysis",
    "invariants": "analysis",
    "inverse_discrete_legendre": "discrete",
    "is_symmetric_pair": "systems",
    "iterate": "simulation",
    "load_orbit": "io",
    "load_sweep": "ensembles",
    "local_connection": "analysis",
    "lyapunov_exponents": "analysis",
    "lyapunov_function": "analysis",
    "mass_tensor_lagrangian": "lagrange_dalembert",
    "momentum_locus": "analysis",
    "moser_veselov_displacement": "discrete",
    "reference_point_subspace": "systems",
    "resume": "ensembles",
    "rollout": "simulation.traced",
    "save_orbit": "io",
    "simulate": "simulation",
    "single_valued_region": "analysis",
    "steer": "analysis.inverse",
    "step": "discrete._step",
    "sweep": "ensembles",
    "trace_constraints": "systems",
    "vector_field": "continuous",
}
_ROOMS = {"examples": "literature", "plot": "plotting", "testing": "testing"}

_EXTRAS = dict.fromkeys(
    ("discrete.definition", "discrete._step", "simulation.traced", "literature", "lagrange_dalembert"), "jax"
)
"""Extras that rooms need beyond the core."""

__version__ = version("nonholo")


def __getattr__(name: str) -> Any:
    if name in _ROOMS:
        return _home(_ROOMS[name], name)
    if name not in _HOMES:
        raise AttributeError(f"module 'nonholo' has no attribute {name!r}")
    return globals().setdefault(name, getattr(_home(_HOMES[name], name), name))


def _home(home: str, name: str) -> Any:
    if home not in _EXTRAS:
        return importlib.import_module(f"nonholo.{home}")
    from nonholo.base.checks import needs

    with needs(_EXTRAS[home], f"nonholo.{name}"):
        return importlib.import_module(f"nonholo.{home}")


def __dir__() -> list[str]:
    return sorted([*_HOMES, *_ROOMS])
