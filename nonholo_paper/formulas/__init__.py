"""Formulas of the paper, as printed and corrected: plain functions, reached through their module by name."""
