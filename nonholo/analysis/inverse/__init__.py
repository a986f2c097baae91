"""What body must have moved: bodies for recorded motions."""

from nonholo.analysis.inverse._fit import Fit, fit

__all__ = ["Fit", "fit"]
