r"""The interfaces of nonholonomic systems on matrix groups, and what follows from them.

The kinetic energy is $\tfrac12\langle\omega, \mathbb{I}\omega\rangle$ with the body velocity $\omega = g^{-1}\dot g$.
The constraint is left-invariant, $\omega \in \mathfrak{d}$ (LL systems), or right-invariant,
$\mathrm{Ad}_g\omega \in \mathfrak{d}$ (LR systems). Time steps and solvers live elsewhere.
"""

import abc
import dataclasses
import functools
from typing import Any, ClassVar, TypeVar, cast

import numpy as np

from nonholo.base.checks import assign, error, instance, is_traced, shape_of, trailing, within_memory
from nonholo.base.html import table
from nonholo.base.memo import Keeper, system_memo
from nonholo.base.numerics import Factors, applied, factors_of, solve_by_factors
from nonholo.base.types import Array, Bool, Float, Inexact
from nonholo.groups import AbstractMatrixGroup
from nonholo.systems import _mass
from nonholo.systems._equilibria import Equilibria, equilibria_of, transverse_rates
from nonholo.systems._mass import WideInertia
from nonholo.systems._normal_form import NormalForm
from nonholo.systems._subspace import complement

_ROUNDING = 1e-12  # relative
SystemT = TypeVar("SystemT", bound="AbstractSystem")
Covectors = Inexact[Array, "... dim"]
Along = Float[Array, "... k"]
"""Numbers along the rows of a constraint subspace."""
Poses = Float[Array, "... N N"]
"""Matrices of the group."""


class _Leaves:
    """The fields of a dataclass that are not its `structure`."""

    def __get__(self, owner: Any, kind: Any) -> Any:
        return tuple(field.name for field in dataclasses.fields(kind) if field.name not in kind.structure)


class AbstractTree:
    """A dataclass that JAX takes apart: numbers, and what is fixed."""

    leaves: ClassVar[tuple[str, ...]] = cast(Any, _Leaves())
    """Fields that are differentiable numbers, all that are not fixed; None where a field is not used."""
    structure: ClassVar[tuple[str, ...]] = ()
    """Fields that are fixed: groups, subspaces, axes."""


