"""Robots of the builtin pack, one module each; `EMBODIMENTS` maps folder name to writer."""

from collections.abc import Callable
from pathlib import Path

from rtphys.assets.embodiments.aloha_agilex import write_aloha_agilex
from rtphys.assets.embodiments.franka_panda import write_franka_panda
from rtphys.assets.embodiments.piper import write_piper

EMBODIMENTS: dict[str, Callable[[Path], None]] = {
    "aloha-agilex": write_aloha_agilex,
    "franka-panda": write_franka_panda,
    "piper": write_piper,
}
