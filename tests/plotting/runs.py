"""Short runs that the tests of the pictures share."""

import nonholo as nh

MASS_TENSOR = [[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]]


def top_run(body_velocity: tuple[float, float, float], **options: int) -> nh.Orbit:
    """Run the generic top."""
    return nh.simulate(nh.discretize(nh.SuslovTop(MASS_TENSOR), 0.1), body_velocity=body_velocity, **options)


def sleigh_run(body_velocity: tuple[float, float, float], a: float = 0.5, b: float = 0.3, **options: int) -> nh.Orbit:
    """Run a sleigh of unit mass and inertia."""
    sleigh = nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=a, b=b)
    return nh.simulate(nh.discretize(sleigh, 0.1), body_velocity=body_velocity, **options)
