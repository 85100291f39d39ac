"""Other people's formats, made from a dataset's files."""
