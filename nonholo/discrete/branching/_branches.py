r"""All values of the multivalued discrete map, complex ones included, and what tells them apart.

Reference: [fedorov-zenkov-2004], section 3; docs/theory/branches.md. The equations are in `_equations`, their
roots in `_roots`; which value a run takes is not decided here.
"""

import dataclasses
from collections.abc import Callable
from typing import Any

import numpy as np

from nonholo.base.checks import array, error, flags, natural, needs, shape_of
from nonholo.base.types import Array, Float
from nonholo.discrete._discretization import Discretization, as_discretization
from nonholo.discrete._scheme import legendre
from nonholo.discrete.branching._equations import Frame, frame_of
from nonholo.discrete.branching._forces import Node, node_of
from nonholo.discrete.branching._roots import Root, place
from nonholo.discrete.branching._values import SAME, Branches, Roots, branches_of, point_over, values_at, values_over
from nonholo.groups import AbstractMatrixGroup


def certified_over(owner: str, discrete: Discretization, frame: Frame, r: Float[np.ndarray, "k"]) -> Branches:
    """Return all values over a restricted momentum, certified where that can be decided."""
    canonical = discrete.system.to_canonical(r)
    balls = _enclosures(owner)(discrete, canonical)
    if isinstance(balls, str):
        return dataclasses.replace(values_over(discrete, frame, r), uncertified=balls)
    system, facts = discrete.system, zip(balls.multiplicity, balls.is_real, strict=True)
    matrices = system.group.inverse(system.frame) @ (balls.increment + system.group.identity) @ system.frame
    points = [frame.point(W.real if real else W) for W, real in zip(matrices, balls.is_real, strict=True)]
    zeros = [Root(x if x[0].real >= 0 else -x, int(m), bool(real)) for x, (m, real) in zip(points, facts, strict=True)]
    order = sorted(range(len(zeros)), key=lambda i: place(zeros[i]))
    roots = Roots(frame.equations(discrete.time_step * canonical), [zeros[i] for i in order], balls.increment[order])
    values = branches_of(discrete, canonical, roots)
    return dataclasses.replace(values, certified=True, radius=balls.radius[order])


def _enclosures(owner: str) -> Callable[..., Any]:
    """Import the certificate, or name the extra that it needs."""
    with needs("certify", f"{owner}(certify=...)"):
        from nonholo.discrete.certificate import enclosures
    return enclosures


_ROUNDING = 1e-13


def displacements_over(
    discrete: Discretization,
    restricted_momentum: Any,
    certify: bool = False,
    *,
    configuration: Any = None,
    step: int = 0,
) -> Branches:
    r"""Find every displacement whose discrete momentum has given components along the constraint subspace.

    Solves, on the displacement variety $S$, for real and complex matrices,

    $$ \langle P(W), e_i\rangle = r_i, \qquad i = 1, \dots, k, \qquad W \in S. $$

    There are 3 solutions for a Chaplygin sleigh, 2(n-1) for a Suslov top on SO(n) and 2n-1 for a sleigh on SE(n),
    counted with multiplicity. Fewer if some are at infinity (a balanced body: 2) or not isolated. Matrices of angle
    $\pi$ that satisfy $(W - W^{-1})/2 \in \mathfrak{d}$ without lying on the variety are no solutions.

    Under forces of the scheme "energy" it solves $\langle P(W) - \tfrac h2f(g, W), e_i\rangle = r_i$, for weights and
    other `Linear` potentials, `Friction` and tables. Under a weight a top with n = 3 has 7 solutions, sleighs with n =
    2, 3 have 4 and 8, and T + U after the step is the same for all. Beyond these n roots of a generic problem are
    followed: that they are all is observed, not proved.

    Reference: [fedorov-zenkov-2004], section 3, item 3; docs/theory/branches.md.

    Args:
        discrete: A discretized SuslovTop, ChaplyginSleigh or MultidimensionalSleigh with difference "matrix".
        restricted_momentum: r, in physical units, along the rows of `constraint_subspace`: of a `SuslovTop` with n = 3
            about e3, whose rows are (0, 1, 0) and (-1, 0, 0), r = (P_2, -P_1).
        certify: Also prove that these are all of them, with exact multiplicities and enclosures; needs the extra
            `certify` (python-flint). The statement is about the polynomial equations with the doubles of the canonical
            body (`system.canonical`), of the time step and of the canonical r as exact numbers. Where it is not
            decided, `certified` is False and `uncertified` has the reason. Of free motions only.
        configuration: g at the beginning of the step, by default the identity; only forces depend on it.
        step: Number of the step, whose row of a table of forces acts.

    Raises:
        ValueError: Another system, difference or force, a wrong shape, a value that is not finite, `certify=True`
            without python-flint or under forces.

    Example:
        A top has four values, here two of them complex:

        >>> top = nh.discretize(nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]]), 0.5)
        >>> values = displacements_over(top, [0.1, -0.05])
        >>> values.is_real, values.principal
        (array([ True,  True, False, False]), 0)
        >>> values.momentum[0, :2].real.round(12)  # (P_1, P_2)
        array([0.05, 0.1 ])
        >>> certified = displacements_over(top, [0.1, -0.05], certify=True)
        >>> certified.is_real, bool(certified.radius.max() < 1e-14)
        (array([ True,  True, False, False]), True)

        The same top under a weight:

        >>> heavy = nh.Forced(top.system, nh.Gravity([0.2, 0.1, -1.0], [0.1, 0.2, 0.3]))
        >>> displacements_over(nh.discretize(heavy, 0.5), [0.1, -0.05])
        <Branches: 7 values, 3 real, number 0 is principal, energy 0.00308891>
    """
    where = "displacements_over"
    if (node := _node(where, discrete, certify, configuration, step)) is not None:
        return values_at(node, _restricted(f"{where}(restricted_momentum=...)", node.free, restricted_momentum))
    frame = _frame_for(where, discrete)
    flags(where, certify=certify)
    r = _restricted(f"{where}(restricted_momentum=...)", discrete, restricted_momentum)
    return certified_over(where, discrete, frame, r) if certify else values_over(discrete, frame, r)


