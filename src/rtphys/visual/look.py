"""Draws the visual appearance of an episode; each part has a stream of its own."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from rtphys.assets.pack import Pack
from rtphys.core.errors import UnknownName
from rtphys.core.poses import Array, Pose, axis_angle
from rtphys.core.seeds import stream
from rtphys.setting.protocol import VisualRules
from rtphys.task.props import Mesh, Prop
from rtphys.task.spec import Task
from rtphys.visual.clutter import scatter

Vector = tuple[float, float, float]
Colour = Vector  # RGB, each 0..1

AMBIENT = (0.5, 0.5, 0.5)  # RoboTwin's clean lighting
FLICKER_AMBIENT = 0.1  # largest deviation of a flickering ambient light (RoboTwin)


@dataclass(frozen=True)
class LightColours:
    """Colours of the lights in every scene; None means as in protocol clean."""

    ambient: Colour = AMBIENT
    directional: Colour | None = None
    points: tuple[Colour, Colour] | None = None


@dataclass(frozen=True)
class Backdrop:
    """The part of the appearance that needs no asset pack, so that a verifier can draw it again."""

    seed: int = 0
    lights: LightColours = LightColours()
    flickers: bool = False
    table_height: float = 0.0  # [m] added to the physical table height, never positive
    camera_shift: Vector = (0.0, 0.0, 0.0)  # [m] head camera, in its own frame
    camera_turn: Vector = (0.0, 0.0, 0.0)  # [rad] head camera, rotation vector in its own frame

    @property
    def camera(self) -> Pose | None:
        """Visual displacement of the head camera, in its physical frame; None if there is none."""
        angle = float(np.linalg.norm(self.camera_turn))
        if not any(self.camera_shift) and not angle:
            return None
        q = axis_angle(np.array(self.camera_turn) / angle, angle) if angle else (1.0, 0, 0, 0)
        return Pose(self.camera_shift, q)

    def lights_at(self, frame: int) -> LightColours:
        """Light colours in one picture; `frame` counts from 0 at the start of the policy stage."""
        if not self.flickers:
            return self.lights
        return _light_colours(self.seed, str(frame), FLICKER_AMBIENT)


@dataclass(frozen=True)
class Look:
    """The visual appearance of an episode, as the visual rules of its protocol draw it."""

    backdrop: Backdrop
    split: str = "seen"
    table_texture: str | None = None  # "seen/planks_0", a picture of the pack
    wall_texture: str | None = None
    clutter: tuple[Mesh, ...] = ()  # task frame, upright; named clutter0, clutter1, ...

    def to_json(self) -> dict[str, object]:
        """The `visual` part of a label file: lengths in m, angles in rad."""
        back = self.backdrop
        return {
            "split": self.split,
            "table_texture": self.table_texture,
            "wall_texture": self.wall_texture,
            **backdrop_json(back),
            "clutter": [
                {"name": p.name, "category": p.category, "model": p.model} for p in self.clutter
            ],
        }

    def scene_info(self) -> dict[str, object]:
        """The same under RoboTwin's own keys, for `scene_info.json`."""
        return {
            "cluttered_table_info": [
                {"object_type": p.category, "object_index": str(p.model)} for p in self.clutter
            ],
            "texture_info": {
                "wall_texture": self.wall_texture,
                "table_texture": self.table_texture,
            },
        }


CLEAN = Look(Backdrop())


def backdrop_json(back: Backdrop) -> dict[str, object]:
    """A backdrop as plain JSON: the part of `Look.to_json` that needs no asset pack."""
    lights = back.lights
    return {
        "table_height": back.table_height,
        "lights": {
            "ambient": list(lights.ambient),
            "directional": None if lights.directional is None else list(lights.directional),
            "points": None if lights.points is None else [list(c) for c in lights.points],
        },
        "flickers": back.flickers,
        "camera_shift": list(back.camera_shift),
        "camera_turn": list(back.camera_turn),
    }


