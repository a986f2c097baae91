"""Numerical functions with no mechanics in them."""

from nonholo.numerics._cubic import real_cubic_roots
from nonholo.numerics._even import half_cotangent, sinc, versine

__all__ = ["half_cotangent", "real_cubic_roots", "sinc", "versine"]
