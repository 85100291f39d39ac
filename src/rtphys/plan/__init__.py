"""Motion planning: kinematics, collision, search and timing. No simulator, no wall clock."""
