"""Moving pictures of orbits."""
