"""Limits that a motion comes from and tends to."""

from nonholo.analysis.limits._asymptotics import Asymptotics, asymptotics, turn_of_flow
from nonholo.analysis.limits._flow_obstruction import FlowObstruction, flow_obstruction
from nonholo.analysis.limits._half_planes import HalfPlanes, half_planes
from nonholo.analysis.limits._heteroclinic import HeteroclinicOrbit, heteroclinic
