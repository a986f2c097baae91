"""What motion a body must have made, or has to make: bodies for recorded motions, controls for goals."""

from nonholo.analysis.inverse._feedback import Feedback, Tracking, tracking_feedback
from nonholo.analysis.inverse._fit import Fit, fit
from nonholo.analysis.inverse._steer import Steering, steer
