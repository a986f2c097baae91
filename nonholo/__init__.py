r"""Geometric mechanics of nonholonomic systems: bodies whose velocity, but not whose position, is constrained.

Every public name once, by what it is for; `help(nonholo.simulate)` shows one of them, with an example.

Bodies:
    SuslovTop: A top on SO(n) that may only turn in planes that contain a body axis: $e_n$, or for n = 3 the axis ...
    ChaplyginSleigh: A sleigh on SE(2): body velocity $(\omega, v_1, v_2)$ with $v_2 = 0$; the blade points along ...
    MultidimensionalSleigh: A sleigh on SE(n), n >= 3: its reference point moves along body axis 1, it turns in ...
    RigidBody: A free body on SO(n) (the top of Euler; discretized, of Moser and Veselov) or on SE(n).
    VeselovaTop: A top on SO(n) that may only turn in planes that contain an axis $e_n$ fixed in space.
    LLSystem: A system on any matrix group whose body velocity stays in a subspace of the algebra, of any dimension.
    LRSystem: A body on SO(n) or SE(n) whose spatial velocity stays in a subspace that is fixed in space.
    reference_point_subspace: Return the subspace of se(n) in which the velocity of the body's reference point stays ...
    is_symmetric_pair: Tell whether the algebra has a subalgebra that forms a symmetric pair with the constraint ...
    ImpossibleBodyWarning: An inertia tensor that no distribution of mass has: one principal moment is larger than ...

Groups:
    SO: Return the rotation group $SO(n)$, $n \ge 2$.
    SE: Return the group $SE(n)$, $n \ge 2$, of rigid motions as $(n + 1) \times (n + 1)$ matrices.
    MatrixGroup: The connected group of matrices whose Lie algebra is spanned by a basis; coordinates are its ...
    Translations: The vectors of $\mathbb R^m$ as matrices $\begin{pmatrix} I & x \\ 0 & 1\end{pmatrix}$; the pose ...
    ProductGroup: The product $G_1 \times \dots \times G_m$; coordinates and poses are those of the factors, one ...

Forces:
    Forced: A system under a potential U and a force f, a body covector; both act along the constraint alone.
    Gravity: The potential of a constant spatial force F at the body point x, $U(g) = -F\cdot(g\,x)$.
    Friction: The force $-C\omega$ against a body velocity, with $\omega\cdot C\omega \ge 0$: it never adds energy.

Systems in coordinates, and ready ones:
    examples: Ready systems of the literature, each with a start and with what is known about its motion.
    LagrangeDAlembert: A mechanical system on $\mathbb{R}^n$ with linear velocity constraints, and its discrete ...
    GroupLagrangeDAlembert: A left-invariant Lagrangian on a matrix group with velocity constraints that may depend ...
    mass_tensor_lagrangian: Return the discrete Lagrangian of a body with a mass tensor, for `GroupLagrangeDAlembert`.

One step of the discrete map:
    discretize: Discretize a system: choose the discrete Lagrangian and the variety that displacements lie on.
    Discretization: A discretized system, made by `discretize`.
    step: Take one step of the discrete map: from $P_k$ to $P_{k+1}$, with the displacement $W_{k+1}$ at the new ...
    discrete_legendre: Return the discrete body momentum of a displacement, in physical units.
    inverse_discrete_legendre: Return the displacement that a full momentum on the momentum locus belongs to: $P(W) ...
    allow_float32: Let the JAX route be traced in 32 bits, where energy is conserved to 1e-7 instead of rounding.

Every value of the map:
    branches: Find every value of the discrete map: all $W'$ that may follow a displacement $W$.
    displacements_over: Find every displacement whose discrete momentum has given components along the constraint ...
    branch_tree: Find all images of a displacement under the discrete map, all images of these, and so on.
    fold_distance: Return how regular the restricted Legendre map is at a displacement: 1 at the identity, 0 at a fold.
    single_valued_region: Return the energy below which the discrete sleigh is single-valued.

One motion:
    simulate: Run the discrete Euler-Poincare-Suslov map.
    flow: Solve the Euler-Poincare-Suslov equations.
    iterate: Run the discrete map as `simulate` does, and give its orbit block by block, in bounded memory.
    Orbit: A motion at K saved states, from `simulate` or `flow`.
    AliasingWarning: Given poses of which one is turned by more than 90 degrees from the one before.
    Outcome: The end of a step or a run.
    OutcomeError: A run that cannot continue; `outcome` says why and `orbit`, where there is one, holds every good step.
    vector_field: Return the equations of motion as a function (time, state) -> derivative, for your own solver.

Events:
    crossings: Find where an orbit crosses zero of a function of its states.
    Crossings: The crossings of one event, in order of time.
    Event: A function of the state whose changes of sign along a motion are of interest.
    EventLog: The crossings of all events of a run, by name or position.
    cusp: The event of a sleigh whose velocity $v_1$ along the blade changes sign: its path in the plane has a cusp ...

Pictures and the live page:
    plot: Pictures for papers and slides (matplotlib): momenta, tracks in space, energy errors, overviews, animations.
    explore: Return the live page of a motion: one file that runs the library's own kernel in the browser.

Many motions:
    ensemble: Run or solve many members of one system, that differ in where they start, in parameters, or in both.
    Ensemble: Motions of M members at K saved states, from `ensemble`: arrays as in an `Orbit`, with a leading ...
    sweep: Run a task for every member of a design and keep what it returns in one store.
    EnsembleTask: Run the members of a design and keep some numbers of each.
    FamilyTask: Run the members of a family: systems that a function of parameters makes, such as ...
    MemberBlock: Some members of a sweep in order: a mapping of names to arrays whose first axis is that of the members.
    dataset: Write a data set of orbits of a ready system, for people who train models.
    load_sweep: Open the result of a finished sweep, after checking every chunk of it.
    Grid: Every combination of values along axes.
    RandomDesign: Members drawn from distributions: member i is the same in every design with this seed, however ...
    Choice: One of some values, all with the same probability.
    Direction: Vectors of one length that point anywhere with the same probability.
    LogUniform: Positive numbers whose logarithms lie evenly between those of two bounds.
    MassTensor: Mass tensors $J = Q\,\mathrm{diag}(\lambda)\,Q^T$: eigenvalues between two bounds, axes that point ...
    Normal: Normal numbers, or with `size` vectors of independent ones.
    Uniform: Numbers between two bounds, or vectors of them if the bounds are vectors.

Stores:
    save_orbit: Save an orbit as a Zarr store that `load_orbit` reads back bit for bit and `xarray.open_zarr` opens.
    load_orbit: Load an orbit saved by `save_orbit`, bit for bit.
    resume: Resume the run or the sweep of a store, with the bits of one that was never stopped.
    extend: Run past the end of the run of a store, with the bits of one that had been that long from the start.

What is kept, and how exactly:
    invariants: Measure what an orbit should keep.
    compare: Compare an orbit with another one, state by state: errors of momentum, pose and energy.
    conserved_momenta: Return the components of body and spatial momentum that every motion of a system conserves.
    invariant_measure: Tell which densities of restricted momenta the flow of a system, or its discrete map, keeps.
    lyapunov_function: Return the function of the momentum that falls along every motion that is not an equilibrium.
    lyapunov_exponents: Return the finite-time Lyapunov exponents of the momenta along an orbit, largest first.

Where motions come from and go to:
    equilibria: Return the equilibria of a system or of its discrete map, with their transverse spectrum at an energy.
    asymptotics: Return where the motions of a system, or one orbit of a flow or of a discrete map, come from and go to.
    critical_energies: Return the critical values of the energy on the displacement variety of a top in three ...
    heteroclinic: Trace an orbit of the discrete map from near the repelling to near the attracting equilibrium.
    half_planes: Tell in which half-planes displacements or momenta lie.
    flow_obstruction: Return the periodic function that would be constant if the map were that of a smooth flow.

The surface of discrete momenta:
    momentum_locus: Return the surface $\{P(W) : W \in \exp\mathfrak{d}\}$ of the discrete momenta of a top (n = 3) ...
    invariant_curve: Return the curve of displacements with a reduced constrained energy, all its components.

Gaits, the geometry of locomotion:
    ShapedBody: A body on a matrix group G with a shape s, seen from itself: for `local_connection` and what follows ...
    local_connection: Return the local connection of a system: the body velocity that a change of shape causes.
    geometric_phase: Return the displacement by a gait: a closed motion s(t) of the shape, which its owner prescribes.
    accessibility: Return how far brackets of admissible velocities lead from a configuration.

Derivatives, measured motion, control:
    rollout: Run the discrete map as `simulate` does, as a pure JAX function of body, start and controls.
    fit: Fit the numbers of a body to recorded motion, and the start of each trial with them.
    steer: Find forces along the constraint that take a body from a start to a goal with little effort.
    tracking_feedback: Make the linear feedback along an orbit that spends least on errors and on forces together (LQR).

Checks of custom systems:
    testing: The properties that groups, systems and discretizations must have, checked for ours and for users' own.
    consistency_defect: Return how far a displacement variety is from consistency with a discretization map; zero if ...

The paper's own formulas:
    in_exp_d: Tell whether a rotation is a displacement $\exp(\theta\,u\wedge e_n)$ of the Suslov top in its ...
    trace_constraints: Return the constraints of the discrete Suslov top between two configurations; they vanish if ...
    euler_angle_discrete_lagrangian: Return $\mathrm{tr}\,J - \mathrm{tr}(R_k^TR_{k+1}J)$ of two rotations given by ...
    moser_veselov_displacement: Return the displacement of the free top on SO(n) with a given momentum, on the ...
"""
# A new name is a line of its group above; `python docs/make_api_pages.py` writes what it is for, here and on the pages.

