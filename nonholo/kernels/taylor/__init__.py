"""Continuous motions by Taylor series: their quadratic equations, one motion, many side by side."""

from nonholo.kernels.taylor._arrowhead import Arrowhead, solve_arrowhead
from nonholo.kernels.taylor._expansion import Quadratic, sparse_products
from nonholo.kernels.taylor._flat import flat_arrowhead_run
from nonholo.kernels.taylor._members import solve_members
from nonholo.kernels.taylor._solve import revisit_series, solve_series
from nonholo.kernels.taylor._steps import order_for
