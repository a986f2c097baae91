r"""All values of the multivalued discrete map, complex ones included: as matrices, the principal one, their regions.

The equations are in `_equations`, their roots in `_roots`; which value a run takes is not decided here. Regions are
parts of the displacements of a top in three dimensions, between the critical points of its energy; the energy landscape
is shared with `analysis`, which names all of them. Reference: [fedorov-zenkov-2004], section 3 and, for section 6,
"Invariant curves", docs/theory/critical-energies.md; docs/theory/branches.md.
"""

import dataclasses
from typing import Any, cast

import numpy as np
import scipy  # its parts load on first use

from nonholo.base.checks import array, error, flags, natural, needs, shape_of
from nonholo.base.html import table
from nonholo.base.results import Outcome
from nonholo.base.types import Array, Bool, Float, Inexact, Int
from nonholo.discrete._discretization import Discretization, as_discretization
from nonholo.discrete._scheme import legendre
from nonholo.discrete.branching._equations import Equations, has_frame
from nonholo.discrete.branching._forces import Node, node_of
from nonholo.discrete.branching._roots import Root, place, roots_of
from nonholo.discrete.branching._sections import AnyFrame, frame_for
from nonholo.systems import AbstractLLSystem, NormalForm, one_start


@dataclasses.dataclass(frozen=True, eq=False)
class Landscape:
    r"""The energy $(u\cdot Bu)(\varrho - \kappa\varrho^2)$ over the displacements $z = \sqrt\varrho\,u$ of a top.

    Attributes:
        axes: Columns are the unit vectors along and across c, any if c = 0.
        inertia: B seen from these axes.
        sharpness: $|c|^2/\det B$; $\kappa = 1 - (c\cdot u^\perp)^2/\det B$ lies between one minus this, and one.
        inverses: $1/\mu$ of $Bu = \mu\,(\mathrm{Id} - c^\perp c^{\perp T}/\det B)\,u$, of the center and of the saddle,
            whose energies are $\mu/4$.
        vectors: Their u in these axes, as columns, not of length one.
    """

    axes: Float[np.ndarray, "2 2"]
    inertia: Float[np.ndarray, "2 2"]
    sharpness: float
    inverses: Float[np.ndarray, "2"]
    vectors: Float[np.ndarray, "2 2"]

    @property
    def is_regular(self) -> bool:
        r"""Whether $\det B > 2|c|^2$: below the saddle's energy the component around the identity is separate."""
        return bool(2 * self.sharpness < 1)


def landscape(form: NormalForm) -> Landscape:
    """Return the energy landscape of a top with n = 3."""
    c, is_balanced = np.asarray(form.coupling), not form.is_coupled
    along = np.array([1.0, 0.0]) if is_balanced else c / np.hypot(*c)
    axes = np.stack([along, [-along[1], along[0]]], axis=1)
    inertia = axes.T @ form.stiffness_matrix @ axes
    sharpness = 0.0 if is_balanced else float(c @ c / np.linalg.det(inertia))
    inverses, vectors = scipy.linalg.eigh(np.diag([1.0, 1.0 - sharpness]), inertia)
    return Landscape(axes, inertia, sharpness, inverses, vectors)


def regions(discrete: Discretization, displacement: Inexact[np.ndarray, "B N N"]) -> np.ndarray:
    r"""Return the region of each real displacement: "inner", "outer", "between", or "" where there is none.

    With the critical energies $h^* < h^{**}$ of `critical_energies`, in the regular regime: "inner" is
    $E < h^*$, $\varrho < 1/(2\kappa)$, around the identity; "outer" lies beyond the ridge $\varrho = 1/(2\kappa)$;
    "between" is $h^* \le E < h^{**}$, where the two are connected. Other systems and other regimes have no regions.
    """
    land = regular_landscape(discrete)
    if land is None:
        return np.full(len(displacement), "", dtype="<U7")
    frame = discrete.system.form_frame
    in_axes = frame.T @ np.real(displacement) @ frame
    square = land.axes.T @ (np.eye(2) - in_axes[:, :2, :2]) @ land.axes / 2  # z z^T
    height = np.einsum("bij,ij->b", square, land.inertia)
    ascent = np.einsum("bii->b", square) - land.sharpness * square[:, 1, 1]  # kappa rho, one half on the ridge
    energy, (center, saddle) = height * (1 - ascent), 1 / (4 * land.inverses)
    below = energy < saddle
    return np.select([below & (ascent < 0.5), below, energy < center], ["inner", "outer", "between"], default="")


