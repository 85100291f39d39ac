"""Pictures of numbers. The only package that imports matplotlib."""