import importlib
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from nonholo import literature as examples  # noqa: F401
    from nonholo import plotting as plot  # noqa: F401
    from nonholo import testing as testing
    from nonholo.analysis import ShapedBody as ShapedBody
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
    from nonholo.analysis.steering import steer as steer
    from nonholo.analysis.steering import tracking_feedback as tracking_feedback
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
    from nonholo.ensembles import FamilyTask as FamilyTask
    from nonholo.ensembles import Grid as Grid
    from nonholo.ensembles import LogUniform as LogUniform
    from nonholo.ensembles import MassTensor as MassTensor
    from nonholo.ensembles import MemberBlock as MemberBlock
    from nonholo.ensembles import Normal as Normal
    from nonholo.ensembles import RandomDesign as RandomDesign
    from nonholo.ensembles import Uniform as Uniform
    from nonholo.ensembles import dataset as dataset
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
    from nonholo.orbit import AliasingWarning as AliasingWarning
    from nonholo.orbit import Orbit as Orbit
    from nonholo.simulation import Crossings as Crossings
    from nonholo.simulation import Ensemble as Ensemble
    from nonholo.simulation import Event as Event
    from nonholo.simulation import EventLog as EventLog
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
    "AliasingWarning": "orbit",
    "ChaplyginSleigh": "systems",
    "Choice": "ensembles",
    "Crossings": "simulation",
    "Direction": "ensembles",
    "Discretization": "discrete",
    "Ensemble": "simulation",
    "EnsembleTask": "ensembles",
    "FamilyTask": "ensembles",
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
    "ShapedBody": "analysis",
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
    "dataset": "ensembles",
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
    "steer": "analysis.steering",
    "step": "discrete._step",
    "sweep": "ensembles",
    "trace_constraints": "systems",
    "tracking_feedback": "analysis.steering",
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
