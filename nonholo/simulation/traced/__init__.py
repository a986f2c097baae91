"""Runs as JAX functions: the rollout. Imported on first use."""

from nonholo.simulation.traced._rollout import rollout