def backdrop(rules: VisualRules, seed: int) -> Backdrop:
    """Draw the part of the appearance that needs no asset pack."""
    flickers = _chance(seed, "flicker", rules.flicker_rate)
    height = -rules.table_drop * float(stream(seed, "visual", "table_height").uniform())
    rng = stream(seed, "visual", "camera")
    return Backdrop(
        seed=seed,
        lights=_light_colours(seed) if rules.light_colours else LightColours(),
        flickers=flickers,
        table_height=height + 0.0,  # never -0.0
        camera_shift=_in_ball(rng, rules.camera_shift),
        camera_turn=_in_ball(rng, float(np.radians(rules.camera_turn_deg))),
    )


def draw_look(
    rules: VisualRules | None, seed: int, scene: tuple[Task, Sequence[Prop]], pack: Pack, split: str
) -> Look:
    """Draw the appearance of one episode.

    Args:
        rules: visual rules of the protocol; None means as in protocol clean.
        scene: the task and its props in this episode, of which clutter keeps clear.
        split: "seen" or "unseen" pictures.

    Raises:
        MissingAsset: the pack has no pictures.
    """
    if rules is None:
        return CLEAN
    task, props = scene
    return Look(
        backdrop=backdrop(rules, seed),
        split=split,
        table_texture=_texture(rules, seed, "table", pack, split),
        wall_texture=_texture(rules, seed, "wall", pack, split),
        clutter=scatter(seed, rules.clutter, task, props, pack),
    )


def problems(label: Mapping[str, object], rules: VisualRules, seed: int) -> list[str]:
    """One sentence for each part of a stored `visual` label that the seed does not give.

    Pictures and clutter depend on the asset pack, so only their split and number are checked here.
    """
    wrong = []
    for key, expected in backdrop_json(backdrop(rules, seed)).items():
        if label.get(key) != expected:
            wrong.append(f"visual.{key} is {label.get(key)!r}, the seed gives {expected!r}")
    for key in ("table_texture", "wall_texture"):
        name = label.get(key)
        if name is None:
            continue
        if not rules.textures or not str(name).startswith(f"{label.get('split')}/"):
            wrong.append(f"visual.{key} is {name!r}, the protocol does not draw it")
    clutter = label.get("clutter")
    count = len(clutter) if isinstance(clutter, Sequence) else -1
    if not 0 <= count <= rules.clutter:
        wrong.append(f"visual.clutter holds {count} objects, at most {rules.clutter} are drawn")
    return wrong


def _texture(rules: VisualRules, seed: int, place: str, pack: Pack, split: str) -> str | None:
    if not rules.textures or _chance(seed, f"clean_{place}", rules.clean_background_rate):
        return None
    known = pack.textures(split)
    index = int(stream(seed, "visual", f"{place}_texture").integers(len(known)))
    return f"{split}/{known[index].stem}"


def texture_file(pack: Pack, name: str) -> Path:
    """The file of a picture that a look names, such as "seen/planks_0".

    Raises:
        UnknownName, MissingAsset: not in this pack.
    """
    split, _, stem = name.partition("/")
    known = {path.stem: path for path in pack.textures(split)}
    if stem not in known:
        raise UnknownName("texture", stem, known)
    return known[stem]


def _chance(seed: int, name: str, rate: float) -> bool:
    return float(stream(seed, "visual", name).uniform()) < rate


def _light_colours(seed: int, frame: str = "", ambient: float = 0.0) -> LightColours:
    rng = stream(seed, "visual", "lights", *([frame] if frame else []))
    directional, left, right, shade = (rng.uniform(0, 1, 3) for _ in range(4))
    glow = np.array(AMBIENT) + ambient * (2 * shade - 1) if ambient else np.array(AMBIENT)
    return LightColours(_plain(glow), _plain(directional), (_plain(left), _plain(right)))


def _in_ball(rng: np.random.Generator, radius: float) -> Vector:
    """A point uniform in a ball of `radius`; takes the same number of draws for each radius."""
    v, share = rng.normal(size=3), float(rng.uniform())
    return _plain(v / np.linalg.norm(v) * (radius * share ** (1 / 3)) + 0.0)


def _plain(values: Array) -> Vector:
    x, y, z = (float(v) for v in values)
    return x, y, z
