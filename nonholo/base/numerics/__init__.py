"""Numerical functions with no mechanics in them; `time_sweep` needs diffrax, and is imported on first use."""

from nonholo.base.numerics._cubic import real_cubic_roots
from nonholo.base.numerics._double_precision import double_precision, keep_programs
from nonholo.base.numerics._functions import (
    block_diagonal,
    cayley_increment,
    cotangent_deficit,
    exponential_increment,
    half_cotangent,
    identity_like,
    integrated_exponential,
    inverse_cayley,
    inverse_of,
    of_skew,
    principal_logarithm,
    real_eigenspaces,
    sinc,
    versine,
)
from nonholo.base.numerics._products import (
    Factors,
    applied,
    factors_of,
    of_length_one,
    product_and_remainder,
    solve_by_factors,
)
