"""Formulas of the notes behind the end of the document: the coadjoint action on se*(2)."""

from nonholo.reproduction._twin import Matrix, Number, ctx

Pair = tuple[Number, Number]


def coadjoint(theta: Number, v: Pair, mu: Number, m: Pair) -> Matrix:
    """Return the coadjoint action of (theta, v) on (mu, m) as a matrix."""
    cosine, sine = ctx.cos(theta), ctx.sin(theta)
    p = m[0] * cosine + m[1] * sine, m[1] * cosine - m[0] * sine
    a = v[0] * cosine + v[1] * sine, v[1] * cosine - v[0] * sine
    turned = mu + a[1] * p[0] - a[0] * p[1]
    return ctx.matrix([[0, -turned, p[0]], [turned, 0, p[1]], [0, 0, 0]])