class AbstractSystem(AbstractTree, Keeper, abc.ABC):
    """A kinetic energy that is invariant under left translations, with a linear constraint on velocities.

    The constraint is fixed in the body, unless a class says otherwise. A system states its group, mass tensor,
    constraint subspace and annihilator in the user's body frame. Kernels work in its canonical body frame: `canonical`
    is the same body seen from `frame`, that is g_canonical = g @ frame.
    """

    group: AbstractMatrixGroup
    mass_tensor: Any
    is_spatial: ClassVar[bool] = False
    """Whether the constraint is fixed in space (right-invariant) instead of in the body (left-invariant)."""
    is_forced: ClassVar[bool] = False
    """Whether it is a `Forced`; questions about free motions are then refused."""
    normal_form: NormalForm | None = None
    """The top or sleigh that the system is, in the axes of its constraint; None if it is neither."""
    forces: Any = None
    """The system itself where a potential or a force acts on it (`Forced`); None of a free one."""
    has_blade: ClassVar[bool] = False
    """Whether the last row of the constraint subspace is the velocity along a blade, at its point of contact."""

    def __repr__(self) -> str:
        facts = {"inertia operator": np.asarray(self.inertia_operator)}
        if getattr(self, "mass_tensor", None) is not None:
            facts = _mass.tensors_shown(self.group, self.mass_tensor)
        if "constraint_subspace" in self.structure:
            facts |= {"constraint subspace": np.asarray(self.constraint_subspace)}
        return f"{type(self).__name__}({self.group!r},\n  {_mass.lines_of(facts)})"

    def _repr_html_(self) -> str:
        constraint = "fixed in space" if self.is_spatial else "fixed in the body"
        rows = [("body", repr(self)), ("moves on", self.group), ("constraint", constraint)]
        return table(type(self).__name__, rows)

    def _hold(self, *values: Any) -> None:
        """Set the fields, in their order."""
        for field, value in zip(dataclasses.fields(cast(Any, self)), values, strict=True):
            object.__setattr__(self, field.name, value)

    @system_memo
    def homogeneous_mass_tensor(self) -> Poses | None:
        """The mass tensor on which the group's matrices act; None if the inertia operator was given directly."""
        return self.mass_tensor

    @system_memo
    def inertia_operator(self) -> Float[Array, "... dim dim"]:
        """The symmetric matrix that takes body velocity to body momentum, by default that of the mass tensor."""
        return _mass.inertia_from_mass_tensor(self.group, self.homogeneous_mass_tensor)

    @property
    def displacement_units(self) -> Float[np.ndarray, "dim"]:
        """Units of the algebra: see `displacement_units`."""
        return _mass.displacement_units(self.group, np.asarray(self.inertia_operator))

    @property
    @abc.abstractmethod
    def constraint_subspace(self) -> Float[np.ndarray, "k dim"]:
        """Rows span the subspace of the constraint; k runs from 0 to dim."""

    def stack(self, /, **numbers: Array) -> Any:
        """Return the systems of many numbers in one: they have an axis in front; None where formulas do not allow it.

        Args:
            numbers: All `leaves` that are used.
        """

    @property
    def is_clear(self) -> Bool[np.ndarray, "..."]:
        """Whether the class certainly does not refuse the numbers; of many systems in one for each."""
        J = self.homogeneous_mass_tensor
        if J is None or not self.group.is_rigid:
            return np.asarray(False)
        eigenvalues = np.linalg.eigvalsh(J)
        is_symmetric = (J.mT == J).all(axis=(-2, -1))
        return np.asarray(is_symmetric & (eigenvalues[..., 0] > 1e-12 * eigenvalues[..., -1]))

    @system_memo
    def annihilator(self) -> Float[np.ndarray, "s dim"]:
        """Rows span the covectors that vanish on the constraint subspace; multipliers refer to them.

        By default the remaining coordinate rows, or orthonormal ones if the subspace has no coordinate rows.
        """
        return complement(self.constraint_subspace)

    @property
    def canonical(self: SystemT) -> SystemT:
        """The same body in the canonical frame; the system itself where no frame is better than the user's."""
        return self

    @property
    def shapes(self) -> tuple[tuple[int, ...], tuple[int, ...]]:
        """Shapes of a configuration and of a velocity."""
        return (self.group.size, self.group.size), (self.group.dim,)

    @system_memo
    def frame(self) -> Float[Array, "... N N"]:
        """The canonical body frame as seen from the user's: a group element that maps the constraint to itself.

        The identity where no frame is better than the user's.
        """
        return self.group.identity

    @system_memo
    def frame_map(self) -> Float[Array, "... k k"]:
        """C with r_canonical = C r for momenta along the constraint subspace (and y = y_canonical C for charts)."""
        if self.canonical is self:
            within_memory("The frame map of a body", 8.0 * self.rank**2, "Take a smaller n.")
            return np.eye(self.rank)
        images = self.canonical.constraint_subspace @ self.group.adjoint(self.frame).mT
        return images @ np.linalg.pinv(self.constraint_subspace)

    @system_memo
    def inverse_frame_map(self) -> Float[Array, "... k k"]:
        """The inverse of `frame_map`."""
        return np.linalg.inv(self.frame_map)

    def to_canonical(self, restricted_momentum: Inexact[Array, "... k"]) -> Inexact[Array, "... k"]:
        """Return momenta along the canonical rows from those along the rows of the constraint subspace."""
        restricted = self._along("restricted_momentum", restricted_momentum)
        return restricted if self.canonical is self else applied(self.frame_map, restricted)

    def from_canonical(self, reduced_momentum: Float[Array, "... k"]) -> Float[Array, "... k"]:
        """Return momenta along the rows of the constraint subspace from those along the canonical ones."""
        reduced = self._along("reduced_momentum", reduced_momentum)
        return reduced if self.canonical is self else applied(self.inverse_frame_map, reduced)

    def to_canonical_frame(self, displacement: Array) -> Array:
        """Return a displacement, or a velocity as a matrix, as seen from the canonical frame."""
        return self.group.inverse(self.frame) @ displacement @ self.frame

    def from_canonical_frame(self, displacement: Array) -> Array:
        """Return what is seen from the canonical frame as seen from the user's."""
        return self.frame @ displacement @ self.group.inverse(self.frame)

    @system_memo
    def inertia_along(self) -> Float[Array, "... k k"] | WideInertia:
        r"""The inertia along the rows of the constraint subspace, $S\,\mathbb{I}\,S^T$; its parts if too large."""
        rows, mass_tensor = self.constraint_subspace, self.homogeneous_mass_tensor
        if mass_tensor is None:
            return rows @ self.inertia_operator @ rows.T
        return _mass.inertia_form(self.group, self.group.hat(rows), mass_tensor)

    @functools.cached_property
    def inertia_factors(self) -> Factors | None:
        """The factors of a matrix `inertia_along`; None of others, and of one that is not positive definite."""
        inertia = self.inertia_along
        return factors_of(inertia) if isinstance(inertia, np.ndarray) and not is_traced(inertia) else None

    @property
    def inside(self) -> "AbstractSystem":
        """The body on which forces act: a `Forced` has it inside; the system itself where there are none."""
        return self

    @property
    def is_wide(self) -> bool:
        """Whether the system has its mass tensor without a matrix."""
        form = self.normal_form
        return form is not None and form.is_diagonal

    @property
    def form_frame(self) -> Float[Array, "N N"]:
        """The axes of the normal form as seen from the user's frame."""
        form = self.normal_form
        return self.frame if form is None or form.frame is None else self.frame @ form.frame

    @property
    def form_map(self) -> Float[np.ndarray, "k k"]:
        """C with r_form = C r for momenta along the constraint subspace; of systems with a normal form."""
        form = self.normal_form
        return self.frame_map if form is None or form.frame_map is None else form.frame_map @ self.frame_map

    @system_memo
    def frame_pose(self) -> Float[np.ndarray, "... size"]:
        """The frame as a compact pose: the canonical pose of a body at the identity."""
        return self.group.pose_from_matrix(self.frame)

    @functools.cached_property
    def rank(self) -> int:
        """The number k of rows of the constraint subspace."""
        inertia = self.inertia_along
        return inertia.rank if isinstance(inertia, WideInertia) else inertia.shape[-1]

    @property
    def constrained_inertia(self) -> Float[Array, "k k"]:
        r"""The inertia operator restricted to the constraint subspace, in its rows: $S\,\mathbb{I}\,S^T$."""
        inertia = self.inertia_along
        return inertia.dense if isinstance(inertia, WideInertia) else inertia

    def carried(self, configuration: Poses) -> Float[Array, "... dim dim"]:
        r"""Return the matrix from body velocities to those whose constraint is fixed: the identity, or $\mathrm{Ad}_g$.

        Args:
            configuration: g.

        Example:
            >>> quarter = nh.SO(3).exp(np.array([0.0, 0.0, np.pi / 2]))
            >>> nh.VeselovaTop(np.diag([1.0, 2.0, 3.0])).carried(quarter).round(12) + 0.0
            array([[ 0., -1.,  0.],
                   [ 1.,  0.,  0.],
                   [ 0.,  0.,  1.]])
            >>> bool(np.all(nh.SuslovTop(np.diag([1.0, 2.0, 3.0])).carried(quarter) == np.eye(3)))
            True
        """
        return np.eye(self.group.dim)

    def constraint_velocity(self, velocity: Array, configuration: Poses | None) -> Array:
        r"""Return a body velocity as the constraint sees it: itself, or $\mathrm{Ad}_g\omega$ in space."""
        return velocity

    def constraint_momentum(self, momentum: Covectors, configuration: Poses | None) -> Covectors:
        r"""Return a body momentum as the constraint sees it: itself, or $\mathrm{Ad}^*_{g^{-1}}p$."""
        return momentum

    def directions(self, configuration: Poses) -> Float[Array, "... dim k"]:
        r"""Return E, whose columns are admissible body velocities: $S^T$, or $\mathrm{Ad}_{g^{-1}}S^T$."""
        return np.asarray(self.constraint_subspace).T

    def moved(self, configuration: Poses, displacement: Array) -> Poses:
        """Return a pose after a displacement that the constraint sees: g W, or W g where it is fixed in space.

        Args:
            configuration: g.
            displacement: W, (..., N, N).
        """
        return configuration @ displacement

    def constraint_poses(self, states: Any) -> Poses | None:
        """Return the poses of states where the constraint is fixed in space, and so turns in the body; else None."""
        return None

    def in_body(self, displacement: Array, configuration: Poses | None) -> Array:
        r"""Return a displacement D as the body sees it: D, or $g^{-1}Dg$ where the constraint is fixed in space."""
        return displacement

    def restrict_at(self, momentum: Covectors, configuration: Poses | None = None) -> Inexact[Array, "... k"]:
        r"""Return the components of a body momentum along the constraint of a body at a configuration.

        Args:
            momentum: A full momentum.
            configuration: g; needed where the constraint is fixed in space, where they are those of the spatial
                momentum, $S\,\mathrm{Ad}^*_{g^{-1}}p$.
        """
        return self.components_along(self._full(momentum), configuration)

    def components_along(self, momentum: Covectors, configuration: Poses | None) -> Inexact[Array, "... k"]:
        """Return the components of `restrict_at` for a momentum that is checked."""
        return applied(self.constraint_subspace, self.constraint_momentum(momentum, configuration))

    def restricted_velocity(self, restricted_momentum: Along, configuration: Poses | None = None) -> Along:
        """Return the velocity, in rows of the constraint subspace, that has these momenta along it.

        Args:
            restricted_momentum: r.
            configuration: g; needed where the constraint is fixed in space.
        """
        momentum, inertia = self._along("restricted_momentum", restricted_momentum), self.inertia_along
        if isinstance(momentum, np.ndarray) and self.inertia_factors is not None:
            return solve_by_factors(self.inertia_factors, momentum)
        return inertia.velocities(momentum) if isinstance(inertia, WideInertia) else _solve(inertia, momentum)

    def restricted_momentum(self, restricted_velocity: Along, configuration: Poses | None = None) -> Along:
        """Return the momenta along the constraint subspace of velocities in its rows.

        Args:
            restricted_velocity: w.
            configuration: g, by default the identity; it matters where the constraint is fixed in space.
        """
        return self.momenta_along(self._along("restricted_velocity", restricted_velocity), configuration)

    def momenta_along(self, velocity: Along, configuration: Poses | None) -> Along:
        """Return the momenta of `restricted_momentum` for velocities that are checked."""
        form = self.inertia_along
        return form.momenta(velocity) if isinstance(form, WideInertia) else applied(form.mT, velocity)

    def constrained_energy(
        self, momentum: Covectors | Along, configuration: Poses | None = None
    ) -> Float[Array, "..."]:
        r"""Return the reduced constrained energy $\tfrac12\,r\cdot(\mathbb{I}|_\mathfrak{d})^{-1}\,r$ of a momentum.

        Here $r = p|_\mathfrak{d}$ are its components along the constraint subspace. Where that is fixed in space, they
        are those of the spatial momentum and the inertia is $B(g)$ (`AbstractLRSystem.spatial_inertia`).

        Args:
            momentum: A momentum, or its components along the rows of the constraint subspace (what k numbers are taken
                for, also when k = dim).
            configuration: g; needed where the constraint is fixed in space.

        Example:
            >>> ChaplyginSleigh(mass=2.0, inertia=1.0, a=0.5).constrained_energy([0.0, 2.0, 0.0])
            np.float64(1.0)
            >>> from nonholo.systems import VeselovaTop
            >>> VeselovaTop(np.diag([1.0, 2.0, 3.0])).constrained_energy([4.0, 0.0], np.eye(3))
            np.float64(2.0)
        """
        is_restricted = shape_of(momentum)[-1:] == (self.rank,)
        r = self._along("momentum", momentum if is_restricted else self.restrict_at(momentum, configuration))
        return (r * self.restricted_velocity(r, configuration)).sum(axis=-1) / 2

    def restrict(self, momentum: Covectors) -> Inexact[Array, "... k"]:
        """Return the components of a momentum along the rows of the constraint subspace."""
        return applied(self.constraint_subspace, self._full(momentum))

    def _full(self, momentum: Array) -> Array:
        where, remedy = lambda: f"{type(self).__name__}.restrict(momentum=...)", "Pass a full momentum."
        return trailing(where, momentum, (self.group.dim,), remedy)

    def _along(self, name: str, value: Array) -> Array:
        remedy = "Pass one number for each row of the constraint subspace."
        return trailing(lambda: f"{type(self).__name__} ({name}=...)", value, (self.rank,), remedy)


