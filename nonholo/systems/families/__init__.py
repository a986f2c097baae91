"""The families of systems."""

from nonholo.systems.families._general import LLSystem, LRSystem, VeselovaTop
from nonholo.systems.families._sleighs import ArrowheadSleigh, ChaplyginSleigh, MultidimensionalSleigh
from nonholo.systems.families._tops import ArrowheadTop, RigidBody, SuslovTop
