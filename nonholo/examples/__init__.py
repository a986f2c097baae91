"""Ready systems of the literature, each with a start and with what is known about its motion."""

from nonholo.base.checks import needs

with needs("jax", "nonholo.examples"):
    from nonholo.examples._chaplygin_ball import chaplygin_ball
    from nonholo.examples._driven_sleigh import driven_sleigh
    from nonholo.examples._example import Example
    from nonholo.examples._heavy_suslov_top import heavy_suslov_top
    from nonholo.examples._kinematic_car import kinematic_car
    from nonholo.examples._knife_edge import knife_edge_on_incline
    from nonholo.examples._oscillators import chaotic_quartic_oscillator, non_reversible
    from nonholo.examples._particle import particle
    from nonholo.examples._robot import two_wheeled_robot
    from nonholo.examples._roller_racer import roller_racer
    from nonholo.examples._rolling_disk import rolling_disk
    from nonholo.examples._sleigh_in_a_well import sleigh_in_a_well
    from nonholo.examples._snakeboard import snakeboard
    from nonholo.examples.rolling import ball_in_bowl, ball_on_turntable, rattleback, tilting_disk
    from nonholo.examples.vehicles import bicycle, snake, trailers

__all__ = [
    "Example",
    "ball_in_bowl",
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
