"""Pictures of a discretization: its surface of momenta, its invariant curves, values of the map; of a connection."""
