"""Continuous motions by Taylor series: their quadratic equations, one motion, many side by side."""

from nonholo.kernels.taylor._arrowhead import Arrowhead, room_for_steps, solve_arrowhead, take_step, terms_for
from nonholo.kernels.taylor._expansion import Quadratic, sparse_products
from nonholo.kernels.taylor._solve import Columns, revisit_series, solve_members, solve_series
from nonholo.kernels.taylor._steps import order_for
