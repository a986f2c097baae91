"""`geometric_phase`: where a gait takes a body, exactly and by the area rule."""

import dataclasses
import functools
from typing import Any

import numpy as np

from nonholo.analysis.locomotion import _equations
from nonholo.analysis.locomotion._connection import LocalConnection, door, local_connection
from nonholo.base.checks import array, error, scale
from nonholo.base.results import result
from nonholo.base.types import Array, Float
from nonholo.groups import SE, AbstractMatrixGroup

_AGREED = 1e-12  # of two results, the second with twice as many pieces
_PANELS, _MOST = 8, 512  # pieces of a period, at first and at most
_LOOKS = 401  # shapes at which a gait is checked
_CLOSED = 1e-9  # gap of a gait, relative to its size
_ITERATIONS = 60
_ROUNDING = 4e-16
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(20)
_POWERS = np.polynomial.legendre.legint(np.eye(20), lbnd=-1, axis=0)  # integrals of Legendre polynomials
_VALUES = np.polynomial.legendre.legvander(_NODES, 19)
_TO_NODES = np.polynomial.legendre.legval(_NODES, _POWERS).T @ np.linalg.inv(_VALUES) / 2
_NODES, _WEIGHTS = (_NODES + 1) / 2, _WEIGHTS / 2


@result
class GeometricPhase:
    """Where a gait takes a body that starts at the identity pose.

    Attributes:
        connection: The local connection.
        time: Times during the gait.
        shape: The shape at these times.
        configuration: The pose at these times, momenta included.
        heading: The heading at these times, unwrapped; None where poses are not of the plane.
        momentum: The momenta p at these times.
        holonomy: The geometric phase: the pose after the gait if the momenta were kept at zero. Of a kinematic system
            this is the last pose.
        area_rule: The exponential of minus the curvature inside the gait, which agrees with it to second order; NaN if
            there are singular shapes inside.
    """

    connection: LocalConnection
    time: Float[np.ndarray, "K"]
    shape: Float[np.ndarray, "K m"]
    configuration: Float[np.ndarray, "K N N"]
    heading: Float[np.ndarray, "K"] | None
    momentum: Float[np.ndarray, "K k"]
    holonomy: Float[np.ndarray, "N N"]
    area_rule: Float[np.ndarray, "N N"]