def regular_landscape(discrete: Discretization) -> Landscape | None:
    r"""Return the landscape that has regions: of a top, n = 3, with $\det B > 2|c|^2$ that conserves its energy."""
    form = discrete.system.normal_form
    if form is None or form.is_sleigh or not form.is_planar or not discrete.conserves_energy:
        return None
    land = landscape(form)
    return land if land.is_regular else None


SAME = 1e-6  # relative distance of a computed displacement or momentum from the branch that it is
_ON_VARIETY = 1e-9  # relative distance from the displacement variety


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class Branches:
    """Displacements whose momenta have the same components along the constraint subspace.

    Real ones come first, by step angle.

    Attributes:
        displacement: W, complex matrices.
        momentum: P(W), physical.
        is_real: Which displacements are real.
        multiplicity: Two at a fold.
        fold_distance: See `fold_distance`.
        energy: Reduced constrained energy, the same for all.
        region: "inner", "outer" or "between", of real displacements of a top with n = 3 and det B > 2|c|^2; otherwise
            "", also from the energy h** on. See docs/theory/branches.md.
        principal: Index of the principal one; None if the principal branch does not reach this momentum.
        missing: By how many they are fewer than the most there can be, multiplicities counted: those at infinity, not
            isolated, or lost on a path, as over momenta so large that doubles do not hold all displacements.
        certified: Whether `certify=True` was passed and all results are proved: that these are all isolated
            displacements, each once, which of them are real, their multiplicities.
        radius: Bounds of the distance of any entry of each displacement from the exact one; None if not certified.
        uncertified: Why there is no certificate in spite of `certify=True`; otherwise "".
    """

    displacement: Array
    momentum: Array
    is_real: Bool[np.ndarray, "B"]
    multiplicity: Int[np.ndarray, "B"]
    fold_distance: Float[np.ndarray, "B"]
    energy: float
    region: np.ndarray
    principal: int | None
    missing: int
    certified: bool = False
    radius: Float[np.ndarray, "B"] | None = None
    uncertified: str = ""

    def __len__(self) -> int:
        return len(self.is_real)

    @property
    def real_count(self) -> int:
        """The number of real displacements, those at a fold twice."""
        return int(self.multiplicity[self.is_real].sum())

    def __repr__(self) -> str:
        real = np.count_nonzero(self.is_real)
        principal = "none is principal" if self.principal is None else f"number {self.principal} is principal"
        mark = (f", {self.missing} missing" if self.missing else "") + (", certified" if self.certified else "")
        return f"<Branches: {len(self)} values, {real} real, {principal}{mark}, energy {self.energy:.6g}>"

    def _repr_html_(self) -> str:
        head = ("", "real", "multiplicity", "to the fold", "momentum")
        rows = []
        for k, momentum in enumerate(self.momentum):
            components = momentum.real if self.is_real[k] else momentum
            text = np.array2string(components, precision=6, threshold=12, suppress_small=True)
            number = f"{k}, principal" if k == self.principal else k
            is_real = "yes" if self.is_real[k] else "no"
            rows.append((number, is_real, self.multiplicity[k], f"{self.fold_distance[k]:.3g}", text))
        return table(repr(self), rows, head)

    def to_pandas(self) -> Any:
        """Return a `pandas.DataFrame` with a row for each value, its complex momentum by component."""
        import pandas

        columns = {name: getattr(self, name) for name in ("is_real", "multiplicity", "fold_distance", "region")}
        return pandas.DataFrame(columns | {f"momentum_{i}": row for i, row in enumerate(np.transpose(self.momentum))})


def values_over(frame: AnyFrame, r: Inexact[np.ndarray, "k"]) -> Branches:
    """Return all values over a restricted momentum in the user's frame."""
    canonical = frame.discrete.system.to_canonical(r)
    return branches_of(frame, canonical, roots_over(frame, frame.equations(frame.discrete.time_step * canonical)))


def values_at(node: Node, r: Inexact[np.ndarray, "k"]) -> Branches:
    """Return all values of a step under forces over a restricted momentum in the user's frame."""
    canonical = node.frame.discrete.system.to_canonical(r)
    roots = roots_over(node.frame, node.equations(canonical))
    values = branches_of(node.frame, canonical, roots, node.principal(canonical))
    return dataclasses.replace(values, region=np.full(len(values), ""))


Roots = tuple[Equations, list[Root], Inexact[np.ndarray, "B N N"]]
"""The equations of a restricted momentum, their roots, and the displacements minus the identity over them."""


