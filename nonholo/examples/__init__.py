"""Ready systems of the literature, each with a start and with what is known about its motion."""

from nonholo.base.checks import needs

with needs("jax", "nonholo.examples"):
    from nonholo.examples._example import Example
    from nonholo.examples._knife_edge import knife_edge_on_incline
    from nonholo.examples._oscillators import chaotic_quartic_oscillator, non_reversible
    from nonholo.examples._particle import particle
    from nonholo.examples._robot import two_wheeled_robot
    from nonholo.examples._rolling_disk import rolling_disk
    from nonholo.examples._snakeboard import snakeboard

__all__ = [
    "Example",
    "chaotic_quartic_oscillator",
    "knife_edge_on_incline",
    "non_reversible",
    "particle",
    "rolling_disk",
    "snakeboard",
    "two_wheeled_robot",
]
