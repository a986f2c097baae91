"""Pictures of sweeps."""

from nonholo.plotting.sweeps._sweep_map import SweepMap, sweep_map

__all__ = [
    "SweepMap",
    "sweep_map",
]