def roots_over(frame: AnyFrame, equations: Equations) -> Roots:
    """Return the roots of the equations of a restricted momentum, real or complex."""
    system, zeros = frame.discrete.system, roots_of(equations)
    increments = [system.from_canonical_frame(frame.increment(root.point.astype(complex))) for root in zeros]
    return equations, zeros, np.array(increments).reshape(-1, *system.group.identity.shape)


def branches_of(frame: AnyFrame, canonical: Inexact[np.ndarray, "k"], roots: Roots, principal: Any = None) -> Branches:
    """Return what is known of the displacements over a canonical momentum; the principal one may be known."""
    discrete, (equations, zeros, X) = frame.discrete, roots
    system = cast(AbstractLLSystem, discrete.system)
    is_real = np.array([root.is_real for root in zeros], dtype=bool)
    multiplicity = np.array([root.multiplicity for root in zeros], dtype=np.int64)
    code, increment = principal or principal_increment(discrete, canonical)
    index = None
    if code == 0 and len(zeros):  # else all values are too far away
        own = system.from_canonical_frame(increment)
        distances = np.where(is_real, np.linalg.norm((X - own) * frame.stretch, axis=(1, 2)), np.inf)
        is_near = distances.min() <= SAME * max(1.0, float(np.linalg.norm(own * frame.stretch)))
        index = int(np.argmin(distances)) if is_near else None
    return Branches(
        displacement=X + system.group.identity,
        momentum=legendre(discrete, X, "left"),
        is_real=is_real,
        multiplicity=multiplicity,
        fold_distance=equations.regularity(equations.points([root.point for root in zeros])),
        energy=float(system.canonical.constrained_energy(canonical)),
        region=np.where(is_real, regions(discrete, X + system.group.identity), ""),
        principal=index,
        missing=max(0, equations.most - int(multiplicity.sum())),
    )


def momentum_sizes(frame: AnyFrame, momentum: Inexact[Array, "... dim"]) -> Float[Array, "..."]:
    """Return the norms of full momenta in the body's unit of length, in which those of turns and slides compare."""
    group = frame.discrete.system.group
    basis = group.hat(np.eye(group.dim))
    sizes = np.linalg.norm(basis * frame.stretch, axis=(1, 2)) / np.linalg.norm(basis, axis=(1, 2))
    return np.linalg.norm(momentum / sizes, axis=-1)


def checked_point(where: str, frame: AnyFrame, displacement: Any) -> tuple[Float[np.ndarray, "N N"], np.ndarray]:
    """Return a real displacement and the point over it, refused with its distance from the variety."""
    system = frame.discrete.system
    W = array(where, displacement, system.group.identity.shape, f"Pass an element of {system.group} as a matrix.")
    canonical = system.to_canonical_frame(W)
    x = frame.point(canonical)
    distance = float(np.linalg.norm((frame.increment(x) + np.eye(len(W)) - canonical) * frame.stretch))
    if not distance <= _ON_VARIETY * np.linalg.norm(canonical * frame.stretch):
        remedy = "Build it as `group.exp(x)` with x admissible."
        raise error(where, "lie on the displacement variety", f"a matrix at distance {distance:.3g}", remedy)
    return W, x


def principal_increment(discrete: Discretization, canonical: Float[np.ndarray, "k"]) -> tuple[Outcome, Array]:
    """Return the outcome and the verified principal displacement, canonical, minus the identity."""
    outcome, chart = discrete.route.first_root(canonical)
    return outcome, discrete.variety.increment(chart) if outcome == Outcome.successful else None


def certified_over(owner: str, frame: AnyFrame, r: Float[np.ndarray, "k"]) -> Branches:
    """Return all values over a restricted momentum, certified where that can be decided."""
    discrete, canonical = frame.discrete, frame.discrete.system.to_canonical(r)
    balls: Any = _FOLLOWED
    if has_frame(discrete):
        with needs("certify", f"{owner}(certify=...)"):
            from nonholo.discrete.certificate import enclosures
        balls = enclosures(discrete, canonical)
    if isinstance(balls, str):
        return dataclasses.replace(values_over(frame, r), uncertified=balls)
    (increment, radius, *facts), system = balls, discrete.system
    zeros = []
    for W, m, real in zip(system.to_canonical_frame(increment + system.group.identity), *facts, strict=True):
        x = frame.point(W.real if real else W)
        zeros.append(Root(x if x[0].real >= 0 else -x, int(m), bool(real)))
    order = sorted(range(len(zeros)), key=lambda i: place(zeros[i]))
    roots = frame.equations(discrete.time_step * canonical), [zeros[i] for i in order], increment[order]
    return dataclasses.replace(branches_of(frame, canonical, roots), certified=True, radius=radius[order])


