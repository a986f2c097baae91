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
    is_symmetric_pair: Return whether the algebra has a subalgebra that forms a symmetric pair with the constraint ...
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
    Linear: The potential $U(g) = \mathrm{tr}(A^Tg) = \sum_{ij}A_{ij}g_{ij}$: a magnet, a field, weights at several ...
    Spring: The potential of a spring between the body point x and the space point p, $U(g) = \tfrac k2(|gx - p| - ...
    Friction: The force $-C\omega$ against a body velocity, with $\omega\cdot C\omega \ge 0$: it never adds energy.
    Slip: Rows of a constraint that may yield: one contact with dry and viscous friction.

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
    branch_growth: Bound from below how fast the number of images of a plane sleigh under its three branches grows.
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
    OutcomeError: A run that cannot continue; `outcome` has the reason and `orbit`, where there is one, every good step.
    vector_field: Return the equations of motion as a function (time, state) -> derivative, for your own solver.

Events:
    crossings: Find where an orbit crosses zero of a function of its states.
    Crossings: The crossings of one event, in order of time.
    Event: A function of the state whose changes of sign along a motion are of interest.
    EventLog: The crossings of all events of a run, by name or position.
    Impact: The reset of an `Event` whose function is a gap: where it becomes zero the body hits a wall without ...
    cusp: The event of a sleigh whose velocity $v_1$ along the blade changes sign: its path in the plane has a cusp ...

Pictures and the live page:
    plot: Pictures for papers and slides (matplotlib): momenta, tracks in space, energy errors, overviews, animations.
    explore: Return the live page of a motion: one file that runs the library's own kernel in the browser.

Many motions:
    ensemble: Run or solve many members of one system, which differ in their starts, in parameters, or in both.
    Ensemble: Motions of M members at K saved states, from `ensemble`: arrays as in an `Orbit`, with a leading ...
    sweep: Run a task for every member of a design and keep its results in one store.
    EnsembleTask: Run the members of a design and keep some numbers of each.
    FamilyTask: Run the members of a family: systems that a function of parameters makes, such as ...
    MemberBlock: Some members of a sweep in order: a mapping of names to arrays whose first axis is that of the members.
    dataset: Write a data set of orbits of a ready system or your own, for people who train models.
    load_sweep: Open the result of a finished sweep, after checking every chunk of it.
    Grid: Every combination of values along axes.
    RandomDesign: Members drawn from distributions: member i is the same in every design with this `rng`, however ...
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

Conserved quantities:
    invariants: Measure the errors of an orbit in its invariants.
    compare: Compare an orbit with another one, state by state: errors of momentum, pose and energy.
    conserved_momenta: Return the components of body and spatial momentum that every motion of a system conserves.
    invariant_measure: Return which densities of restricted momenta the flow of a system, or its discrete map, keeps.
    lyapunov_function: Return the function of the momentum that falls along every motion that is not an equilibrium.
    lyapunov_exponents: Return the finite-time Lyapunov exponents along an orbit, largest first.

Where motions come from and go to:
    equilibria: Return the equilibria of a system or of its discrete map, with their transverse spectrum at an energy.
    linearize: Linearize a system, or its discrete map, beside a steady motion or at rest.
    asymptotics: Return where the motions of a system, or one orbit of a flow or of a discrete map, come from and go to.
    critical_values: Return the values of a parameter at which eigenvalues begin or cease to grow.
    critical_energies: Return the critical values of the energy on the displacement variety of a top.
    heteroclinic: Trace an orbit of the discrete map from near the repelling to near the attracting equilibrium.
    half_planes: Return the half-planes in which displacements or momenta lie.
    flow_obstruction: Return the periodic function that would be constant if the map were that of a smooth flow.

The surface of discrete momenta:
    momentum_locus: Return the surface $\{P(W) : W \in \exp\mathfrak{d}\}$ of the discrete momenta of a top (n = 3) ...
    invariant_curve: Return the curve of displacements with a reduced constrained energy, all its components.

Gaits, the geometry of locomotion:
    ShapedBody: A body on a matrix group G with a shape s, seen from itself: for `local_connection` and what follows ...
    local_connection: Return the local connection of a system: the body velocity that a change of shape causes.
    geometric_phase: Return the displacement by a gait: a closed motion s(t) of the shape, which its owner prescribes.
    accessibility: Return the directions to which brackets of admissible velocities lead from a configuration.

Derivatives, measured motion, control:
    rollout: Run the discrete map as `simulate` does, as a pure JAX function of body, start and controls.
    fit: Fit the parameters of a body, and the start of each trial, to recorded motion.
    steer: Find forces along the constraint that take a body from a start to a goal with little effort.
    tracking_feedback: Make the linear feedback along an orbit that spends least on errors and on forces together (LQR).

Checks of custom systems:
    testing: The properties that groups, systems and discretizations must have, checked for ours and for users' own.
    consistency_defect: Return the distance of a displacement variety from consistency with a discretization map; ...

The paper's own formulas:
    in_exp_d: Return whether a rotation is a displacement $\exp(\theta\,u\wedge e_n)$ of the Suslov top, in ...
    trace_constraints: Return the constraints of the discrete Suslov top between two configurations; they vanish if ...
    euler_angle_discrete_lagrangian: Return $\mathrm{tr}\,J - \mathrm{tr}(R_k^TR_{k+1}J)$ of two rotations given by ...
    moser_veselov_displacement: Return the displacement of the free top on SO(n) with a given momentum, on the ...
"""
# A new name is a line of its group above; `python docs/make_api_pages.py` writes what it is for, here and on the pages.

from typing import Any

import lazy_loader

_WITH_JAX = {"GroupLagrangeDAlembert", "LagrangeDAlembert", "mass_tensor_lagrangian"}
_WITH_JAX |= {"allow_float32", "rollout", "step"}

_public, _, _NAMES = lazy_loader.attach_stub(__name__, __file__)


def __getattr__(name: str) -> Any:
    if name == "__version__":
        from importlib.metadata import version

        return globals().setdefault(name, version("nonholo"))
    if name not in _NAMES:
        raise AttributeError(f"module 'nonholo' has no attribute {name!r}")
    return globals().setdefault(name, _with_jax(name) if name in _WITH_JAX else _public(name))


def _with_jax(name: str) -> Any:
    from nonholo.base.checks import needs

    with needs("jax", f"nonholo.{name}"):
        return _public(name)


def __dir__() -> list[str]:
    return sorted(_NAMES)
