"""Runs without JAX's loops: the equations of a system, translated to formulas and compiled."""

from nonholo.lagrange_dalembert.compiled._flow import flow, flow_rows
from nonholo.lagrange_dalembert.compiled._run import advance, decoded, set_out, value
