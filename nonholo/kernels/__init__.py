"""The structured steps: the arithmetic of one update, written once for numba and JAX, and the compiled loops."""

from nonholo.kernels._driver import STATE_SIZE, advance, start, step_each
from nonholo.kernels._interface import Body, certified, increment, move, residual
from nonholo.kernels._sleigh import SleighBody
from nonholo.kernels._suslov import SuslovBody, suslov_body

__all__ = [
    "STATE_SIZE",
    "Body",
    "SleighBody",
    "SuslovBody",
    "advance",
    "certified",
    "increment",
    "move",
    "residual",
    "start",
    "step_each",
    "suslov_body",
]
