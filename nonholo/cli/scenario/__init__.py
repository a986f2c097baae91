"""Scenarios as files: what they may say, reading them, saying what is wrong."""