def replace_numbers(system: SystemT, /, **numbers: Array) -> SystemT:
    """Return a system with other numbers, unchecked: they may have axes in front, where its formulas allow them."""
    other = object.__new__(type(system))
    assign(other, **{name: numbers.get(name, getattr(system, name)) for name in (*system.leaves, *system.structure)})
    return other


class AbstractLLSystem(AbstractSystem):
    r"""A left-invariant Lagrangian with a left-invariant constraint: body velocities lie in $\mathfrak{d}$."""

    def equilibria(self) -> Equilibria:
        r"""Return the body velocities that stay constant, and the half of them that attracts.

        Of a top the permanent rotations: the line spanned by c, its negative half attracting. Of a sleigh the straight
        motions, those in the direction of its center of mass attracting; where that lies beside the blade
        ($a_1 = 0$), the turns along c about it, and the straight motions. Every admissible velocity if c = 0 too.

        Of any other system with two admissible directions a line, or both; with three the real eigenspaces of a matrix
        (docs/theory/groups-and-systems.md): one to three lines, or a plane, alone or with a line, or all.

        Raises:
            ValueError: Velocities change in four directions or more, and the system is neither a top nor a sleigh.

        Example:
            >>> nh.SuslovTop([[1.0, 0.0, 0.5], [0.0, 1.0, 0.0], [0.5, 0.0, 1.0]]).equilibria().attracting
            array([-0. , -0.5, -0. ])
            >>> nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=-0.5).equilibria().attracting
            array([-0., -1., -0.])
            >>> axes = nh.RigidBody(np.diag([1.0, 2.0, 3.0])).equilibria()
            >>> axes.subspace.round(3), [axis.subspace.round(3).tolist() for axis in axes.others]
            (array([[0.   , 0.   , 0.577]]), [[[0.0, 0.5, 0.0]], [[0.447, 0.0, 0.0]]])
        """
        return equilibria_of(self)

    def transverse_rates(
        self, velocity: Float[Array, "dim"], subspace: Float[Array, "m dim"]
    ) -> Float[np.ndarray, "j"] | Inexact[np.ndarray, "j"]:
        r"""Return the rates at which small deviations from an equilibrium grow, across a linear space of equilibria.

        Eigenvalues of the linearized reduced equations on the quotient of $\mathfrak{d}$ by the space: negative ones
        attract, imaginary ones oscillate.

        Args:
            velocity: The equilibrium, a body velocity.
            subspace: Rows span a linear space of equilibria that it lies in, such as `equilibria().subspace`.

        Example:
            >>> body = nh.RigidBody(np.diag([1.0, 2.0, 3.0]))
            >>> body.transverse_rates([0.0, 1.0, 0.0], [[0.0, 1.0, 0.0]]).round(3)  # the middle axis
            array([-0.258,  0.258])
        """
        return transverse_rates(self, velocity, subspace)


