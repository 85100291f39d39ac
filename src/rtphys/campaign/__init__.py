"""Many independent jobs, committed in order."""
