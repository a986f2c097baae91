"""What the core alone does: how kernels run, by kind of motion, in `simulate`, `flow` and `ensemble`."""

from matrix.kinds import KINDS

_LIBRARY, _JAX = "library", "extra `jax`"
_COORDINATES = "particle", "rolling disk", "snakeboard", "driven sleigh", "Chaplygin ball", "sleigh in a well"
ALONE: dict[str, list[str]] = {
    **{
        kind: [_JAX if kind in ("own difference", "driven on a group", *_COORDINATES) else _LIBRARY] * 3
        for kind in KINDS
    },
    **{kind: [_JAX, _LIBRARY, _JAX] for kind in ("own group", "logarithmic")},
    "friction, table": [_LIBRARY, "", _LIBRARY],
    "force in numba": ["your own numba", "your own numba", "your own numba"],
}
"""A test runs each kind without extras; what is empty is refused."""
