"""The compiled steps: scalar arithmetic written once for numba and JAX, the matrix step for any body, the loops."""

from nonholo.kernels._entry import AnyBody, advance, chart_of, sizes, start, step_each
from nonholo.kernels._general import GeneralBody
from nonholo.kernels._interface import Body, certified, increment, move, residual
from nonholo.kernels._secular import SecularBody, secular_sleigh, secular_top
from nonholo.kernels._sleigh import SleighBody
from nonholo.kernels._suslov import SuslovBody, suslov_body

__all__ = [
    "AnyBody",
    "Body",
    "GeneralBody",
    "SecularBody",
    "SleighBody",
    "SuslovBody",
    "advance",
    "certified",
    "chart_of",
    "increment",
    "move",
    "residual",
    "secular_sleigh",
    "secular_top",
    "sizes",
    "start",
    "step_each",
    "suslov_body",
]
