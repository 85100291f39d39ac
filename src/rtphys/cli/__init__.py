"""The command line: parse, one call, print. The only package that imports typer and rich."""

import rtphys.core.pinned  # noqa: F401  # isort: skip  (before numpy)
