"""The modules of the page under wasmtime, with numpy views of their memory."""

import ctypes
import itertools
from typing import NamedTuple

import numpy as np

from nonholo.explorer import kernel
from nonholo.kernels import Arrowhead

STACK = 65536


class Layout(NamedTuple):
    """Room for the numbers of a body and for a state, the places of a state, the numbers of a momentum and a pose.

    What stands at `chart` is NaN in a state that has not begun.
    """

    body: int
    state: int
    chart: int
    pose: int
    outcome: int
    rank: int = 2
    size: int = 4


LAYOUTS = dict.fromkeys(["top", "sleigh"], Layout(8, 16, 4, 10, 14))
LAYOUTS |= dict.fromkeys(["forced_top", "forced_sleigh"], Layout(1024, 24, 8, 4, 22))
LAYOUTS["flow4"] = Layout(8, 8, 0, 0, 0)
LAYOUTS["top4"] = Layout(8, 40, 6, 13, 29, 3, 16)


class Module:
    """A kernel that is instantiated, with room for a number of steps."""

    def __init__(self, body: str, steps: int) -> None:
        import wasmtime

        engine = wasmtime.Engine()
        self.module = wasmtime.Module(engine, kernel(body))
        self.store = wasmtime.Store(engine)
        self.layout = LAYOUTS[body]
        size = STACK + 8 * (self.layout.body + self.layout.state + (2 * self.layout.rank + self.layout.size) * steps)
        pages = wasmtime.MemoryType(wasmtime.Limits(-(-size // 65536), None))
        memory = wasmtime.Memory(self.store, pages)
        kind = wasmtime.GlobalType(wasmtime.ValType.i32(), True)
        arguments = {
            "__linear_memory": memory,
            "__stack_pointer": wasmtime.Global(self.store, kind, wasmtime.Val.i32(STACK)),
        }
        instance = wasmtime.Instance(self.store, self.module, [arguments[item.name] for item in self.module.imports])
        self.run = instance.exports(self.store)["run"]
        start = ctypes.addressof(memory.data_ptr(self.store).contents)
        numbers = (ctypes.c_double * (memory.data_len(self.store) // 8)).from_address(start)
        self.memory, self.kept = np.frombuffer(numbers, dtype=np.float64), memory
        self.steps = steps

    def orbit(self, body: tuple, momentum: np.ndarray, pose: np.ndarray) -> tuple[int, int, np.ndarray]:
        """Return how many steps were good, the outcome, and rows of momenta, charts and poses."""
        at, own, steps = STACK // 8, self.layout, self.steps
        self.memory[at : at + len(body)] = body
        state = self.memory[at + own.body : at + own.body + own.state]
        state[:] = 0.0
        state[: own.rank], state[own.chart], state[own.pose : own.pose + own.size] = momentum, np.nan, pose
        rows = at + own.body + own.state
        first = [8 * at, 8 * (at + own.body)]
        ends = np.cumsum([0, own.rank, own.rank, own.size])
        done = self.run(self.store, *first, steps, *(8 * (rows + int(k) * steps) for k in ends[:-1]))
        parts = [
            self.memory[rows + k * steps : rows + end * steps].reshape(steps, -1) for k, end in itertools.pairwise(ends)
        ]
        return done, int(state[own.outcome]), np.hstack(parts)[:done]

    def flow(self, f: Arrowhead, node: np.ndarray, times: np.ndarray, end: float) -> np.ndarray:
        """Return the states of `solve_arrowhead` at some times."""
        at, count = STACK // 8, len(times)
        state = at + self.layout.body
        own, rows = state + self.layout.state, state + self.layout.state + count
        self.memory[at : at + 7], self.memory[state : state + 8] = (*f.rates, *f.coupling, end), node.ravel()
        self.memory[own:rows] = times
        reached = self.run(self.store, 8 * at, 8 * state, count, 8 * own, 8 * rows, 0)
        return self.memory[rows : rows + 3 * reached].reshape(-1, 3).copy()
