r"""Regions of the displacements of a top in three dimensions, between the critical points of its energy.

The energy landscape is shared with `analysis`, which names all its critical points. Reference:
[fedorov-zenkov-2004], section 6, "Invariant curves", as corrected in docs/theory/critical-energies.md.
"""

import dataclasses

import numpy as np
import scipy  # its parts load on first use

from nonholo.base.types import Float, Inexact
from nonholo.discrete._discretization import Discretization
from nonholo.systems import NormalForm


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
    c, balanced = np.asarray(form.coupling), not form.is_coupled
    along = np.array([1.0, 0.0]) if balanced else c / np.hypot(*c)
    axes = np.stack([along, [-along[1], along[0]]], axis=1)
    inertia = axes.T @ form.stiffness_matrix @ axes
    sharpness = 0.0 if balanced else float(c @ c / np.linalg.det(inertia))
    inverses, vectors = scipy.linalg.eigh(np.diag([1.0, 1.0 - sharpness]), inertia)
    return Landscape(axes, inertia, sharpness, inverses, vectors)


def is_regular(discrete: Discretization) -> bool:
    r"""Tell whether a discretization has regions: a top with n = 3 and $\det B > 2|c|^2$ that conserves its energy."""
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
    seen = frame.T @ np.real(displacement) @ frame
    square = land.axes.T @ (np.eye(2) - seen[:, :2, :2]) @ land.axes / 2  # z z^T
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
