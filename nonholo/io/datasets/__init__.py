"""Orbits as labeled data in the user's body frame: datasets, tables, names of the columns."""

from nonholo.io.datasets._dataset import CANONICAL, HEADED, STEP, Variable, steps_apart, stored_variables
from nonholo.io.datasets._pose_variables import Stretch, column_names, compact_names, coordinate_rows, rows_of
