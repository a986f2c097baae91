"""Flows in coordinates beside heyoka, which gets the same formulas node by node: processor time, in turns.

Both integrate places and velocities with the same rates, without their checks and their orbits, at a tolerance of
2.2e-16; their ends must agree to 1e-10. "First" is what heyoka takes to compile.

    python benchmarks/coordinates_beside_heyoka.py [--rounds 21] [--smoke]
"""

import os
import tempfile
import time
from collections.abc import Callable
from typing import Any

import numpy as np
from _command import leave_out, small
from _command import options as command

os.environ["XDG_CACHE_HOME"] = tempfile.mkdtemp()  # formulas are seen while they are made

from _inside import Expansion, flow_by_series

import nonholo as nh

try:
    import heyoka
except ImportError:
    leave_out("heyoka, pip install heyoka")

NAMES, TOLERANCE = ("rolling_disk", "snakeboard", "bicycle"), 2.2e-16
LARGE = 1000  # nodes; heyoka compiles more of them in its compact mode, the usual one takes minutes
TWO: dict[str, Callable[..., Any]] = {
    "add": lambda x, y: x + y,
    "sub": lambda x, y: x - y,
    "mul": lambda x, y: x * y,
    "div": lambda x, y: x / y,
    "pow": lambda x, y: x**y,
    "neg": lambda x: -x,
}


def main() -> None:
    """Print a table."""
    parser = command(__doc__)
    parser.add_argument("--rounds", type=int, default=small(21, 1))
    rounds = parser.parse_args().rounds
    print("| system | nodes | T | heyoka, us | integration, us | integration / heyoka | difference | first, s |")
    print("| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |")
    for name in small(NAMES, NAMES[:1]):
        ready = getattr(nh.examples, name)()
        graph = graph_of(ready)
        start = np.concatenate([ready.configuration, ready.body_velocity])
        numbers = np.concatenate([np.zeros(0), *map(np.ravel, ready.system.parameters.values())])
        begin = time.process_time()
        peer = integrator_of(graph, np.append(start, numbers))
        first = time.process_time() - begin
        for end in small((5.0, 50.0), (5.0,)):
            row = _row(ready, peer, np.append(start, numbers), end, rounds)
            print(f"| {name} | {len(graph.order)} | {end:g} | {row} | {first:.2f} |", flush=True)


def _row(ready: Any, peer: Any, state: np.ndarray, end: float, rounds: int) -> str:
    times, count = np.array([0.0, end]), len(ready.configuration) + len(ready.body_velocity)

    def by_heyoka() -> np.ndarray:
        peer.time, peer.state[:] = 0.0, state
        peer.propagate_until(end)
        return peer.state[:count]

    def ours() -> np.ndarray:
        first = ready.configuration, ready.body_velocity
        columns, _ = flow_by_series(ready.system, first, times, 64 * TOLERANCE)  # of which a step has 1 / 64
        return np.concatenate([column[-1] for column in columns])

    ends = [np.array(run()) for run in (by_heyoka, ours)]
    gap = np.abs(ends[0] - ends[1]).max() / np.abs(ends[0]).max()
    assert gap < 1e-10, gap
    spent = np.array([[_taken(run) for run in (by_heyoka, ours)] for _ in range(rounds)])
    (theirs, own), ratio = np.median(spent, axis=0) * 1e6, np.median(spent[:, 1] / spent[:, 0])
    return f"{theirs:.0f} | {own:.0f} | {ratio:.2f} | {gap:.1e}"


def graph_of(ready: Any) -> Any:
    """Return the formulas of a flow: numbers of a state, their rates, and operations one after another."""
    graphs, write = [], Expansion.write

    def noting(self: Any, *arguments: Any) -> None:
        graphs.append(self)
        write(self, *arguments)

    Expansion.write = noting
    try:
        ready.flow(times=[0.0, 0.1])
    finally:
        Expansion.write = write
    return graphs[0]


def integrator_of(graph: Any, state: np.ndarray) -> Any:
    """Return heyoka's method for a graph, whose last number is the unit of time: it has no part in rates."""
    *inputs, _ = graph.inputs
    z = heyoka.make_vars(*(f"z{i}" for i in range(len(inputs))))
    terms = dict(zip(inputs, z, strict=True))

    def term(x: Any) -> Any:
        return terms[x] if x.value is None else heyoka.expression(float(x.value))

    for x in graph.order:
        make = TWO.get(x.operation) or getattr(heyoka, x.operation)
        terms[x] = make(*map(term, x.arguments))
    equations, is_large = list(zip(z, map(term, graph.rates[:-1]), strict=True)), len(graph.order) > LARGE
    return heyoka.taylor_adaptive(equations, state, tol=TOLERANCE, compact_mode=is_large)


def _taken(run: Callable[[], Any]) -> float:
    begin = time.process_time()
    run()
    return time.process_time() - begin


if __name__ == "__main__":
    main()
