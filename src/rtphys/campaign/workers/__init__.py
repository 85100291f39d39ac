"""Ways to carry out many independent jobs."""