def geometric_phase(
    system: Any, gait: Any, *, period: float = 2 * np.pi, corners: Any = (), momentum: Any = None
) -> GeometricPhase:
    r"""Return the displacement by a gait: a closed motion s(t) of the shape, which its owner prescribes.

    $$ \dot g = -g\,A(s)\,\dot s \quad\text{(holonomy)}, \qquad
       \dot g = g\,(-A(s)\,\dot s + \Gamma(s)\,p) \quad\text{(configuration)}, \qquad
       g_{\mathrm{area}} = \exp\Bigl(-\int_\Sigma F\Bigr), $$

    with the momentum equation of `LocalConnection.momentum_rate`, which has no forces. The surface $\Sigma$ is the cone
    over the gait from its mean shape: in a plane, the inside with its sense of rotation, counted as often as the gait
    runs around it. The area rule is right to second order in the size of the gait: its error is of third order.
    Equations are solved by polynomials of degree 20 on pieces of the period, which are halved until the result agrees
    to 1e-12.

    Reference: [kelly-murray-1995], [bloch-krishnaprasad-marsden-murray-1996]; the area rule with the bracket in it is
    from [hatton-choset-2011].

    Args:
        system: A system, or its `local_connection`.
        gait: time -> shape (m,), written with `jax.numpy`, in the order of `shape_coordinates`.
        period: When the gait ends; a multiple of its period repeats it.
        corners: Times at which the gait has a corner.
        momentum: p at the start; zero by default.

    Raises:
        ValueError: A system that `local_connection` refuses; a gait that is not closed, or that meets a shape where the
            connection is singular.

    Example:
        A car that rolls to and fro while it steers moves aside, and does not turn:

        >>> import jax.numpy as jnp
        >>> def gait(time):
        ...     return jnp.array([jnp.sin(time), 0.5 * jnp.sin(2 * time)])
        >>> phase = nh.geometric_phase(nh.examples.kinematic_car().system, gait)
        >>> print(phase.holonomy[:2, 2].round(4), bool(abs(phase.heading[-1]) < 1e-12))
        [ 0.0046 -0.0522] True
    """
    connection = system if hasattr(system, "curvature") else local_connection(system)
    functions = door("geometric_phase")
    functions.check_gait(gait, len(connection.shape_coordinates))
    end = float(scale("geometric_phase(period=...)", period, "Pass the time that the gait takes."))
    breaks = array("geometric_phase(corners=...)", corners, (None,), "Pass times, or () for a smooth gait.")
    p = connection.checked_momentum("geometric_phase", momentum)
    p = array("geometric_phase(momentum=...)", p, (len(connection.momentum_components),))
    shape_at = functools.partial(functions.call, functions.moving_shape, gait)
    _check_closed(connection, shape_at(np.linspace(0.0, end, _LOOKS)[:, None])[0])
    panels, coarse = _PANELS, None
    while True:
        edges = np.union1d(np.linspace(0.0, end, panels + 1), breaks[(breaks > 0) & (breaks < end)])
        with np.errstate(all="ignore"):  # beside singular shapes
            fine, sizes = _displacement(connection, shape_at, edges, p)
        gap, inside = (np.inf, np.inf) if coarse is None else _distances(coarse, fine, sizes)
        if gap < _AGREED and inside < _AGREED:
            return fine
        if panels == _MOST and gap < _AGREED:  # singular shapes inside the gait alone
            return dataclasses.replace(fine, area_rule=np.full_like(fine.area_rule, np.nan))
        if panels == _MOST:
            at = _nearest(connection, fine.shape)
            got = f"one that {_MOST} pieces do not resolve, next to a singular shape at {at}"
            remedy = "Name its corners, or keep away from singular shapes."
            raise error("geometric_phase(gait=...)", "be smooth between its corners", got, remedy)
        panels, coarse = 2 * panels, fine


def _displacement(
    connection: LocalConnection, shape_at: Any, edges: Array, p: Array
) -> tuple[GeometricPhase, Float[np.ndarray, "p"]]:
    """Return the phase by polynomials of degree 20 in the time between edges, and the sizes of its momenta.

    These are alike in units of the body: where momenta cancel, those of their part by the shape.
    """
    h = np.diff(edges)
    time = edges[:-1, None] + h[:, None] * _NODES
    s, ds = shape_at(time[..., None])
    at = connection.terms(s)
    momentum, p_end = _momenta(connection.group, at, ds, h, p)
    group = connection.group
    pose, end = _poses(group, h, _equations.motion(group, at, ds, momentum)[0])
    holonomy = _poses(group, h, _equations.motion(group, at, ds, np.zeros_like(momentum))[0])[1]
    center = s.mean((0, 1))
    segments = ((weight * x, center + x * (s - center)) for x, weight in zip(_NODES, _WEIGHTS, strict=True))
    F: Any = sum(weight * _equations.curvature(group, connection.terms(shape)) for weight, shape in segments)
    area = -np.einsum("t,k,tkaij,tki,tkj->a", h, _WEIGHTS, F, s - center, ds)

    def whole(first: Array, between: Array, last: Array) -> Array:
        return np.concatenate([first[None], between.reshape(time.size, *between.shape[2:]), last[None]])

    g = whole(group.identity, pose, end)
    heading = np.unwrap(np.arctan2(g[:, 1, 0], g[:, 0, 0])) if group == SE(2) else None
    first, last = (shape_at(edges[[i], None])[0][0] for i in (0, -1))
    times = np.concatenate([edges[:1], time.ravel(), edges[-1:]])
    columns = heading, whole(p, momentum, p_end), holonomy, group.exp(area)
    phase = GeometricPhase(connection, times, whole(first, s, last), g, *columns)
    of_shape = np.einsum("tkai,tki->tka", at.matrix[..., : len(p), group.dim :], ds)
    units = at.units[0, 0, [connection.components.index(name) for name in connection.momentum_components]]
    largest = (np.abs(part * units).max(initial=0.0) for part in (phase.momentum, of_shape))
    return phase, (max(largest) or 1.0) / units


