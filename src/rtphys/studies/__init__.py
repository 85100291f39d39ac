"""The main commands, one call each."""
