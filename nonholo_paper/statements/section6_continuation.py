"""Section 6, how the kinetic energy is continued from skew matrices to W - I."""

from collections.abc import Callable

from nonholo_paper import _twin as twin
from nonholo_paper._bodies import BALANCED_TOP, TOP, TOP_4, Body, displacements, slopes
from nonholo_paper._claims import statement
from nonholo_paper._finding import Measured
from nonholo_paper._twin import Matrix, Number
from nonholo_paper.formulas import general


@statement
def continuation() -> Measured:
    """Differentiate both continuations; on skew matrices they agree."""
    right, wrong = [], []
    for body in (TOP, BALANCED_TOP, TOP_4):
        X = twin.hat(body.group, twin.numbers(3, body.group.dim, -2, 2))
        right.append(general.continuation(X, body.tensor) - general.printed_continuation(X, body.tensor))
        for W in displacements(body):
            M = twin.column(twin.vee(body.group, general.matrix_momentum(W, body.tensor)))
            right.append(twin.worst(_momentum(body, general.continuation, W) - M))
            wrong.append(twin.worst(_momentum(body, general.printed_continuation, W) - M))
    return Measured(twin.worst(right), max(wrong), "tops n = 3, 4, 5 displacements each")


def _momentum(body: Body, continued: Callable[[Matrix, Matrix], Number], W: Matrix) -> Matrix:
    identity = twin.exp(0 * W)
    return slopes(lambda nudge: continued(nudge * W - identity, body.tensor), body.group)
