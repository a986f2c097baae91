"""Ready systems of the literature, each with a start and with what is known about its motion."""

from nonholo.base.checks import needs

with needs("jax", "nonholo.examples"):
    from nonholo.literature._chaplygin_ball import chaplygin_ball
    from nonholo.literature._driven_sleigh import driven_sleigh
    from nonholo.literature._example import Example
    from nonholo.literature._heavy_suslov_top import heavy_suslov_top
    from nonholo.literature._kinematic_car import kinematic_car
    from nonholo.literature._knife_edge import knife_edge_on_incline
    from nonholo.literature._oscillators import chaotic_quartic_oscillator, non_reversible
    from nonholo.literature._particle import particle
    from nonholo.literature._robot import two_wheeled_robot
    from nonholo.literature._roller_racer import roller_racer
    from nonholo.literature._rolling_disk import rolling_disk
    from nonholo.literature._sleigh_in_a_well import sleigh_in_a_well
    from nonholo.literature._snakeboard import snakeboard
    from nonholo.literature.rolling import ball_on_turntable, rattleback, tilting_disk
    from nonholo.literature.vehicles import bicycle, snake, trailers

__all__ = [
    "Example",
    "ball_on_turntable",
    "bicycle",
    "chaotic_quartic_oscillator",
    "chaplygin_ball",
    "driven_sleigh",
    "heavy_suslov_top",
    "kinematic_car",
    "knife_edge_on_incline",
    "non_reversible",
    "particle",
    "rattleback",
    "roller_racer",
    "rolling_disk",
    "sleigh_in_a_well",
    "snake",
    "snakeboard",
    "tilting_disk",
    "trailers",
    "two_wheeled_robot",
]
