r"""The values over one restricted momentum as matrices, which of them is the principal one, and their regions.

The roots come from `_roots`; the questions that users ask are in `_branches`. Regions are those of the displacements of
a top in three dimensions, between the critical points of its energy; the energy landscape is shared with `analysis`,
which names all of these. Reference: [fedorov-zenkov-2004], section 6, "Invariant curves", as corrected in
docs/theory/critical-energies.md.
"""

import dataclasses
from typing import NamedTuple, cast

import numpy as np
import scipy  # its parts load on first use

from nonholo.base.checks import error
from nonholo.base.html import table
from nonholo.base.results import Outcome
from nonholo.base.types import Array, Bool, Float, Inexact, Int
from nonholo.discrete._discretization import Discretization
from nonholo.discrete._scheme import legendre
from nonholo.discrete.branching._equations import Equations, Frame
from nonholo.discrete.branching._forces import Node
from nonholo.discrete.branching._roots import Root, roots_of
from nonholo.systems import AbstractLLSystem, NormalForm


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


def is_regular(discrete: Discretization) -> bool:
    r"""Return whether a discretization has regions: a top, n = 3, with $\det B > 2|c|^2$ that conserves its energy."""
    return _regular_landscape(discrete) is not None


def regions(discrete: Discretization, displacement: Inexact[np.ndarray, "B N N"]) -> np.ndarray:
    r"""Return the region of each real displacement: "inner", "outer", "between", or "" where there is none.

    With the critical energies $h^* < h^{**}$ of `critical_energies`, in the regular regime: "inner" is
    $E < h^*$, $\varrho < 1/(2\kappa)$, around the identity; "outer" lies beyond the ridge $\varrho = 1/(2\kappa)$;
    "between" is $h^* \le E < h^{**}$, where the two are connected. Other systems and other regimes have no regions.
    """
    land = _regular_landscape(discrete)
    if land is None:
        return np.full(len(displacement), "", dtype="<U7")
    frame = discrete.system.form_frame
    in_axes = frame.T @ np.real(displacement) @ frame
    square = land.axes.T @ (np.eye(2) - in_axes[:, :2, :2]) @ land.axes / 2  # z z^T
    height = np.einsum("bij,ij->b", square, land.inertia)
    ascent = np.einsum("bii->b", square) - land.sharpness * square[:, 1, 1]  # kappa rho, one half on the ridge
    energy, (center, saddle) = height * (1 - ascent), 1 / (4 * land.inverses)
    kinds = ["inner", "outer", "between"]
    below = energy < saddle
    return np.select([below & (ascent < 0.5), below, energy < center], kinds, default="")


def _regular_landscape(discrete: Discretization) -> Landscape | None:
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
    certified: bool = False
    radius: Float[np.ndarray, "B"] | None = None
    uncertified: str = ""

    def __len__(self) -> int:
        return len(self.is_real)

    def __repr__(self) -> str:
        real = np.count_nonzero(self.is_real)
        principal = "none is principal" if self.principal is None else f"number {self.principal} is principal"
        mark = ", certified" if self.certified else ""
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


def values_over(discrete: Discretization, frame: Frame, r: Inexact[np.ndarray, "k"]) -> Branches:
    """Return all values over a restricted momentum in the user's frame."""
    canonical = discrete.system.to_canonical(r)
    return branches_of(discrete, canonical, roots_over(discrete, frame, canonical))


def values_at(node: Node, r: Inexact[np.ndarray, "k"]) -> Branches:
    """Return all values of a step under forces over a restricted momentum in the user's frame."""
    canonical = node.free.system.to_canonical(r)
    values = branches_of(node.free, canonical, _roots_of(node.free, node.frame, node.equations(canonical)))
    code, increment = node.principal(canonical)
    principal = _index_of(node.free, code, increment, values.displacement, values.is_real)
    return dataclasses.replace(values, region=np.full(len(values), ""), principal=principal)


class Roots(NamedTuple):
    """The roots of the equations of a restricted momentum, and the displacements minus the identity over them."""

    equations: Equations
    zeros: list[Root]
    increments: Inexact[np.ndarray, "B N N"]


def roots_over(discrete: Discretization, frame: Frame, canonical: Inexact[np.ndarray, "k"]) -> Roots:
    """Return the roots over a canonical restricted momentum, real or complex."""
    return _roots_of(discrete, frame, frame.equations(discrete.time_step * canonical))


def _roots_of(discrete: Discretization, frame: Frame, equations: Equations) -> Roots:
    system, zeros = discrete.system, roots_of(equations)
    back = system.group.inverse(system.frame)
    increments = [system.frame @ frame.increment(root.point.astype(complex)) @ back for root in zeros]
    return Roots(equations, zeros, np.array(increments).reshape(-1, *system.group.identity.shape))


def branches_of(discrete: Discretization, canonical: Inexact[np.ndarray, "k"], roots: Roots) -> Branches:
    """Return what is known of the displacements over a canonical restricted momentum."""
    system = cast(AbstractLLSystem, discrete.system)
    equations, zeros, X = roots
    is_real = np.array([root.is_real for root in zeros])
    return Branches(
        displacement=X + system.group.identity,
        momentum=legendre(discrete, X, "left"),
        is_real=is_real,
        multiplicity=np.array([root.multiplicity for root in zeros]),
        fold_distance=equations.regularity(equations.points([root.point for root in zeros])),
        energy=float(system.canonical.constrained_energy(canonical)),
        region=np.where(is_real, regions(discrete, X + system.group.identity), ""),
        principal=_index_of(discrete, *principal_increment(discrete, canonical), X + system.group.identity, is_real),
    )


def point_over(where: str, discrete: Discretization, frame: Frame, W: np.ndarray) -> Float[np.ndarray, "m"]:
    """Return the point over a real displacement, refused with its distance from the variety."""
    system = discrete.system
    canonical = system.group.inverse(system.frame) @ W @ system.frame
    x = frame.point(canonical)
    distance = float(np.linalg.norm(frame.increment(x) + np.eye(len(W)) - canonical))
    if not distance <= _ON_VARIETY * np.linalg.norm(W):
        remedy = "Build it as `group.exp(x)` with x admissible."
        raise error(where, "lie on the displacement variety", f"a matrix at distance {distance:.3g}", remedy)
    return x


def principal_increment(discrete: Discretization, canonical: Float[np.ndarray, "k"]) -> tuple[Outcome, Array]:
    """Return the outcome and the verified principal displacement, canonical, minus the identity."""
    route = discrete.route.compiled_route
    if route is None:
        return Outcome.branch_unverified, None
    outcome, chart = route.first_root(canonical)
    return outcome, discrete.variety.increment(chart) if outcome == Outcome.successful else None


def _index_of(discrete: Discretization, code: int, increment: Array, W: np.ndarray, is_real: np.ndarray) -> int | None:
    """Return the index of the verified principal root, canonical and minus the identity, among displacements."""
    if code != 0:
        return None
    frame = discrete.system.frame
    principal = frame @ increment @ discrete.system.group.inverse(frame)
    away = np.linalg.norm(W - discrete.system.group.identity - principal, axis=(1, 2))
    distances = np.where(is_real, away, np.inf)
    best = int(np.argmin(distances))
    return best if distances[best] <= SAME * max(1.0, float(np.linalg.norm(principal))) else None
