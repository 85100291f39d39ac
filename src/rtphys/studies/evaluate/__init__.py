"""`evaluate`: running a policy on certified instances."""
