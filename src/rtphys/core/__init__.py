"""What everything else stands on: errors, chance, poses, timing, and the library of files."""