def branches(
    discrete: Discretization,
    *,
    momentum: Any = None,
    displacement: Any = None,
    certify: bool = False,
    configuration: Any = None,
    step: int = 0,
) -> Branches:
    r"""Find every value of the discrete map: all $W'$ that may follow a displacement $W$.

    $$ P(W')|_{\mathfrak{d}} = (\mathrm{Ad}^*_W P(W))|_{\mathfrak{d}}, \qquad W' \in S. $$

    Under forces, as in `displacements_over`, half the impulses of both steps act between W and W'.

    Reference: [fedorov-zenkov-2004], equation (disc.momentum.eqn); docs/theory/branches.md.

    Args:
        discrete: As in `displacements_over`.
        momentum: A full momentum on the locus, whose W is `inverse_discrete_legendre`, or components along the
            constraint subspace, whose W is the principal displacement; under forces these.
        displacement: W itself, real and on the displacement variety.
        certify: As in `displacements_over`, for the restricted momentum that arrives with W, as it is computed here.
        configuration: g before W, as in `displacements_over`.
        step: Number of the step of W.

    Raises:
        ValueError: As `displacements_over` and `inverse_discrete_legendre`; none or both of momentum and displacement;
            components that no principal displacement has; a displacement off the variety.

    Example:
        >>> sleigh = nh.discretize(nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.5), time_step=0.1)
        >>> values = branches(sleigh, momentum=[1.0, 0.2])
        >>> after = nh.step(sleigh, np.array([1.0, 0.2]))
        >>> bool(np.allclose(values.momentum[values.principal], after.momentum))
        True
    """
    node = _node("branches", discrete, certify, configuration, step)
    frame = _frame_for("branches", discrete) if node is None else node.frame
    flags("branches", certify=certify)
    if (momentum is None) == (displacement is None):
        got = "none" if momentum is None else "both"
        raise error("branches(...)", "be given momentum or displacement", got, "Choose one.")
    group, where = discrete.system.group, "branches(displacement=...)"
    if displacement is not None:
        X = array(where, displacement, group.identity.shape, f"Pass an element of {group}.") - group.identity
        point_over(where, discrete if node is None else node.free, frame, X + group.identity)
    elif node is not None:
        where = "branches(momentum=...)"
        X = _increment(where, discrete, values_at(node, _restricted(where, discrete, momentum)))
    else:
        X = _before("branches(momentum=...)", discrete, frame, momentum)
    if node is not None:
        return values_at(*node.following(X))
    r = discrete.system.restrict(legendre(discrete, X, "right"))
    return certified_over("branches", discrete, frame, r) if certify else values_over(discrete, frame, r)


def inverse_discrete_legendre(discrete: Discretization, momentum: Any) -> Float[Array, "N N"]:
    r"""Return the displacement that a full momentum on the momentum locus belongs to: $P(W) = p$, $W \in S$.

    Where the locus meets itself several displacements have one momentum: the principal one is returned.

    Args:
        discrete: As in `displacements_over`.
        momentum: p, all components.

    Raises:
        ValueError: A momentum off the locus, named with its distance from the points of the locus that have the same
            components along the constraint subspace; one of several displacements none of which is principal; as
            `displacements_over`.

    Example:
        >>> sleigh = nh.discretize(nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.5), time_step=0.1)
        >>> W = nh.SE(2).exp(np.array([2.0, 0.3, 0.0]))
        >>> bool(np.allclose(inverse_discrete_legendre(sleigh, nh.discrete_legendre(sleigh, W)), W))
        True
    """
    where = "inverse_discrete_legendre"
    frame = _frame_for(where, discrete)
    return _inverse(f"{where}(momentum=...)", discrete, frame, momentum) + discrete.system.group.identity


