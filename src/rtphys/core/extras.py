"""The optional parts of rtphys."""

EXTRAS = {
    "pyarrow": "lerobot",
    "websockets": "serve",
    "msgpack": "serve",
    "gymnasium": "gym",
    "ray": "ray",
    "sklearn": "identify",
    "rerun": "view",
}
"""Package -> the part that brings it."""


def cure_of(error: ImportError) -> str:
    """The command that installs the part that is missing or broken; empty for any other package."""
    package, _, part = (error.name or "").partition(".")
    if package not in EXTRAS:
        return ""
    # A part that is missing, or a library that cannot be loaded: it is there, broken.
    broken = part or not isinstance(error, ModuleNotFoundError)
    force = "--force-reinstall " if broken else ""
    return f"`pip install {force}'rtphys[{EXTRAS[package]}]'`"
