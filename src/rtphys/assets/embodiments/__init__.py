"""Robots of the builtin pack, one module each; `EMBODIMENTS` maps folder name to writer."""

from collections.abc import Callable
from pathlib import Path

from rtphys.assets.embodiments.aloha_agilex import write_aloha_agilex

EMBODIMENTS: dict[str, Callable[[Path], None]] = {"aloha-agilex": write_aloha_agilex}
