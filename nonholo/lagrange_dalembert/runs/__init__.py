"""Runs in coordinates: the first state, blocks of steps and their decoding, stretches for stores, parts of steps."""

from nonholo.lagrange_dalembert.runs._partial_step import after_parts
from nonholo.lagrange_dalembert.runs._run import CoordinateRun
from nonholo.lagrange_dalembert.runs._simulate import (
    Start,
    checked_block,
    checked_counts,
    first_state,
    iterated,
    simulated,
)
