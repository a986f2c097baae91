"""The ground of every room: types, checks, outcomes, limits, progress, compiled code, numerical functions."""
