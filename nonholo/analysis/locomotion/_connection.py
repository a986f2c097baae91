"""`local_connection`, the body velocity that a change of shape causes; `ShapedBody`; `accessibility`."""

import dataclasses
import functools
import itertools
from collections.abc import Callable
from typing import Any

import numpy as np

from nonholo.analysis.locomotion import _equations
from nonholo.base.checks import array, assign, choice, count, error, instance, names, needs, shown, text, trailing
from nonholo.base.results import result
from nonholo.base.types import Array, Float
from nonholo.groups import AbstractMatrixGroup, components_of
from nonholo.systems import AbstractCoordinateSystem, checked_group

_SAMPLES = 8  # shapes and poses at which the symmetry is checked
_SYMMETRIC = 1e-9  # relative
_INDEPENDENT = 1e-7  # least singular value of rows of length one


@result
class LocalConnection:
    r"""The local connection of a system, $\xi = -A(s)\,\dot s + \Gamma(s)\,p$.

    Attributes:
        system: The system.
        shape_coordinates: Names of the shape variables s: of a planar system all coordinates but position and heading.
        momentum_components: The components of $\xi$ that number the momenta p. None if the
            constraints alone determine the body velocity: the principal kinematic case.
    """

    system: Any
    shape_coordinates: tuple[str, ...]
    momentum_components: tuple[str, ...]
    _reduction: Any
    _free: tuple[int, ...]
    _units: Float[np.ndarray, "d"]

    def __repr__(self) -> str:
        shape, momenta = ", ".join(self.shape_coordinates), ", ".join(self.momentum_components) or "none"
        return f"<LocalConnection of {self.system.name!r}: shape {shape}; momenta {momenta}>"

    @property
    def group(self) -> AbstractMatrixGroup:
        """The group of the poses: SE(2) of a system in the plane."""
        return self._reduction.group

    @property
    def components(self) -> tuple[str, ...]:
        r"""Names of the components of $\xi$: of a planar system omega, v1, v2."""
        return components_of(self.group)

    def matrix(self, shape: Any) -> Float[np.ndarray, "... d m"]:
        r"""Return A(s), rows for the components of $\xi$; NaN where the constraints do not determine the body velocity.

        Args:
            shape: s, with free leading axes.

        Raises:
            ValueError: A wrong shape of the array, a number that is not finite.

        Example:
            >>> car = nh.local_connection(nh.examples.kinematic_car(wheel_radius=0.5, wheelbase=2.0).system)
            >>> car.matrix((0.0, np.pi / 4)).round(12)
            array([[-0.25,  0.  ],
                   [-0.5 ,  0.  ],
                   [ 0.  ,  0.  ]])
        """
        return _equations.connection(self.terms(self._points("matrix(shape=...)", shape)))

    def curvature(self, shape: Any) -> Float[np.ndarray, "... d m m"]:
        r"""Return the curvature of the connection.

        $$ F_{ij} = \partial_i A_j - \partial_j A_i - [A_i, A_j], \qquad
           g = \exp\Bigl(-\sum_{i<j}\iint F_{ij}\,ds_i\,ds_j + O(\varepsilon^3)\Bigr) $$

        is the displacement by a gait of size $\varepsilon$. It vanishes identically where only the ends of a change
        of shape count.

        Args:
            shape: s, with free leading axes.

        Returns:
            F with axes for the body velocity, i and j; NaN where A is.

        Raises:
            ValueError: A wrong shape of the array, a number that is not finite.

        Example:
            A car that steers and rolls, turns: $F_{\psi\varphi} = (\rho/\ell)\cos^{-2}\varphi$.

            >>> car = nh.local_connection(nh.examples.kinematic_car(wheel_radius=0.5, wheelbase=2.0).system)
            >>> print(car.curvature((0.0, np.pi / 4))[:, 0, 1].round(12))
            [0.5 0.  0. ]
        """
        return _equations.curvature(self.group, self.terms(self._points("curvature(shape=...)", shape)))

    def body_velocity(self, shape: Any, shape_velocity: Any, momentum: Any = None) -> Float[np.ndarray, "... d"]:
        r"""Return $\xi = -A(s)\,\dot s + \Gamma(s)\,p$.

        Args:
            shape: s, with free leading axes.
            shape_velocity: $\dot s$.
            momentum: p; zero by default.

        Raises:
            ValueError: A wrong shape of an array, a number that is not finite.

        Example:
            >>> board = nh.local_connection(nh.examples.snakeboard().system)
            >>> print(board.body_velocity((0.0, 0.3), (0.0, 0.0), momentum=(3.0,))[:2].round(3))
            [0.847 2.738]
        """
        return self._motion("body_velocity", shape, shape_velocity, momentum)[0]

    def momentum_rate(self, shape: Any, shape_velocity: Any, momentum: Any = None) -> Float[np.ndarray, "... k"]:
        r"""Return the right-hand side of the nonholonomic momentum equation, without forces.

        $$ p_a = \Bigl\langle\frac{\partial l}{\partial\xi}, e_a(s)\Bigr\rangle, \qquad
           \dot p_a = \Bigl\langle\frac{\partial l}{\partial\xi}, [\xi, e_a] + \dot e_a\Bigr\rangle , $$

        where $e_a(s)$ span the body velocities that the constraints admit while the shape rests. Of their components
        that `momentum_components` names, that of number a is one and the others vanish.

        Args:
            shape: s, with free leading axes.
            shape_velocity: $\dot s$.
            momentum: p; zero by default.

        Raises:
            ValueError: A wrong shape of an array, a number that is not finite.

        Example:
            Of the snakeboard, $\dot p = \tan\varphi\,\dot\varphi\,p + (J_0/r)\,\dot\varphi\,\dot\psi$:

            >>> board = nh.local_connection(nh.examples.snakeboard(rotor_inertia=0.5, half_length=1.0).system)
            >>> print(board.momentum_rate((0.0, 0.0), (2.0, 3.0)))
            [3.]
        """
        return self._motion("momentum_rate", shape, shape_velocity, momentum)[1]

    def _motion(self, name: str, shape: Any, shape_velocity: Any, momentum: Any) -> tuple[Array, Array]:
        s, ds = self._points(f"{name}(shape=...)", shape), self._points(f"{name}(shape_velocity=...)", shape_velocity)
        p = self.checked_momentum(name, momentum)
        leading = np.broadcast_shapes(s.shape[:-1], ds.shape[:-1], p.shape[:-1])
        s, ds, p = (np.broadcast_to(each, (*leading, each.shape[-1])) for each in (s, ds, p))
        return _equations.motion(self.group, self.terms(s), ds, p)

    def terms(self, shape: Float[np.ndarray, "... m"]) -> _equations.Terms:
        """Return the equations at shapes, for this room."""
        functions = door()
        W = functions.call(functions.constraint_terms, self._reduction, shape)
        M = functions.call(functions.inertia_terms, self._reduction, shape) if self._free else W
        return _equations.terms(self._free, self._units, *W, *M)

    def checked_momentum(self, owner: str, momentum: Any) -> Array:
        """Return momenta p, zero for None."""
        k = len(self.momentum_components)
        numbers = f"Pass {k} numbers: momenta of {', '.join(self.momentum_components)}."
        remedy = numbers if k else "Leave it out: the constraints alone determine the motion."
        p = np.zeros(k) if momentum is None else momentum
        return trailing(f"{owner}(momentum=...)", p, (k,), remedy, real=True)

    def _points(self, where: str, values: Any) -> Array:
        names = self.shape_coordinates
        return trailing(where, values, (len(names),), f"Pass one number each for {', '.join(names)}.", real=True)


