"""Suslov tops in space with any forbidden axis, and their accelerations by the definition, at 50 digits."""

import dataclasses

import nonholo as nh
from nonholo_paper import _twin as twin
from nonholo_paper._bodies import in_double
from nonholo_paper._twin import Matrix, Number, ctx
from nonholo_paper.formulas import suslov_continuous as suslov


@dataclasses.dataclass(frozen=True)
class Top:
    """A rigid body and its forbidden axis, which is a unit vector to rounding of the library alone."""

    inertia: Matrix
    axis: Matrix

    @property
    def system(self) -> nh.SuslovTop:
        """The top of the library."""
        return nh.SuslovTop.from_inertia(in_double(self.inertia), in_double(self.axis))

    def velocities(self) -> list[Matrix]:
        """Return admissible velocities: across the axis, of several lengths, and zero."""
        vectors = [twin.column(twin.numbers(seed, 3, -size, size)) for seed, size in ((1, 1), (2, 8), (3, 2**-20))]
        return [suslov.cross(self.axis, u) for u in vectors] + [ctx.zeros(3, 1)]

    def accelerated(self, w: Matrix) -> tuple[Matrix, Number]:
        """Return the rate of w and the multiplier by their definition: I w' = ad* p + lambda g and (w', g) = 0."""
        bordered = ctx.zeros(4)
        bordered[:3, :3] = self.inertia
        for i in range(3):
            bordered[i, 3], bordered[3, i] = -self.axis[i], self.axis[i]
        result = ctx.lu_solve(bordered, twin.column([*twin.coad(nh.SO(3), list(w), self.inertia * w), 0]))
        return result[:3], result[3]


GENERIC = Top(ctx.matrix([[2.25, -0.25, -0.5], [-0.25, 2.75, 0.25], [-0.5, 0.25, 2.5]]), twin.column([0.6, 0.0, 0.8]))
LAST = Top(GENERIC.inertia, twin.column([0, 0, 1]))
PRINCIPAL = Top(ctx.diag([2.25, 1.75, 1.5]), twin.column([0.48, 0.6, 0.64]))
FLAT = Top(ctx.matrix([[1.0, 0.25, 0.0], [0.25, 2.0, 0.0], [0.0, 0.0, 3.0]]), twin.column([0.6, 0.0, 0.8]))
BALANCED = Top(ctx.diag([2.0, 2.0, 1.5]), twin.column([0, 0, 1]))
TOPS = (GENERIC, LAST, PRINCIPAL, FLAT, BALANCED)


def states() -> list[tuple[Top, Matrix]]:
    """Return tops with admissible velocities."""
    return [(top, w) for top in TOPS for w in top.velocities()]
