r"""Whether a group preserves a bilinear form, so that its inverse is the linear map $W \mapsto G^{-1}W^TG$."""

import numpy as np

from nonholo.base.checks import array, error
from nonholo.base.types import Array, Float
from nonholo.groups._coordinates import coordinates_of

_ROUNDING = 1e-10  # relative; a form typed with ten digits is taken as meant


def checked_form(where: str, basis: Float[np.ndarray, "dim N N"], form: Array) -> Float[np.ndarray, "N N"]:
    r"""Return G as a read-only array, refused unless the energy theorem holds on the group of the basis.

    G must be nondegenerate, $x^TG + Gx = 0$ on the algebra, and $x^3$ must stay in it: then so does
    $(W - W^{-1})/2$, see docs/theory/energy-theorem.md.
    """
    size = basis.shape[-1]
    form = array(where, form, (size, size), f"Pass the ({size}, {size}) matrix G of the form that the group preserves.")
    values = np.linalg.svd(form, compute_uv=False)
    if not values[-1] > _ROUNDING * values[0]:
        got = f"singular values from {values[0]:.3g} to {values[-1]:.3g}"
        raise error(where, "be nondegenerate", got, "Leave it out: without it W^-1 is not linear in W.")
    unit = basis / np.linalg.norm(basis, axis=(1, 2), keepdims=True)
    _preserved(where, unit, form / values[0])
    _cubes_stay(where, unit)
    return array(where, form + 0.0, form.shape)


def _preserved(where: str, unit: np.ndarray, form: np.ndarray) -> None:
    residuals = np.abs(np.swapaxes(unit, 1, 2) @ form + form @ unit).max(axis=(1, 2))
    if residuals.max() > _ROUNDING:
        worst = int(residuals.argmax())
        got = f"a residual of {residuals[worst]:.3g} at matrix {worst} of the basis (both scaled to length 1)"
        raise error(where, "satisfy x^T G + G x = 0 on the algebra", got, "Pass the form that the group preserves.")


def _cubes_stay(where: str, unit: np.ndarray) -> None:
    """Refuse an algebra that some x^3 leaves; a polynomial identity, tried on random x."""
    coordinates = coordinates_of(unit)
    X = coordinates.matrix(np.random.default_rng(0).normal(size=(4, len(unit))) / np.sqrt(len(unit)))
    cubes = X @ X @ X
    gap = np.abs(cubes - coordinates.matrix(coordinates.vector(cubes))).max()
    if gap > _ROUNDING * np.abs(cubes).max():
        requirement = "be that of a group whose algebra contains (W - W^-1)/2"
        got = f"an algebra that a cube leaves by {gap / np.abs(cubes).max():.3g} of its size"
        raise error(where, requirement, got, "Pass the whole algebra of the form: U(p, q), not SU(p, q).")
