"""What motion a body must have made, or has to make: bodies fitted to recorded motion."""

from nonholo.analysis.inverse._fit import Fit, fit
