"""One evaluated episode: a line of JSON, the same bytes on every run."""

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path

from rtphys.core.errors import BadFile
from rtphys.data.episode import JSON
from rtphys.data.json_text import plain

REASONS: dict[str, str] = {
    "step_limit": "the task's number of actions was used up",
    "gave_up": "the policy stopped by itself",
    "policy_error": "the policy raised; `detail` holds the traceback",
    "infeasible": "the world could not be set up: certified on other ground",
    "worker_crash": "the process died, twice",
    "worker_hang": "the episode ran longer than `timeout`, twice",
}
"""Why an episode is no success."""


@dataclass(frozen=True)
class EpisodeRecord:
    """What a policy made of one certified instance. No wall-clock time: runs are compared."""

    task: str
    protocol: str
    seed: int
    success: bool  # the condition held at some instant (official)
    held: bool = False  # and still did 0.5 s after the policy had stopped
    reason: str = ""  # one of `REASONS`; empty for a success
    first_touch: float | None = None  # [s] of simulated time, when the condition first held
    steps: int = 0  # actions
    time: float = 0.0  # [s] simulated, until the policy stopped
    unreachable: int = 0  # end-effector targets that an arm could not be brought to
    physics: Mapping[str, JSON] = field(default_factory=dict)  # attributes and auxiliary draws
    state: str = ""  # SHA-256 over the states of the episode
    detail: str = ""  # a traceback, or what is missing for success

    def to_json(self) -> dict[str, JSON]:
        return {f.name: plain(getattr(self, f.name), f.name) for f in fields(self)}

    @staticmethod
    def from_json(data: Mapping[str, JSON], where: str | Path) -> "EpisodeRecord":
        """Inverse of `to_json`.

        Raises:
            BadFile: a key is missing or unknown.
        """
        try:
            return EpisodeRecord(**data)  # type: ignore[arg-type] - written by `to_json`
        except TypeError as error:
            raise BadFile(where, f"is no record of an episode: {error}") from error