def local_connection(system: Any, *, pose: tuple[str, str, str] = ("x", "y", "theta")) -> LocalConnection:
    r"""Return the local connection of a system: the body velocity that a change of shape causes.

    Of a `LagrangeDAlembert` system in the plane coordinates are position, heading and shape s. With the body velocity
    $\xi = (\omega, v_1, v_2)$, $\omega = \dot\theta$, $v_1 = \dot x\cos\theta + \dot y\sin\theta$,
    $v_2 = -\dot x\sin\theta + \dot y\cos\theta$, the constraints are $B(s)\,\xi + C(s)\,\dot s = 0$, at every pose.
    A `ShapedBody`, on any group, is given in this form. Where B is a square matrix,

    $$ \xi = -A(s)\,\dot s, \qquad A = B^{-1}C : $$

    the principal kinematic case. Otherwise k velocities $e_a(s)$ in the kernel of B are left, and their momenta
    $p_a = \langle\partial l/\partial\xi, e_a\rangle$ complete the equations, $\xi = -A(s)\dot s + \Gamma(s)p$. Without
    constraints A is the mechanical connection, and p the momentum in the body.

    Prescribed motions of the shape are left aside: the connection holds for every motion of it. So are forces, friction
    among them, which change p beside what `momentum_rate` says and nothing else. The gradients of holonomic constraints
    are rows of B and C. That constraints and,
    where there are momenta, Lagrangian do not depend on the pose is checked at 8 random shapes and poses.

    Reference: [bloch-krishnaprasad-marsden-murray-1996], [kelly-murray-1995]; signs are derived in the how-to "Gaits".

    Args:
        system: A `LagrangeDAlembert` system whose constraints and Lagrangian do not depend on time, or a `ShapedBody`.
        pose: Names of position and heading among its coordinates; a `ShapedBody` has its pose apart.

    Raises:
        ValueError: Another system; coordinates without such names, or without a shape; constraints or a Lagrangian
            that depend on the pose, or on time; constraints between shape variables alone; kinetic energy that is not
            quadratic.

    Example:
        >>> board = nh.local_connection(nh.examples.snakeboard().system)
        >>> board.shape_coordinates, board.momentum_components
        (('psi', 'phi'), ('v1',))
    """
    if hasattr(system, "shape_coordinates"):
        return _connection(door().Reduced(system), system, system.shape_coordinates)
    free = checked_system("local_connection", system)
    names = free.coordinates
    where, argument, remedy = "local_connection(system=...)", "local_connection(pose=...)", "Name x, y and the heading."
    axes = [choice(argument, name, names, remedy) for name in instance(argument, pose, tuple, "be three names", remedy)]
    if len(set(axes)) != 3 or len(axes) != 3:
        raise error(argument, "be three different names", shown(pose), remedy)
    shape = tuple(i for i, name in enumerate(names) if name not in pose)
    if not shape:
        raise error(where, "have a shape beside its pose", shown(names), "A rigid body has no connection.")
    reduction = door().Planar(free, tuple(map(names.index, pose)), shape)
    return _connection(reduction, system, tuple(names[i] for i in shape))


