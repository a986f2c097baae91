"""The families of systems."""

from nonholo.systems.families._arrowhead import ArrowheadSleigh, ArrowheadTop
from nonholo.systems.families._general import LLSystem, LRSystem, VeselovaTop
from nonholo.systems.families._sleighs import ChaplyginSleigh, MultidimensionalSleigh
from nonholo.systems.families._tops import RigidBody, SuslovTop
