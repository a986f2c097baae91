"""The properties that groups, systems and discretisations must have, checked for ours and for users' own."""
