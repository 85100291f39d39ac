"""Which compiled packages can be loaded; run as a module it prints one line a failure.

Wheels bring most of what they link, but a bare Debian lacks a few system libraries.
"""

import re
import sys
from importlib import import_module

MODULES = (
    "numpy", "scipy", "h5py", "av", "cv2", "PIL", "trimesh", "manifold3d",
    "pinocchio", "coal", "toppra", "ruckig", "sapien",
)  # fmt: skip

# Shared library -> Debian's package, for all that the wheels were seen to ask for.
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


def failures() -> dict[str, str]:
    """Module -> why it cannot be imported. May crash: call it in a child process."""
    found = {}
    for name in MODULES:
        try:
            import_module(name)
        except Exception as problem:  # whatever a module's own start-up may raise
            found[name] = str(problem) or type(problem).__name__
    return found


def package_of(problem: str) -> str | None:
    """Debian's package for the shared library that an import error names."""
    match = re.search(r"\b(lib[\w.+-]+\.so[.\d]*): cannot open", problem)
    return PACKAGES.get(match[1]) if match else None


if __name__ == "__main__":
    wrong = failures()
    for module, problem in wrong.items():
        print(f"{module}: {problem}: {package_of(problem) or '-'}")
    sys.exit(1 if wrong else 0)