def _connection(reduction: Any, system: Any, shape: tuple[str, ...]) -> LocalConnection:
    """Return the connection of a system whose constraints and Lagrangian are checked at random shapes and poses."""
    where, rng, names = "local_connection(system=...)", np.random.default_rng(0), components_of(reduction.group)
    shapes, poses = rng.normal(0.0, 0.6, (_SAMPLES, len(shape))), rng.normal(0.0, 2.0, (_SAMPLES, 3))
    units = _units(reduction, shapes)
    free = _free_components(where, reduction, (shapes, poses), units)
    if free and system.lagrangian is None:
        got, remedy = f"{len(names) - len(free)} constraints", "Pass lagrangian=, or a constraint for each component."
        raise error(where, f"determine {len(names)} components of the body velocity", got, remedy)
    if free:
        _check_energy(where, reduction, shapes, poses, units * rng.normal(size=(_SAMPLES, len(units))))
    return LocalConnection(system, shape, tuple(names[i] for i in free), reduction, free, units[: len(names)])


def _units(reduction: Any, shapes: Array) -> Float[np.ndarray, "d+m"]:
    r"""Return units of $(\xi, \dot s)$ in which each has the same kinetic energy; without a Lagrangian 1."""
    if reduction.system.lagrangian is not None:
        sizes = np.diagonal(door().call(door().inertia_terms, reduction, shapes)[0], axis1=-2, axis2=-1)
        sizes = np.abs(sizes[np.isfinite(sizes).all(axis=1)]).max(axis=0, initial=0.0)
        return 1 / np.sqrt(np.where(sizes > 0, sizes, 1.0))
    return np.ones(reduction.group.dim + shapes.shape[1])


