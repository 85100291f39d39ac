"""Importing this before numpy makes a process compute the bits of all processors with AVX2.

import rtphys.core.pinned  # isort: skip
"""

from rtphys.core import arithmetic

arithmetic.pin()
