"""Which members a sweep has: designs, what they draw from, random numbers by member."""

from nonholo.ensembles.designs._design import (
    AbstractDesign,
    Design,
    Grid,
    RandomDesign,
    axis_dimensions,
    uniform_numbers,
)
from nonholo.ensembles.designs._distributions import (
    DISTRIBUTIONS,
    AbstractDistribution,
    Choice,
    Direction,
    LogUniform,
    MassTensor,
    Normal,
    Uniform,
)
