"""Ready systems of the literature, each with a start and with what is known about its motion."""

from nonholo.base.checks import needs

with needs("jax", "nonholo.examples"):
    from nonholo.examples._balls import ball_in_bowl, ball_on_turntable, chaplygin_ball
    from nonholo.examples._bicycle import bicycle
    from nonholo.examples._blades import driven_sleigh, knife_edge_on_incline, sleigh_in_a_well
    from nonholo.examples._boards import roller_racer, snake, snakeboard, twistcar
    from nonholo.examples._cars import kinematic_car, trailers, two_wheeled_robot
    from nonholo.examples._disks import rolling_disk, tilting_disk
    from nonholo.examples._example import Example
    from nonholo.examples._heavy_suslov_top import heavy_suslov_top
    from nonholo.examples._points import chaotic_quartic_oscillator, non_reversible, particle
    from nonholo.examples._rattleback import rattleback

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
    "twistcar",
    "two_wheeled_robot",
]
