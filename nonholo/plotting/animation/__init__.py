"""Moving pictures of orbits."""

from nonholo.plotting.animation._animation import animate
