"""The command line: parse, one call, print. The only package that imports typer and rich."""