def checked_system(owner: str, system: Any) -> Any:
    """Return a system without parameters, forces and prescribed motions, refused where anything depends on time."""
    where = f"{owner}(system=...)"
    remedy = "Pass a `LagrangeDAlembert`, of a ready example its `.system`; on a group a `ShapedBody`."
    instance(where, system, AbstractCoordinateSystem, "be a system in coordinates", remedy)
    if not getattr(system, "coordinates", ()):
        raise error(where, "be a system in coordinates", "one on a group", remedy)
    free = system.plain
    if free.force is not None or free.prescribed:
        free = dataclasses.replace(free, force=None, prescribed=())
    if free.is_driven:
        raise error(where, "not depend on time", "moving constraints or functions of time", "Leave these out.")
    return free


def _free_components(where: str, reduction: Any, samples: tuple[Array, Array], units: Array) -> tuple[int, ...]:
    """Return the components of the body velocity that the constraints leave free, of those choices the best one."""
    shapes, poses = samples
    at_identity, elsewhere = (door().call(type(reduction).rows, reduction, g, shapes) for g in (np.zeros(3), poses))
    usable = np.isfinite(at_identity).all((1, 2)) & np.isfinite(elsewhere).all((1, 2))
    at_identity, elsewhere = (_equations.unit_rows(rows[usable] * units) for rows in (at_identity, elsewhere))
    d = reduction.group.dim
    least = np.linalg.svd(at_identity[..., :d], compute_uv=False).min(-1, initial=1.0)
    if not (least > _INDEPENDENT).any():
        got = "constraints that are dependent, infinite, or between shape variables alone"
        raise error(where, "have constraints that bind the body velocity", got, "Solve those of the shape first.")
    at_identity, elsewhere = at_identity[least > _INDEPENDENT], elsewhere[least > _INDEPENDENT]
    off = elsewhere - elsewhere @ np.linalg.pinv(at_identity) @ at_identity
    if np.abs(off).max(initial=0.0) > _SYMMETRIC:
        got = f"constraints that change by {np.abs(off).max():.2g} where it is moved and turned"
        raise error(where, "have constraints that are the same at every pose", got, "Check names and forms.")
    choices = itertools.combinations(range(d), d - at_identity.shape[1])
    return max(choices, key=lambda free: np.median(np.abs(np.linalg.det(np.delete(at_identity[..., :d], free, -1)))))


def _check_energy(where: str, reduction: Any, shapes: Array, poses: Array, u: Array) -> None:
    """Refuse a Lagrangian that depends on the pose, or that is not quadratic in the velocities."""
    functions, energy = door(), type(reduction).lagrangian
    M = functions.call(functions.inertia_terms, reduction, shapes)[0]
    for w in (0 * u, u):  # at rest a potential is seen beside itself
        here, there = (functions.call(energy, reduction, g, shapes, w) for g in (np.zeros(3), poses))
        if np.nanmax(np.abs(there - here)) > _SYMMETRIC * np.nanmax(np.abs(here)):
            got, remedy = "one that changes where it is moved and turned", "Leave potentials of the pose out."
            raise error(where, "have a Lagrangian that is the same at every pose", got, remedy)
        linear = np.einsum("...ab,...b->...a", M, w)
        gaps = np.abs(functions.call(functions.momenta, reduction, shapes, w) - linear)
        if np.any(np.nanmax(gaps, axis=0) > _SYMMETRIC * np.nanmax(np.abs(linear), axis=0)):
            raise error(where, "have a kinetic energy quadratic in velocities", "another one", "Leave other terms out.")


