"""Section 6: the discrete Lagrangian in Euler angles, as printed and corrected. Angles are (phi, theta, psi)."""

from collections.abc import Sequence

from nonholo_paper._twin import Matrix, Number, Vector, ctx


def rotation(phi: Number, theta: Number, psi: Number) -> Matrix:
    """Return the rotation with given Euler angles."""
    (c, s), (cf, sf), (cp, sp) = ((ctx.cos(x), ctx.sin(x)) for x in (theta, phi, psi))
    return ctx.matrix(
        [
            [cf * cp - c * sf * sp, -cf * sp - c * sf * cp, s * sf],
            [sf * cp + c * cf * sp, -sf * sp + c * cf * cp, -s * cf],
            [s * sp, s * cp, c],
        ]
    )


def factor_1(before: Sequence[Number], after: Sequence[Number]) -> Number:
    """Return what multiplies the first principal moment in minus the trace of the displacement and J."""
    total = before[2] + after[2]
    return _across(before, after, ctx.cos(total), ctx.sin(total))


def factor_2(before: Sequence[Number], after: Sequence[Number]) -> Number:
    """Return what multiplies the second principal moment."""
    total = before[2] + after[2]
    return _across(before, after, -ctx.cos(total), -ctx.sin(total))


def _across(before: Sequence[Number], after: Sequence[Number], cosine: Number, sine: Number) -> Number:
    (c, s), (d, r) = _nutations(before, after)
    along, beside = ctx.cos(after[0] - before[0]), ctx.sin(after[0] - before[0])
    level = c * d * (1 + along * cosine) + s * r * (cosine + along) - along * cosine
    return -(level + (d - c) * beside * sine) / 2


def factor_3(before: Sequence[Number], after: Sequence[Number]) -> Number:
    """Return what multiplies the third principal moment."""
    (c, s), (d, r) = _nutations(before, after)
    turn, spin = after[0] - before[0], after[2] - before[2]
    product = ctx.cos(turn) * ctx.cos(spin)
    level = product + c * d * product - c * d + s * r * (ctx.cos(spin) - ctx.cos(turn))
    return -(level - (c + d) * ctx.sin(turn) * ctx.sin(spin)) / 2


def printed_factor_1(before: Sequence[Number], after: Sequence[Number]) -> Number:
    """Return the first factor as printed."""
    (c, s), (d, r) = _nutations(before, after)
    turn, total = after[0] - before[0], before[2] + after[2]
    level = c * d * (1 + ctx.cos(turn) * ctx.cos(total)) + ctx.cos(total) * s * r
    level += ctx.cos(turn) * (s * r - ctx.cos(total))
    return (level + (d - c) * ctx.sin(turn) * ctx.sin(total) / 2) / 2


def printed_factor_2(before: Sequence[Number], after: Sequence[Number]) -> Number:
    """Return the second factor as printed."""
    (c, s), (d, r) = _nutations(before, after)
    turn, spin = after[0] - before[0], after[2] - before[2]
    level = c * d + ctx.cos(turn) * ctx.cos(spin) - c * d * ctx.cos(turn) * ctx.cos(spin)
    level += ctx.cos(turn) * s * r - ctx.cos(spin) * s * r
    level -= c * ctx.sin(before[0] + after[0]) * ctx.sin(spin)
    return (level - d * ctx.sin(turn) * ctx.sin(before[2] + after[2])) / 2


def _nutations(before: Sequence[Number], after: Sequence[Number]) -> list[tuple[Number, Number]]:
    return [(ctx.cos(angles[1]), ctx.sin(angles[1])) for angles in (before, after)]


def body_velocity(angles: Sequence[Number], rates: Sequence[Number]) -> Vector:
    """Return the brackets of (lagr_cont)."""
    _, theta, psi = angles
    turn, nutation, spin = rates
    return [
        turn * ctx.sin(theta) * ctx.sin(psi) + nutation * ctx.cos(psi),
        turn * ctx.sin(theta) * ctx.cos(psi) - nutation * ctx.sin(psi),
        spin + turn * ctx.cos(theta),
    ]


def kinetic_energy(moments: Sequence[Number], angles: Sequence[Number], rates: Sequence[Number]) -> Number:
    """Return the energy (lagr_cont)."""
    x, y, z = body_velocity(angles, rates)
    return x**2 * moments[0] / 2 + y**2 * moments[1] / 2 + z**2 * moments[2] / 2


def after_time(angles: Sequence[Number], rates: Sequence[Number], time: Number) -> Vector:
    """Return the next angles (angle_limit)."""
    return [angle + rate * time for angle, rate in zip(angles, rates, strict=True)]


def moments(masses: Sequence[Number]) -> Vector:
    """Return the principal moments of inertia from the principal mass moments."""
    J1, J2, J3 = masses
    return [J2 + J3, J1 + J3, J1 + J2]