def _poses(
    group: AbstractMatrixGroup, h: Array, xi: Float[np.ndarray, "t k d"]
) -> tuple[Float[np.ndarray, "t k N N"], Float[np.ndarray, "N N"]]:
    r"""Return the poses of a motion with these body velocities, at the nodes and at the end, by collocation.

    In each piece $g_j = 1 + h\sum_l T_{jl}\,g_l\hat\xi_l$ are linear equations.
    """
    speed, one, n = h[:, None, None, None] * group.hat(xi), group.identity, group.point_size
    unit = np.ones_like(one)  # of lengths, in which one is as a turn
    unit[:n, n:] = np.abs(speed[..., :n, n:]).max(initial=0.0) or 1.0
    speed = speed / unit
    pieces, k, N = speed.shape[:3]
    steps = np.einsum("jl,tlba->tjalb", _TO_NODES, speed).reshape(pieces, k * N, k * N)
    matrices = np.linalg.solve(np.eye(k * N) - steps, np.tile(one, (k, 1)))
    inside = np.swapaxes(matrices.reshape(pieces, k, N, N), -1, -2)
    across = one + np.einsum("l,tlab,tlbc->tac", _WEIGHTS, inside, speed)
    before = [one]
    for each in across:
        before.append(before[-1] @ each)
    return np.array(before[:-1])[:, None] @ inside * unit, before[-1] * unit


def _momenta(
    group: AbstractMatrixGroup, at: _equations.Terms, ds: Array, h: Array, p: Array
) -> tuple[Float[np.ndarray, "t k p"], Array]:
    """Return the momenta at the nodes and at the end, piece by piece by Picard's iteration."""
    momenta = np.zeros((*ds.shape[:-1], len(p)))
    for i in range(len(h) if len(p) else 0):
        here = _equations.Terms(*(values[i] for values in at))
        momenta[i] = p
        for _ in range(_ITERATIONS):
            rates = _equations.motion(group, here, ds[i], momenta[i])[1]
            before, momenta[i] = momenta[i].copy(), p + h[i] * _TO_NODES @ rates
            if not np.abs(momenta[i] - before).max() > _ROUNDING * np.abs(momenta[i]).max():
                break
        p = p + h[i] * _WEIGHTS @ rates
    return momenta, p


def _distances(one: GeometricPhase, other: GeometricPhase, sizes: Float[np.ndarray, "p"]) -> tuple[float, float]:
    """Return by how much two motions and two area rules differ, beside the whole way; NaN if they are not finite."""
    n, unit = one.connection.group.point_size, np.ones_like(one.holonomy)
    unit[:n, n:] = np.abs(other.configuration[:, :n, n:]).max(initial=0.0) or 1.0
    ends = ((x.configuration[-1], x.momentum[-1:], x.holonomy, x.area_rule) for x in (one, other))
    pairs = zip(*ends, (unit, sizes, unit, unit), strict=True)
    gaps = [np.abs(a / u - b / u).max(initial=0.0) / (1 + np.abs(a / u).max(initial=0.0)) for a, b, u in pairs]
    return float(np.max(gaps[:3])), float(gaps[3])


def _check_closed(connection: LocalConnection, shape: Array) -> None:
    """Refuse a gait with a gap, with numbers that are not finite, or across a singular shape."""
    where = "geometric_phase(gait=...)"
    if not np.all(np.abs(shape[-1] - shape[0]) <= _CLOSED * np.abs(shape).max(axis=0)):
        remedy = "Pass its period, and a gait that returns to its first shape."
        raise error(where, "be closed and finite", f"{shape[0].tolist()} to {shape[-1].tolist()}", remedy)
    regular = _equations.singularity(connection.terms(shape))
    if not (regular * regular[0] > 0).all():
        remedy = "There the constraints do not determine the motion; pass a smaller gait."
        raise error(where, "keep away from singular shapes", f"{_nearest(connection, shape)} on its way", remedy)


def _nearest(connection: LocalConnection, shape: Array) -> dict[str, float]:
    """Return the shape that is nearest to a singular one."""
    nearness = np.abs(_equations.singularity(connection.terms(shape)))
    return dict(zip(connection.shape_coordinates, shape[np.argmin(nearness)].round(6).tolist(), strict=True))
