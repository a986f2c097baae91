"""Numerical functions with no mechanics in them; `time_sweep` needs diffrax, and is imported on first use."""

from nonholo.base.numerics._bernoulli import cotangent_deficit
from nonholo.base.numerics._cubic import real_cubic_roots
from nonholo.base.numerics._double_precision import double_precision, keep_programs
from nonholo.base.numerics._eigenspaces import real_eigenspaces
from nonholo.base.numerics._even import half_cotangent, sinc, versine
from nonholo.base.numerics._lengths import of_length_one
from nonholo.base.numerics._matrix_functions import (
    block_diagonal,
    cayley_increment,
    exponential_increment,
    identity_like,
    integrated_exponential,
    inverse_cayley,
    inverted,
    of_skew,
    principal_logarithm,
)
from nonholo.base.numerics._products import Factors, applied, factors_of, product_and_remainder, solved
