"""What a sense is: something that an episode can record beyond colour pictures, on request.

A sense is one class in a file of its own. Its fields say what it stores: from them follow how it is
written, read and verified. What else is peculiar to it is a method here; but one of scope "world"
also needs a recorder in the simulation, and the one there is (`sim.touch`) records for touch alone.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]
Arrays = Mapping[str, Array]  # by field
Names = Mapping[str, tuple[str, ...]]  # of ids, bodies, fingers, ..., by kind
Scope = Literal["pixel", "head", "bodies", "world"]
Encoding = Literal["as it is", "mm", "palette"]
PICTURE = {"H": 240, "W": 320}  # that Gymnasium observes


@dataclass(frozen=True, eq=False)
class Pixels:
    """What one camera gives at one instant; what is called is computed when it is called."""

    rgb: NDArray[np.uint8]  # (H, W, 3)
    depth: Callable[[], NDArray[np.float32]]  # (H, W) [m] along the optical axis; 0: nothing
    actors: Callable[[], NDArray[np.uint8]]  # (H, W) id of the body; 0 is the background
    meshes: Callable[[], NDArray[np.uint8]]  # (H, W) id of the mesh of that body
    intrinsic_cv: NDArray[np.floating]  # (3, 3) [px]
    cam2world_gl: NDArray[np.floating]  # (4, 4) camera -> world, OpenGL axes [m]
    X_TW: NDArray[np.float64]  # (4, 4) world -> task frame [m]


@dataclass(frozen=True)
class Field:
    """One array a frame, in memory and in an episode's file.

    Args:
        name: in memory.
        keys: where a legacy and a native file have it; `{camera}` stands for the camera's official
            name, `{view}` for that in native files.
        shape: of a frame in memory. "H" and "W" are those of the picture, another word is as much
            as there are names of that kind.
        low, high: the least and the largest value.
        encoding: what a file has instead: lengths in mm as float64, or the palette's colours.
        packed: whether a file compresses it, frame by frame.
        ids: "actor" or "mesh": the values are ids, and the file names each of them.
        notes: attributes of the stored array.
    """

    name: str
    keys: tuple[str, str]
    dtype: type[np.generic]
    shape: tuple[int | str, ...]
    low: float = -np.inf
    high: float = np.inf
    encoding: Encoding = "as it is"
    packed: bool = True
    ids: str = ""
    notes: tuple[tuple[str, str], ...] = ()

    def sized(self, sizes: Mapping[str, int]) -> tuple[int, ...]:
        """The shape of a frame in memory. `sizes`: what each word in `shape` is."""
        return tuple(sizes[n] if isinstance(n, str) else n for n in self.shape)

    @property
    def names(self) -> set[str]:
        """Kinds of names without which it says nothing."""
        kinds = {n for n in self.shape if isinstance(n, str)} - PICTURE.keys()
        return kinds | ({self.ids} if self.ids else set())


class Space(NamedTuple):
    """What Gymnasium observes of a sense: the arguments of a `Box`."""

    low: float
    high: float
    shape: tuple[int, ...]
    dtype: type[np.generic]


class Sense(ABC):
    """One thing that `collect` and others record when they are asked for it.

    Attributes:
        name: what users call it.
        scope: what it is computed of. "pixel": of what each camera sees, for each of its pixels;
            "head": of what the head camera sees; "bodies": of the poses of all bodies, which are
            known wherever pictures can be drawn; "world": of what the fingers feel, which is
            measured in the simulation alone.
        size: [bytes] of a pixel, or of a frame if the scope is not "pixel".
        fields: what a frame of it holds.
        exports: whether `exported` gives columns for LeRobot.
    """

    name: ClassVar[str]
    scope: ClassVar[Scope]
    size: ClassVar[int]
    fields: ClassVar[tuple[Field, ...]]
    exports: ClassVar[bool] = False

    @property
    def drawn(self) -> bool:
        """Whether cameras see it."""
        return self.scope in ("pixel", "head")

    @abstractmethod
    def capture(self, source: Any) -> Arrays:
        """The arrays of its fields.

        Args:
            source: by scope: `Pixels` of one instant, if it is drawn; otherwise `BodyPoses` or
                `Touch` of all T frames.
        """

    def problem(self, frames: Array) -> str:
        """What is wrong with values within their bounds; of a frame, or of all if not packed."""
        del frames
        return ""

    def space(self) -> Space | None:
        """What `observed` returns; None: it cannot be observed."""
        field = self.fields[0]
        return Space(field.low, field.high, field.sized(PICTURE), field.dtype)

    def observed(self, frame: Arrays) -> Array:
        """What Gymnasium shows of one instant."""
        return frame[self.fields[0].name]

    def exported(self, frames: Arrays, names: Names) -> dict[str, Array]:
        """Columns (T,) for LeRobot, by name; asked for where `exports` is true."""
        raise NotImplementedError(f"sense {self.name} exports columns and does not say which")
