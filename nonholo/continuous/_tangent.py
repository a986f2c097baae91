r"""The derivatives of a continuous motion by its start: variations of momenta move as a pose does.

The rates $\sum_{ab}T_{ab}w_aw_b$ of momenta, $w = Vr$, change with r along
$$ \delta r' = \sum_a w_a\sum_b(T_{ab} + T_{ba})(V\,\delta r)_b, $$
linear in velocities and in $\delta r$, as $g' = g\hat\omega$ is. So the series of `_series` has both.
"""

import numpy as np

from nonholo.base.checks import error
from nonholo.base.types import Float
from nonholo.continuous._series import GUARD, Rates, assembled, body_numbers, power_of_two
from nonholo.kernels import solve_series
from nonholo.systems import AbstractSystem

_TOLERANCE = 1e-12


def flow_tangents(
    where: str, system: AbstractSystem, momenta: Float[np.ndarray, "K k"], time: Float[np.ndarray, "K"]
) -> Float[np.ndarray, "L k k"]:
    """Return the derivative of each momentum by the one before, for restricted momenta of a flow."""
    k = system.rank
    V, torques = body_numbers(system.group, system.constraint_subspace, system.inertia_operator)
    slopes = np.einsum("abn,bc->acn", torques + torques.swapaxes(0, 1), V)
    a, c, n = np.nonzero(slopes)
    column = np.arange(k)[:, None]
    places = np.stack([np.broadcast_to(a, (k, len(a))), k * c + column, k * n + column]).reshape(3, -1)
    f = assembled(V, Rates(places, np.tile(slopes[a, c, n], k), np.zeros((k, k * k))), torques)
    out = np.empty((len(time) - 1, k, k))
    for j, (r, step) in enumerate(zip(momenta, np.diff(time), strict=False)):
        unit = power_of_two(V @ r)
        rows, _ = solve_series(f, np.append(np.eye(k), r / unit), np.array([0.0, step * unit]), _TOLERANCE * GUARD)
        if len(rows) < 2:
            raise error(where, "be of a motion that can be integrated", f"none from state {j}", "Ask for closer times.")
        out[j] = rows[1, : k * k].reshape(k, k)
    return out
