"""The benchmark bicycle in BicycleParameters: the state matrix of its linear equations."""

import numpy as np

NUMBERS = {"w": 1.02, "c": 0.08, "lam": np.pi / 10, "g": 9.81, "v": 1.0}
NUMBERS |= {"rR": 0.3, "mR": 2.0, "IRxx": 0.0603, "IRyy": 0.12, "rF": 0.35, "mF": 3.0, "IFxx": 0.1405, "IFyy": 0.28}
NUMBERS |= {"xB": 0.3, "zB": -0.9, "mB": 85.0, "IBxx": 9.2, "IByy": 11.0, "IBzz": 2.8, "IBxz": 2.4}
NUMBERS |= {"xH": 0.9, "zH": -0.7, "mH": 4.0, "IHxx": 0.05892, "IHyy": 0.06, "IHzz": 0.00708, "IHxz": -0.00756}
"""By their names; z points down."""


def state_matrix(speed: float) -> np.ndarray:
    """Return A of the states lean, steer and their rates."""
    from bicycleparameters.models import Meijaard2007Model
    from bicycleparameters.parameter_sets import Meijaard2007ParameterSet

    model = Meijaard2007Model(Meijaard2007ParameterSet(NUMBERS, includes_rider=True))
    return model.form_state_space_matrices(v=speed)[0]
