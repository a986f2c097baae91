"""Numerical functions with no mechanics in them."""

from nonholo.numerics._cubic import real_cubic_roots
from nonholo.numerics._double_precision import double_precision
from nonholo.numerics._eigenspaces import real_eigenspaces
from nonholo.numerics._even import half_cotangent, sinc, versine
from nonholo.numerics._products import product_and_remainder

__all__ = [
    "double_precision",
    "half_cotangent",
    "product_and_remainder",
    "real_cubic_roots",
    "real_eigenspaces",
    "sinc",
    "versine",
]
