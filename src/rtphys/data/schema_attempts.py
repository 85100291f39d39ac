"""Models of attempts: what the manifest says of one, and where a failed one went wrong."""

from typing import Literal

from pydantic import Field, FiniteFloat

from rtphys.data.schema_model import Count, Model, Seed, Sha256

Side = Literal["left", "right", ""]
Event = Literal["miss", "slip", "drop", "tip_over", "moved", "misplaced", "stuck", "end"]
"""What went wrong; `episode/failure.py` defines each."""


class AttemptEntry(Model):
    """One seed that was tried."""

    seed: Seed
    verdict: Literal["accepted", "rejected"]
    reason: str | None = None
    recovered: bool = Field(default=False, description="a load was lost and taken again")


class Failure(Model):
    """Where an attempt went wrong, found in its states and contacts."""

    reason: str = Field(description="as in the manifest")
    detail: str
    event: Event
    frame: Count = Field(description="the first frame that shows it")
    time: FiniteFloat = Field(description="s")
    object: str = Field(description="what it happened to; empty: nothing in particular")
    side: Side = Field(description="hand that it happened in")


class FailureEntry(Model):
    """A failed attempt that was kept: entry i of `failures` is `failures/*/episode_<i>`."""

    seed: Seed
    reason: str
    event: str = Field(description="see `failure.event` of its label")
    time: FiniteFloat = Field(description="s, when it went wrong")
    frames: Count


class JournalState(Model):
    """How much of a task dataset's journal this manifest tells."""

    entries: Count
    check: Sha256
