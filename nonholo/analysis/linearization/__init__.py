"""Motions beside a steady one: the linear equations, their eigenvalues and modes."""

from nonholo.analysis.linearization._critical import critical_values
from nonholo.analysis.linearization._linearize import Linearization, linearize, step_tangents
from nonholo.analysis.linearization._steady import SteadyMotion, steady_motion
