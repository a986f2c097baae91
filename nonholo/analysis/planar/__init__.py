"""Bodies with two admissible directions, tops in space and sleighs in the plane, of which all is known.

The differences between the two are in `_disc` and `_strip`, which answer the same questions. Theory:
docs/theory/momentum-locus.md.
"""

from typing import Any, TypeAlias

import numpy as np

from nonholo.analysis.planar._base import HalfPlanes
from nonholo.analysis.planar._disc import Disc
from nonholo.analysis.planar._strip import Strip
from nonholo.base.checks import error, shape_of, shown, trailing
from nonholo.base.types import Float
from nonholo.discrete import Discretization, as_discretization, legendre
from nonholo.systems import AbstractSystem

PlanarVariety: TypeAlias = Disc | Strip
"""The displacements of either body; both answer the same questions."""


def planar_variety(system: AbstractSystem) -> PlanarVariety | None:
    """Return the displacements of a top in space or a sleigh in the plane; None for another system."""
    form = system.normal_form
    if form is None or not form.is_planar:
        return None
    kind = Strip if form.is_sleigh else Disc
    return kind(form, np.asarray(system.form_frame), np.asarray(system.form_map))


def blade_axes(system: AbstractSystem) -> Float[np.ndarray, "3 3"] | None:
    """Return the axes of the blade of a sleigh in the plane, at its contact point; None for other systems."""
    return getattr(planar_variety(system), "blade", None)


def planar_map(where: str, value: Any) -> tuple[Discretization, PlanarVariety]:
    """Return the discretization of a planar body that conserves energy, with its displacements, or refuse it."""
    discrete = as_discretization(where, value)
    variety = planar_variety(discrete.system)
    if variety is None:
        remedy = "For others sample `discrete_legendre`."
        raise error(where, "be of a top with n = 3 or of a sleigh in the plane", shown(discrete.system), remedy)
    check_conserves_energy(where, discrete, "keep energy")
    return discrete, variety


def check_conserves_energy(where: str, discrete: Discretization, demand: str) -> None:
    """Refuse a map whose energy drifts, in the words of the caller."""
    if not discrete.conserves_energy:
        got = f"difference={discrete.difference!r}, constraint={discrete.constraint!r}"
        remedy = "Use the defaults of `discretize`, difference='matrix' and constraint='skew'."
        raise error(where, demand, got, remedy)


def restricted_momenta(where: str, system: Any, momentum: Any) -> Float[np.ndarray, "... k"]:
    """Check momenta of the body, or along its constraint; return the latter."""
    k, dim = system.constraint_subspace.shape
    size = k if shape_of(momentum)[-1:] == (k,) else dim
    p = trailing(where, momentum, (size,), f"Pass {dim} body momenta or {k} along the constraint.", real=True)
    return p if size == k else system.restrict(p)


def momenta_at(
    discrete: Discretization, variety: PlanarVariety, points: Float[np.ndarray, "... c"]
) -> Float[np.ndarray, "... 3"]:
    """Return the momenta, physical and in the user's frame, of the displacements with these coordinates."""
    return legendre(discrete, variety.displacement(points) - discrete.system.group.identity, "left")
