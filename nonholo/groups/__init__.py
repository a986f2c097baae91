"""Matrix Lie groups: pure functions of plain arrays, written once for NumPy and JAX."""

from nonholo.groups._base import AbstractMatrixGroup
from nonholo.groups._matrix_group import MatrixGroup
from nonholo.groups._product import ProductGroup
from nonholo.groups._special_euclidean import SE, components_of
from nonholo.groups._special_orthogonal import SO, matrix_from_quaternion, quaternion_from_matrix
from nonholo.groups._translations import Translations
