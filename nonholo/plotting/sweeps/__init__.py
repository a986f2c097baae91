"""Pictures of sweeps."""

from nonholo.plotting.sweeps._sweep_map import SweepMap, sweep_map
