"""What every room stands on: types, checks, outcomes, limits, progress, compiled code, numerical functions."""
