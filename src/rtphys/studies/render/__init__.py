"""`render`: a dataset drawn again from its stored states."""
