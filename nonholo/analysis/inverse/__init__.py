"""The inverse problem: bodies for recorded motions."""

from nonholo.analysis.inverse._fit import Fit, fit
from nonholo.analysis.inverse._profile import Profile
