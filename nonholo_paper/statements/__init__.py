"""Statements of the paper as findings: one file per topic, named by section."""
