"""An episode as a policy sees it: observations out, actions in."""

import rtphys.core.pinned  # noqa: F401  # isort: skip  (before numpy)

from rtphys.episode.observation import CameraView, Observation, View
from rtphys.episode.policy_episode import PolicyEpisode, begin

__all__ = ["CameraView", "Observation", "PolicyEpisode", "View", "begin"]