def fold_distance(discrete: Discretization, displacement: Any) -> float:
    r"""Return how regular the restricted Legendre map is at a displacement: 1 at the identity, 0 at a fold.

    The least singular value of $(\mathbb{I}|_{\mathfrak{d}})^{-1}\,d(hP|_{\mathfrak{d}})$ along the displacement
    variety, whose points are written $\pm(z_0, z)$ on the sphere $z_0^2 + |z|^2 = 1$, of a sleigh with a length too;
    all in the body's units of inertia and length. It depends on no unit and not on the time step.

    Args:
        discrete: As in `displacements_over`.
        displacement: W, real and on the displacement variety.

    Raises:
        ValueError: A displacement off the variety; as `displacements_over`.

    Example:
        >>> sleigh = nh.discretize(nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.0), time_step=0.1)
        >>> quarter = nh.SE(2).exp(np.array([np.pi / 2, 0.0, 0.0]))  # a = 0: the momentum J sin(angle)/h folds here
        >>> fold_distance(sleigh, np.eye(3)), round(fold_distance(sleigh, quarter), 12)
        (1.0, 0.0)
    """
    where = "fold_distance(displacement=...)"
    frame = _frame_for("fold_distance", discrete)
    group: AbstractMatrixGroup = discrete.system.group
    W = array(where, displacement, group.identity.shape, f"Pass an element of {group} as a matrix.")
    x = point_over(where, discrete, frame, W)
    return float(frame.equations(np.zeros(len(discrete.system.constraint_subspace))).regularity(x))


def _node(owner: str, discrete: Any, certify: bool, configuration: Any, step: Any) -> Node | None:
    """Return where a step under forces begins; None of a free motion."""
    discrete = as_discretization(f"{owner}(discrete=...)", discrete, forced=True)
    number = natural(f"{owner}(step=...)", step, "Pass the number of a step.")
    if discrete.forces is None:
        return None
    if certify:
        raise error(f"{owner}(certify=...)", "be left out under forces", "forces", "Leave it out.")
    return node_of(owner, discrete, configuration, number)


def _frame_for(owner: str, discrete: Discretization) -> Frame:
    return frame_of(f"{owner}(discrete=...)", as_discretization(f"{owner}(discrete=...)", discrete))


def _restricted(where: str, discrete: Discretization, momentum: Any) -> Float[np.ndarray, "k"]:
    k = len(discrete.system.constraint_subspace)
    return array(where, momentum, (k,), f"Pass the {k} components along the constraint subspace.")


def _before(where: str, discrete: Discretization, frame: Frame, momentum: Any) -> Float[np.ndarray, "N N"]:
    """Return the displacement minus the identity that a full or restricted momentum belongs to."""
    if shape_of(momentum) != (len(discrete.system.constraint_subspace),):
        return _inverse(where, discrete, frame, momentum)
    return _increment(where, discrete, values_over(discrete, frame, _restricted(where, discrete, momentum)))


def _increment(where: str, discrete: Discretization, values: Branches) -> Float[np.ndarray, "N N"]:
    """Return the principal displacement minus the identity."""
    if values.principal is None:
        remedy = "Pass a full momentum or the displacement, or take a smaller time_step."
        raise error(where, "have a principal displacement", "components that it does not reach", remedy)
    return values.displacement[values.principal].real - discrete.system.group.identity


def _inverse(where: str, discrete: Discretization, frame: Frame, momentum: Any) -> Float[np.ndarray, "N N"]:
    system = discrete.system
    p = array(where, momentum, (system.group.dim,), "Pass all components of a body momentum.")
    values = values_over(discrete, frame, system.restrict(p))
    distances = np.where(values.is_real, np.linalg.norm(values.momentum - p, axis=1), np.inf)
    rounding = _ROUNDING * np.abs(values.momentum).max(initial=0.0)  # matters at rest
    near = np.flatnonzero(distances <= SAME * np.linalg.norm(p) + rounding)
    if len(near) == 0:
        got = f"distance {distances.min():.3g}" if values.is_real.any() else "components that no displacement has"
        raise error(where, "lie on the momentum locus", got, "Make it with `discrete_legendre`.")
    if len(near) > 1 and values.principal not in near:
        got = f"a momentum that {len(near)} of them have"
        raise error(where, "determine the displacement", got, "Use `displacements_over` and choose.")
    best = near[0] if len(near) == 1 else values.principal
    return values.displacement[best].real - system.group.identity
