"""How an episode is recorded: which cameras, their optics, and what else is kept."""

import re
from dataclasses import replace
from typing import Annotated, NamedTuple

from pydantic import AfterValidator

from rtphys.core.errors import BadValue
from rtphys.senses import SENSES
from rtphys.spec.option import Option, checked_dataclass, one_of
from rtphys.spec.stored import CLOSED


class Optics(NamedTuple):
    """Of one camera."""

    width: int  # [px]
    height: int  # [px]
    fovy_deg: float  # vertical field of view


KINDS = {  # RoboTwin, _camera_config.yml
    "D435": Optics(320, 240, 37.0),
    "Large_D435": Optics(640, 480, 37.0),
    "L515": Optics(320, 180, 45.0),
    "Large_L515": Optics(640, 360, 45.0),
}
# Short name -> official name.
CAMERAS = {name: f"{name}_camera" for name in ("head", "left", "right", "front")}
HEAD = CAMERAS["head"]
USUAL = ("head", "left", "right")
# Tasks in which an arm hides from the head camera what the front camera shows. A policy in an
# evaluation still sees the usual three.
FRONT_TOO = ("place_phone_stand",)
LAYOUTS = ("native", "legacy")
SHADERS = ("slim", "default", "minimal", "rt")
SMALLEST, LARGEST = 16, 2048  # [px] of a picture's width and height

CameraType = Annotated[
    str | None,
    one_of("camera type", KINDS),
    Option("D435, L515, Large_D435 or Large_L515, for every camera."),
]
Size = Annotated[str | None, Option("WxH: picture size; the vertical field of view is kept.")]


@checked_dataclass(frozen=True, config=CLOSED)
class RecordingSpec:
    """What is recorded of an episode. Senses, type and size count for every camera alike."""

    cameras: Annotated[
        tuple[str, ...],
        one_of("camera", (*CAMERAS, *CAMERAS.values())),
        AfterValidator(lambda names: tuple(name.removesuffix("_camera") for name in names)),
        Option("Any of head, left, right, front. Default: the first three; in some tasks all."),
    ] = ()  # none named: the usual ones of the task
    senses: Annotated[
        tuple[str, ...],
        one_of("sense", SENSES),
        Option(f"Also record any of {', '.join(SENSES)}; several with commas.", "sense"),
    ] = ()
    camera_type: CameraType = None
    size: Size = None
    layout: Annotated[str, one_of("layout", LAYOUTS), Option("native or legacy.")] = "native"
    look: str | None = None  # name of the textures and lights (`load_look`); None: the spec's own
    shader: Annotated[
        str, one_of("shader", SHADERS), Option("Renderer's shader: slim, default, minimal or rt.")
    ] = "slim"

    def __post_init__(self) -> None:
        for key, names in (("camera", self.official), ("sense", self.senses)):
            if len(set(names)) < len(names):
                raise BadValue(f"{key}s", ",".join(names), f"name each {key} once")
        for name in self.senses:
            if SENSES[name].scope == "head" and HEAD not in self.official:
                allowed = f"it is the head camera's, and the cameras are {','.join(self.official)}"
                raise BadValue("senses", name, allowed)
        if self.size is not None:
            parse_size(self.size)

    def of_task(self, task: str) -> "RecordingSpec":
        """With the cameras that a task is recorded with where none are named."""
        usual = (*USUAL, "front") if task in FRONT_TOO else USUAL
        return replace(self, cameras=self.cameras or usual)

    @property
    def official(self) -> tuple[str, ...]:
        """Official names of the cameras, in the order asked for."""
        return tuple(CAMERAS[name] for name in self.cameras or USUAL)

    def optics(self, own: str) -> Optics:
        """Of a camera whose own type is `own`, one of `KINDS`."""
        optics = KINDS[self.camera_type or own]
        return optics if self.size is None else Optics(*parse_size(self.size), optics.fovy_deg)

    def frame_bytes(self) -> float:
        """What the senses of one frame take in a file [bytes]."""
        width, height, _ = self.optics("D435")
        each = {"pixel": width * height * len(self.official)}
        senses = [SENSES[name] for name in self.senses]
        return sum(sense.size * each.get(sense.scope, 1) for sense in senses)

    def picture_scale(self) -> float:
        """How many pixels a picture has, against the usual 320 x 240."""
        width, height, _ = self.optics("D435")
        return width * height / (320 * 240)

    @property
    def touch(self) -> bool:
        """Whether what the fingers feel is recorded: it is what senses of the world are made of."""
        return any(SENSES[name].scope == "world" for name in self.senses)


def parse_size(text: str) -> tuple[int, int]:
    """Width and height [px] of "640x480".

    Raises:
        BadValue: it is not spelled so, or no picture or video can have this size.
    """
    match = re.fullmatch(r"(\d{1,6})x(\d{1,6})", text)
    if match is None:
        raise BadValue("size", text, "write WIDTHxHEIGHT, such as 640x480")
    width, height = int(match[1]), int(match[2])
    if not all(SMALLEST <= side <= LARGEST for side in (width, height)):
        raise BadValue("size", text, f"each from {SMALLEST} to {LARGEST} pixels")
    if width % 2 or height % 2:
        raise BadValue("size", text, "both must be even, for the video")
    return width, height
