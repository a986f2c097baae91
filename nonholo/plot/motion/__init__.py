"""Pictures of an orbit: paths in space, momenta, the error of its energy, quantities in time."""