@functools.cache
def door(owner: str = "local_connection") -> Any:
    """Return the functions that JAX compiles, for a caller whom an error names where there is no JAX."""
    with needs("jax", owner):
        from nonholo.analysis.locomotion import _reduction
    return _reduction


_NAMES = "ShapedBody(shape_coordinates=...)"


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class ShapedBody:
    r"""A body on a matrix group G with a shape s, seen from itself: for `local_connection` and what follows from it.

    $$ l(s, \xi, \dot s), \qquad W(s)\begin{pmatrix}\xi\\\dot s\end{pmatrix} = 0, \qquad \dot g = g\,\xi . $$

    Nothing depends on the pose g. A falling cat, a satellite with rotors, a fish, a rover on a ball are of this kind.
    Systems in the plane that are given in coordinates need it not.

    Attributes:
        group: G.
        shape_coordinates: Names of the shape variables s.
        lagrangian: `lagrangian(shape, body_velocity, shape_velocity)` -> scalar, quadratic in the velocities, written
            with `jax.numpy`; None if the constraints determine the body velocity.
        constraint_forms: `constraint_forms(shape)` -> (c, dim + m), the rows W; None for none.
        name: For pictures and messages.

    Raises:
        ValueError: Something that is no group or no function, no shape, values of wrong shapes.

    Example:
        A satellite with two rotors, of inertia 0.5 about its first two axes: $A = (I + j)^{-1}j$ for each.

        >>> import jax.numpy as jnp
        >>> def lagrangian(s, xi, ds):
        ...     return (jnp.array([1.0, 1.5, 2.0]) @ xi**2 + 0.5 * ((xi[:2] + ds) ** 2).sum()) / 2
        >>> body = ShapedBody(nh.SO(3), ("a", "b"), lagrangian)
        >>> nh.local_connection(body).matrix((0.0, 0.0)).round(4)
        array([[0.3333, 0.    ],
               [0.    , 0.25  ],
               [0.    , 0.    ]])
    """

    group: Any
    shape_coordinates: tuple[str, ...]
    lagrangian: Callable[[Array, Array, Array], Array] | None = None
    constraint_forms: Callable[[Array], Array] | None = None
    name: str = "Body with a shape"

    def __post_init__(self) -> None:
        checked_group("ShapedBody(group=...)", self.group)
        names(_NAMES, instance(_NAMES, self.shape_coordinates, tuple, "be names", "Pass a tuple of strings."))
        text("ShapedBody(name=...)", self.name)
        if self.lagrangian is None and self.constraint_forms is None:
            remedy = "Pass lagrangian=, constraint_forms= or both."
            raise error("ShapedBody(...)", "have a Lagrangian or constraints", "neither", remedy)
        assign(self, **dict(door("ShapedBody").traced_functions(self)))

    def __repr__(self) -> str:
        return f"<ShapedBody {self.name!r} on {self.group}: shape {', '.join(self.shape_coordinates)}>"


_MOST = 8  # the longest bracket: their derivatives are tensors of that order
_RANK = 1e-9  # of singular values, relative to the largest


@result
class Accessibility:
    r"""How the brackets of admissible velocities grow at a configuration.

    Attributes:
        growth: The ranks of $D \subset D + [D, D] \subset \dots$, as far as they were computed.
        directions: An orthonormal basis of the last of them, in rows.
        is_accessible: Whether every direction is among them; under holonomic constraints every one along their surface.
    """

    growth: tuple[int, ...]
    directions: Float[np.ndarray, "r n"]
    is_accessible: bool


