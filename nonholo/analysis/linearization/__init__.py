"""Motions beside a steady one: the linear equations, their eigenvalues and modes."""

from nonholo.analysis.linearization._linearize import (
    Linearization,
    SteadyMotion,
    critical_values,
    linearize,
    steady_motion,
    step_tangents,
)