_FOLLOWED = "they are followed from those of a general momentum; that these are all is observed"


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

    Values of any other constraint are linear sections of S, which are followed from a general one. Its points are all
    of them by a numerical test, so that these are all is observed too. The first call of a subspace takes seconds.

    Reference: [fedorov-zenkov-2004], section 3, item 3; docs/theory/branches.md.

    Args:
        discrete: A discretized system with difference "matrix": a top or a sleigh, or any constraint of rank up to 4
            that is fixed in the body, on a group of matrices of up to 5 rows, with constraint "skew".
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
        RuntimeError: Loops did not find all points of a general section.

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
        return values_at(node, _restricted(f"{where}(restricted_momentum=...)", discrete, restricted_momentum))
    frame = frame_for(where, discrete)
    flags(where, certify=certify)
    r = _restricted(f"{where}(restricted_momentum=...)", discrete, restricted_momentum)
    return certified_over(where, frame, r) if certify else values_over(frame, r)


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
    frame = frame_for("branches", discrete) if node is None else node.frame
    flags("branches", certify=certify)
    one_start("branches", momentum=momentum, displacement=displacement)
    where = "branches(momentum=...)"
    if displacement is not None:
        W, _ = checked_point("branches(displacement=...)", frame, displacement)
        X = W - discrete.system.group.identity
    elif node is None and shape_of(momentum) != (discrete.system.rank,):
        X = _inverse(where, frame, momentum)
    else:
        r = _restricted(where, discrete, momentum)
        values = values_over(frame, r) if node is None else values_at(node, r)
        if values.principal is None:
            remedy = "Pass a full momentum or the displacement, or take a smaller time_step."
            raise error(where, "have a principal displacement", "components that it does not reach", remedy)
        X = values.displacement[values.principal].real - discrete.system.group.identity
    if node is not None:
        return values_at(*node.following(X))
    r = discrete.system.restrict(legendre(discrete, X, "right"))
    return certified_over("branches", frame, r) if certify else values_over(frame, r)


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
    frame = frame_for(where, discrete)
    return _inverse(f"{where}(momentum=...)", frame, momentum) + discrete.system.group.identity


def fold_distance(discrete: Discretization, displacement: Any) -> float:
    r"""Return how regular the restricted Legendre map is at a displacement: 1 at the identity, 0 at a fold.

    The least singular value of $(\mathbb{I}|_{\mathfrak{d}})^{-1}\,d(hP|_{\mathfrak{d}})$ along the displacement
    variety, whose points are written $\pm(z_0, z)$ on the sphere $z_0^2 + |z|^2 = 1$, of a sleigh with a length too;
    all in the body's units of inertia and length. It depends on no unit and not on the time step. Points of other
    varieties move by $W^{-1}dW$, which on SO(n) is the same.

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
    frame = frame_for("fold_distance", discrete)
    _, x = checked_point("fold_distance(displacement=...)", frame, displacement)
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


def _restricted(where: str, discrete: Discretization, momentum: Any) -> Float[np.ndarray, "k"]:
    k = len(discrete.system.constraint_subspace)
    return array(where, momentum, (k,), f"Pass the {k} components along the constraint subspace.")


def _inverse(where: str, frame: AnyFrame, momentum: Any) -> Float[np.ndarray, "N N"]:
    system = frame.discrete.system
    p = array(where, momentum, (system.group.dim,), "Pass all components of a body momentum.")
    values = values_over(frame, system.restrict(p))
    distances = np.where(values.is_real, momentum_sizes(frame, values.momentum - p), np.inf)
    rounding = _ROUNDING * momentum_sizes(frame, values.momentum).max(initial=0.0)  # matters at rest
    near = np.flatnonzero(distances <= SAME * momentum_sizes(frame, p) + rounding)
    if len(near) == 0:
        away = np.linalg.norm(values.momentum - p, axis=1)[values.is_real]
        got = f"distance {away.min():.3g}" if len(away) else "components that no displacement has"
        raise error(where, "lie on the momentum locus", got, "Make it with `discrete_legendre`.")
    if len(near) > 1 and values.principal not in near:
        got = f"a momentum that {len(near)} of them have"
        raise error(where, "determine the displacement", got, "Use `displacements_over` and choose.")
    return values.displacement[near[0] if len(near) == 1 else values.principal].real - system.group.identity
