"""Packages that are missing or cannot be loaded, and what installs them.

As a program it prints one line for each compiled package that cannot be imported. Wheels contain
most libraries that they link, but a minimal Debian lacks a few others. Nothing else of rtphys is
imported here: it would need those packages.
"""

import re
import sys
from importlib import import_module

MODULES = (
    "numpy", "scipy", "h5py", "av", "cv2", "PIL", "trimesh", "manifold3d",
    "pinocchio", "coal", "toppra", "ruckig", "sapien",
)  # fmt: skip

# Shared library -> Debian package, for all libraries that the wheels were seen to need.
PACKAGES = {
    "libX11.so.6": "libx11-6",
    "libgomp.so.1": "libgomp1",
    "libGL.so.1": "libgl1",
    "libglib-2.0.so.0": "libglib2.0-0",
    "libgthread-2.0.so.0": "libglib2.0-0",
    "libstdc++.so.6": "libstdc++6",
    "libz.so.1": "zlib1g",
    "libexpat.so.1": "libexpat1",
}

# Package -> the optional part of rtphys that brings it.
EXTRAS = {
    "pyarrow": "lerobot",
    "websockets": "serve",
    "msgpack": "serve",
    "gymnasium": "gym",
    "ray": "ray",
    "sklearn": "identify",
    "rerun": "view",
}


def failures() -> dict[str, str]:
    """Module -> why it cannot be imported. An import may crash: call this in a child process."""
    problems: dict[str, str] = {}
    for name in MODULES:
        try:
            import_module(name)
        except Exception as problem:  # a module may raise anything while it starts
            problems[name] = str(problem) or type(problem).__name__
    return problems


def package_of(problem: str) -> str | None:
    """The Debian package of the shared library that an import error names, if known."""
    match = re.search(r"\b(lib[\w.+-]+\.so[.\d]*): cannot open", problem)
    return PACKAGES.get(match[1]) if match else None


def cure_of(error: ImportError) -> str:
    """The command that installs the part that is missing or broken; empty for any other package."""
    package, _, part = (error.name or "").partition(".")
    if package not in EXTRAS:
        return ""
    # A part that is missing, or a library that cannot be loaded: it is there, broken.
    broken = part or not isinstance(error, ModuleNotFoundError)
    force = "--force-reinstall " if broken else ""
    return f"`pip install {force}'rtphys[{EXTRAS[package]}]'`"


if __name__ == "__main__":
    broken = failures()
    for module, problem in broken.items():
        print(f"{module}: {problem}: {package_of(problem) or '-'}")
    sys.exit(1 if broken else 0)
