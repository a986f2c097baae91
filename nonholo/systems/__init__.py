"""Systems: a group, an inertia operator and the subspace that velocities are constrained to."""

from nonholo.systems import families, forces
from nonholo.systems._base import (
    AbstractLLSystem,
    AbstractLRSystem,
    AbstractSystem,
    Equilibria,
    System,
    as_system,
    have_same_rows,
    refuse_fixed_in_space,
    refuse_forces,
    refuse_slip,
)
from nonholo.systems._coordinate_system import (
    AbstractCoordinateDiscretization,
    AbstractCoordinateSystem,
    DiscretizationT,
    OrbitT,
    in_coordinates,
)
from nonholo.systems._displacements import euler_angle_discrete_lagrangian, in_exp_d, trace_constraints
from nonholo.systems._equilibria import gyroscopic_form
from nonholo.systems._mass import (
    ImpossibleBodyWarning,
    alike_in_time,
    checked_group,
    direction_lengths,
    displacement_units,
    extent_of,
    group_mass_tensor,
    inertia_form,
    inertia_from_mass_tensor,
    inertia_tensor,
    mass_tensor_from_inertia,
    reach_of,
    refuse_wide,
)
from nonholo.systems._normal_form import NormalForm
from nonholo.systems._start import Start, in_group, inadmissible, of_finite_energy, one_start, refuse_in_coordinates
from nonholo.systems._subspace import (
    is_symmetric_pair,
    null_space,
    reference_point_subspace,
    row_space,
    symmetric_complement,
)
from nonholo.systems.families import (
    ArrowheadSleigh,
    ArrowheadTop,
    ChaplyginSleigh,
    LLSystem,
    LRSystem,
    MultidimensionalSleigh,
    RigidBody,
    SuslovTop,
    VeselovaTop,
)
from nonholo.systems.forces import (
    Contacts,
    Forced,
    Friction,
    Gravity,
    Linear,
    Mode,
    Slip,
    Spring,
    Widened,
    central_differences,
    force_of,
    terms_of,
)

SYSTEMS = tuple(kind for kind in vars(families).values() if isinstance(kind, type))
"""Every final class of this room."""
