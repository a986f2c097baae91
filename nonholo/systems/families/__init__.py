"""The families of systems, one file each."""

from nonholo.systems.families._arrowhead import ArrowheadSleigh, ArrowheadTop
from nonholo.systems.families._ll_system import LLSystem
from nonholo.systems.families._lr_system import LRSystem, VeselovaTop
from nonholo.systems.families._multidimensional_sleigh import MultidimensionalSleigh
from nonholo.systems.families._rigid_body import RigidBody
from nonholo.systems.families._sleigh import ChaplyginSleigh
from nonholo.systems.families._suslov import SuslovTop