class AbstractLRSystem(AbstractSystem):
    r"""A left-invariant Lagrangian with a right-invariant constraint: spatial velocities lie in $\mathfrak{d}$.

    $$ \dot p = \mathrm{ad}^*_\omega p + \sum_j \lambda_j \mathrm{Ad}^*_g a^j, \qquad \mathrm{Ad}_g\omega \in
       \mathfrak{d}, \qquad \mu = \mathrm{Ad}^*_{g^{-1}} p, \quad \mu|_\mathfrak{d} = \mathrm{const}. $$

    The subspace and its annihilator are fixed in space; the inertia along them turns with the body, and
    `constrained_inertia` is that of a body at the identity.
    """

    is_spatial: ClassVar[bool] = True

    def spatial_inertia(self, configuration: Poses) -> Float[Array, "... k k"]:
        r"""Return the inertia along the constraint subspace of a body with this configuration.

        $$ B(g) = S\,\mathrm{Ad}_{g^{-1}}^T\,\mathbb{I}\,\mathrm{Ad}_{g^{-1}}\,S^T
                = \bigl(\mathrm{tr}(D_i\, g\mathbb{J}g^T D_j^T)\bigr)_{ij}, $$

        with the matrices $D_i$ of the rows $S$; the second form holds for a mass tensor.

        Args:
            configuration: g.

        Example:
            >>> from nonholo.systems import VeselovaTop
            >>> VeselovaTop(np.diag([1.0, 2.0, 3.0])).spatial_inertia(np.eye(3))
            array([[4., 0.],
                   [0., 5.]])
        """
        g = self._at(configuration)
        rows, mass_tensor = self.constraint_subspace, self.homogeneous_mass_tensor
        if mass_tensor is not None:
            return _mass.inertia_form(self.group, self.group.hat(rows), g @ mass_tensor @ g.mT)
        images = rows @ self.group.adjoint(self.group.inverse(g)).mT
        return images @ self.inertia_operator @ images.mT

    def _at(self, configuration: Array | None) -> Array:
        where, remedy = f"{type(self).__name__} (configuration=...)", "Pass the matrix of a pose."
        if configuration is None:
            raise error(where, "be given where the constraint is fixed in space", "none", remedy)
        return trailing(where, configuration, (self.group.size, self.group.size), remedy)

    def carried(self, configuration: Poses) -> Float[Array, "... dim dim"]:
        r"""Return $\mathrm{Ad}_g$: the constraint is fixed in space."""
        return self.group.adjoint(self._at(configuration))

    def constraint_velocity(self, velocity: Array, configuration: Poses | None) -> Array:
        r"""Return $\mathrm{Ad}_g\omega$."""
        return applied(self.carried(configuration), velocity)

    def constraint_momentum(self, momentum: Covectors, configuration: Poses | None) -> Covectors:
        r"""Return $\mathrm{Ad}^*_{g^{-1}}p$."""
        return self.group.coadjoint(self.group.inverse(self._at(configuration)), momentum)

    def directions(self, configuration: Poses) -> Float[Array, "... dim k"]:
        r"""Return $\mathrm{Ad}_{g^{-1}}S^T$."""
        return self.group.adjoint(self.group.inverse(configuration)) @ self.constraint_subspace.T

    def moved(self, configuration: Poses, displacement: Array) -> Poses:
        """Return W g of a displacement in space."""
        return displacement @ configuration

    def constraint_poses(self, states: Any) -> Poses:
        """Return the poses of states."""
        return states.configuration

    def in_body(self, displacement: Array, configuration: Poses) -> Array:
        r"""Return $g^{-1}Dg$."""
        return self.group.inverse(configuration) @ displacement @ configuration

    def restricted_velocity(self, restricted_momentum: Along, configuration: Poses | None = None) -> Along:
        """Return the spatial velocity, in rows of the constraint subspace, that has these spatial momenta along it."""
        inertia = self.spatial_inertia(self._at(configuration))
        return _solve(inertia, self._along("restricted_momentum", restricted_momentum))

    def momenta_along(self, velocity: Along, configuration: Poses | None) -> Along:
        """Return the spatial momenta along the constraint subspace of spatial velocities in its rows."""
        inertia = self.constrained_inertia if configuration is None else self.spatial_inertia(configuration)
        return applied(inertia.mT, velocity)


