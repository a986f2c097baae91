"""Runs in coordinates: the first state, blocks of steps and their decoding, stretches for stores, parts of steps."""

from nonholo.lagrange_dalembert.runs._discretization import AbstractLagrangeDAlembertMap
from nonholo.lagrange_dalembert.runs._simulate import Start, first_state
