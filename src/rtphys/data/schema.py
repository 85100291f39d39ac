"""The JSON files of a dataset as typed, versioned models."""

from pathlib import Path
from typing import Annotated, Literal, TypeVar

from pydantic import ConfigDict, Field, FiniteFloat, JsonValue, ValidationError

from rtphys.core.untrusted import JSON, parse_mapping
from rtphys.data import files
from rtphys.data.json_text import Count, Model, Quaternion, Seed, Vector3, plain
from rtphys.physics.attribute import attribute, is_attribute
from rtphys.spec.collection import DATASET_VERSION
from rtphys.spec.stored import SchemaError, problems_of

Kind = TypeVar("Kind", bound=Model)

Side = Literal["left", "right", ""]
Event = Literal["miss", "slip", "drop", "tip_over", "moved", "misplaced", "stuck", "end"]
"""What went wrong; `episode/failure.py` says when it is which."""


class DomainName(Model):
    """Which domain the physics was drawn from."""

    name: str
    digest: str


class AttributeLabel(Model):
    """One of the physical attributes, in force during the whole episode."""

    value: FiniteFloat | Vector3 | None = Field(description="null: the asset's own value")
    unit: str
    varied: bool = Field(description="false: nominal in this episode")
    source: Literal["nominal", "domain", "set", "look"] = Field(description="who chose the value")
    could_act: bool = Field(description="false: its world has nothing that it changes")
    acted: bool | None = Field(
        default=None,
        description="whether another value had changed the episode; null: not measured",
    )
    tolerance: FiniteFloat | None = Field(
        default=None, description="how far the world may differ, in `unit`; null: not stated"
    )
    scope: str = Field(default="", description="what the tolerance is true of; empty: everything")

    @property
    def note(self) -> str:
        """That the value says nothing about the episode, in words; empty where it may."""
        if not self.could_act:
            return "could not act"
        return "did not act" if self.acted is False else ""


def informs(key: str, label: AttributeLabel) -> bool:
    """Whether an attribute's value says something about its episode: what a table has a number for.

    A camera attribute that the user holds at 0 does, whatever mode was drawn beside it.
    """
    if label.could_act or label.source != "set" or not is_attribute(key):
        return not label.note
    return attribute(key).acts_on is None


class Readback(Model):
    """What the simulator said after everything was applied. Keys are names of the scene."""

    bodies: dict[str, dict[str, JsonValue]] = Field(
        default={}, description="mass, inertia, com, spin_decay"
    )
    surfaces: dict[str, dict[str, JsonValue]] = Field(default={}, description="friction, ...")
    joints: dict[str, dict[str, JsonValue]] = Field(default={}, description="damping, friction")
    servos: dict[str, dict[str, JsonValue]] = Field(default={}, description="damping")
    table: dict[str, JsonValue] = Field(default={}, description="tilt_deg, height")
    scale: dict[str, JsonValue] = Field(default={})
    external_force: dict[str, JsonValue] = Field(default={}, description="per body [N], world")


class CameraPose(Model):
    """Camera in the world at the first frame: x forward, y left, z up."""

    position: Vector3 = Field(description="m")
    quaternion_wxyz: Quaternion


class VisualLabel(Model):
    """How the episode looks: what its protocol's visual rules drew."""

    split: Literal["seen", "unseen"]
    table_texture: str | None = Field(description="such as seen/planks_017; null: plain")
    wall_texture: str | None
    lights: dict[str, JsonValue] = Field(description="RGB; null: as in clean")
    flickers: bool = Field(description="light colours are drawn anew for every picture")
    clutter: list[dict[str, JsonValue]] = Field(description="name, category, model")


class StrainLabel(Model):
    """The largest loads on the robot during the episode."""

    force: FiniteFloat = Field(description="N, on one link that is no finger")
    pair: str = Field(description="that link and what it met; empty: nothing")
    force_seconds: FiniteFloat = Field(description="s, longest time above 30 N")
    torque: FiniteFloat = Field(description="share of its motor's largest, in an arm joint")
    joint: str = Field(description="that joint")
    torque_seconds: FiniteFloat = Field(description="s, longest time at the motor's limit")


class Verdict(Model):
    """Why the episode counts."""

    model_config = ConfigDict(extra="allow", frozen=True, strict=True)

    accepted: bool
    clutter_disturbed: bool | None = Field(
        default=None, description="a piece moved by more than 2 cm or tipped; null: no clutter"
    )
    first_success_time: FiniteFloat | None = Field(default=None, description="s")
    held: bool | None = Field(default=None, description="success still held at the end")
    recovered: bool = Field(default=False, description="a load was lost and taken again")
    strain: StrainLabel
    stages: list[JsonValue] = Field(default=[])


class PhysMeta(Model):
    """`phys_meta/episode_*.json`: the physics of one episode as the contact solver had it."""

    schema_version: str = DATASET_VERSION
    seed: Seed
    task: str
    protocol: str
    episode: Count
    domain: DomainName
    attributes: Annotated[dict[str, AttributeLabel], Field(min_length=1)]
    draws: dict[str, JsonValue] = Field(default={}, description="camera_mode, redraws, ...")
    readback: Readback
    visual: VisualLabel | None = Field(default=None, description="null: as in clean")
    cameras: dict[str, CameraPose]
    verdict: Verdict
    recipe: dict[str, JsonValue]
    versions: dict[str, str]
    state_hash: str


class Failure(Model):
    """Where an attempt went wrong, found in its states and contacts."""

    reason: str = Field(description="as in the ledger")
    detail: str
    event: Event
    frame: Count = Field(description="the first frame that shows it")
    time: FiniteFloat = Field(description="s")
    object: str = Field(description="what it happened to; empty: nothing in particular")
    side: Side = Field(description="hand that it happened in")


class FailureMeta(PhysMeta):
    """`failures/phys_meta/*.json`: the label of an attempt that failed and was kept."""

    failure: Failure


class SceneEntry(Model):
    """One episode of `scene_info.json`, the official keys."""

    model_config = ConfigDict(extra="allow", frozen=True, strict=True)

    cluttered_table_info: list[dict[str, JsonValue]] = Field(default=[])
    texture_info: dict[str, JsonValue] = Field(default={})
    info: dict[str, JsonValue] = Field(default={})


class Instructions(Model):
    """`instruction/*.json`."""

    seen: list[str]
    unseen: list[str]


def read(kind: type[Kind], path: Path) -> Kind:
    """A JSON file as one of the models. Raises `BadFile`, which names each key that is wrong."""
    content = parse_mapping(files.read(path), path)
    with problems_of(path):
        return kind.model_validate(content)


def checked(kind: type[Model], value: object) -> dict[str, JSON]:
    """Plain JSON of a value that fits a model. Raises `SchemaError`, `BadValue`."""
    name = kind.__name__
    try:
        return kind.model_validate(plain(value, name)).model_dump(mode="json")
    except ValidationError as error:
        raise SchemaError(name, error) from error