System = AbstractSystem
"""Any system on a group."""


def have_same_rows(system: AbstractSystem, other: AbstractSystem) -> bool:
    """Return whether two systems have the same constraint subspace up to rounding, in the units of the second."""
    first, second = (each.constraint_subspace / other.displacement_units for each in (system, other))
    return first.shape == second.shape and np.allclose(first, second, 0.0, _ROUNDING * np.abs(second).max(initial=0.0))


def as_system(where: str, value: Any) -> "AbstractSystem":
    """Return a system on a group; anything else is refused."""
    remedy = "Pass a SuslovTop or an LLSystem; of a ready example its `.system`."
    return instance(where, value, AbstractSystem, "be a system", remedy)


def refuse_forces(where: str, system: Any) -> None:
    """Refuse a system with forces where only free motions are known."""
    if getattr(system, "is_forced", False):
        remedy = "Pass the system inside, or compute the quantity from an orbit."
        raise error(where, "be a system without forces", "Forced", remedy)


def refuse_fixed_in_space(where: str, system: Any, remedy: str, got: str = "") -> None:
    """Refuse what is no system, or one whose constraint is fixed in space: steps or momenta depend on the pose."""
    if getattr(system, "is_spatial", True):
        raise error(where, "have a left-invariant constraint", got or type(system).__name__, remedy)


def refuse_slip(where: str, system: Any) -> None:
    """Refuse rows of a constraint that may yield, which steps of the discrete map alone decide."""
    if system.forces is not None and system.forces.slips:
        remedy = "Run it by `simulate`, `iterate`, `ensemble` or `flow`, or leave the slip out."
        raise error(where, "have a constraint that never yields", "Slip", remedy)


def _solve(matrix: Float[Array, "... k k"], vector: Float[Array, "... k"]) -> Float[Array, "... k"]:
    xp = (vector if is_traced(vector) else matrix).__array_namespace__()
    return xp.linalg.solve(xp.asarray(matrix), xp.asarray(vector)[..., None])[..., 0]
