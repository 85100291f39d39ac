"""The attributes, one a file, found by scanning this folder."""
