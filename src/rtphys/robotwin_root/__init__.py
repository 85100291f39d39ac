"""A folder that looks like RoboTwin to its launchers, and simulates rtphys' worlds."""

from rtphys.robotwin_root.base_task import Base_Task, UnStableError
from rtphys.robotwin_root.write import write_root

__all__ = ["Base_Task", "UnStableError", "write_root"]