def accessibility(system: Any, configuration: Any, *, depth: int | None = None) -> Accessibility:
    r"""Return the directions to which brackets of admissible velocities lead from a configuration.

    $$ D_1 = D = \{v : A(q)\,v = 0\}, \qquad D_{i+1} = D_i + [D, D_i], \qquad
       \text{growth} = (\dim D_1, \dim D_2, \dots). $$

    If some $D_i$ is all of $\mathbb R^n$, motions along the constraint lead to every neighbor (Chow and Rashevskii). Of
    a kinematic system, whose shape moves as its owner likes, this is controllability. Otherwise it says that no
    part of the constraint is integrable; what can be reached with forces on the shape alone is another question. The
    gradients of holonomic constraints are rows of A.

    Derivatives of the constraints are by JAX; ranks count singular values above $10^{-9}$ of the largest, in units of
    coordinates in which velocities have the same kinetic energy at q.

    Args:
        system: A `LagrangeDAlembert` system whose constraints do not depend on time, or a `ShapedBody`, whose
            directions are $(\xi, \dot s)$. Prescribed motions and forces are left aside.
        configuration: q; of a `ShapedBody` the shape s, which is all that matters.
        depth: The longest brackets, at most 8; by default n - dim D + 1, enough wherever the ranks are constant nearby.

    Raises:
        ValueError: Another system, a wrong shape, constraints that are dependent or infinite at q, or holonomic ones
            that q does not satisfy.

    Example:
        >>> ready = nh.examples.kinematic_car()
        >>> nh.accessibility(ready.system, ready.configuration).growth
        (2, 3, 4, 5)
    """
    functions = door("accessibility")
    where = "accessibility(configuration=...)"
    rows, q, units, whole = _constraints(where, system, configuration)
    units = units * functions.reach(rows, q, units)
    forms = functions.forms_at(rows, q, units)
    rank = np.linalg.matrix_rank(forms) if np.isfinite(forms).all() else -1
    if rank < len(forms):
        remedy = "Choose another configuration, or drop constraints that follow from others."
        raise error(where, "have independent constraints", f"{forms.tolist()}", remedy)
    longest = rank + 1 if depth is None else count("accessibility(depth=...)", depth, "Pass a length of brackets.")
    if longest > _MOST:
        remedy = "Pass a smaller `depth=`: higher derivatives grow too large."
        raise error("accessibility(depth=...)", f"be at most {_MOST}", str(longest), remedy)
    growth, fields = [], np.zeros((len(q), 0))
    for longer in functions.brackets(rows, q, units, longest):
        fields = np.hstack([fields, longer])
        growth.append(int(np.linalg.matrix_rank(fields, rtol=_RANK)))
        if growth[-1] == whole:
            break
    span = np.linalg.svd(fields)[0][:, : growth[-1]]
    directions = np.linalg.qr(units[:, None] * span)[0].T
    return Accessibility(tuple(growth), directions, growth[-1] == whole)


def _constraints(where: str, system: Any, configuration: Any) -> tuple[Any, np.ndarray, np.ndarray, int]:
    """Return the function of the constraint forms with its system, checked place, units, and the reach of brackets."""
    from nonholo.lagrange_dalembert import checked_state, equations, forms_and_units

    has_shape, reduced = hasattr(system, "shape_coordinates"), door("accessibility").Reduced
    own: Any = reduced(system) if has_shape else checked_system("accessibility", system)
    names = system.shape_coordinates if has_shape else own.coordinates
    q = array(where, configuration, (len(names),), f"Pass {len(names)} coordinates.")
    if has_shape:
        units, q = _units(own, q[None]), np.append(np.zeros(system.group.dim), q)
        return (reduced.constraint_forms, own), q, units, len(q)
    if own.holonomic is not None:
        checked_state(own, q, {"body_velocity": np.zeros(len(q))}, 0.0, "accessibility")
    return (equations.forms, own), q, forms_and_units(own, q)[1], len(q) - (own.constraints - own.velocity_constraints)
