"""Counts and enclosures of all values that are proved: exact polynomials of the doubles given, roots by FLINT."""

from nonholo.discrete.certificate._certificate import enclosures
