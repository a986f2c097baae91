"""Controls for goals: steering by shooting and by IPOPT, over the exact step, and feedback along a motion."""

from nonholo.analysis.steering._feedback import Feedback, Tracking, tracking_feedback
from nonholo.analysis.steering._steer import Steering, steer
