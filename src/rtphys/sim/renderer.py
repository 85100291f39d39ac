"""The only place that configures SAPIEN's renderer: shader pack, pixel format, lights, pictures.

`configure` must run before the first scene with a render system is made; `pictures_ready` tells
whether it did. Costs on a CPU (lavapipe) are vertex-bound: keep a scene under 20 000 triangles.
"""

import os
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

# Mesa's CPU driver reads this once, when the device is created: no threads of its own, because
# rtphys runs one worker a core and pictures cost the same CPU time either way.
os.environ.setdefault("LP_NUM_THREADS", "0")

import numpy as np
import sapien
from numpy.typing import NDArray

from rtphys.core.cache import NoCache
from rtphys.core.errors import BadValue, NoRenderer
from rtphys.senses.depth import DEPTH_SCALE
from rtphys.sim.shader import ShaderMismatch, cache_folder, sensing_pack, slim_pack
from rtphys.spec.recording import SHADERS
from rtphys.visual.look import AMBIENT, LightColours

SENSING = ("slim", "default")  # those that also give depth and ids
Picture = NDArray[np.uint8]  # (H, W, 3) RGB
Read = Callable[[str], NDArray[Any]]
"""Name of what a camera took ("Color") -> (H, W, C); as `get_picture` of a camera."""
COLOUR, SENSE_BUFFERS = ("Color",), ("GbufferDepth", "Segmentation")

# What SAPIEN raises for a missing device or a shader that it cannot use.
_DRAW_ERRORS = (RuntimeError, IndexError)

_configured: list[str] = []  # SAPIEN's renderer has settings of the whole process
_anchors: dict[str, sapien.Scene] = {}  # by shader of their cameras; empty: the process's own


# The official lighting (RoboTwin 2.0).
DIRECTIONAL, POINT = (0.5, 0.5, 0.5), (1.0, 1.0, 1.0)
DIRECTION = (0.0, 0.5, -1.0)  # in which light travels
POINTS = ((1.0, 0.0, 1.8), (-1.0, 0.0, 1.8))  # [m]
# The shadow map, seen along the light, is a square about the arms and the table: no camera sees a
# shadow beyond it. Twice its area at the same 3 mm a pixel costs 0.5 ms more a picture.
SHADOW_CENTRE = (0.0, 0.1, 0.25)  # [m]
SHADOW_HALF_SIZE, SHADOW_REACH = 0.7, 5.0  # [m], the latter before and behind the centre
SHADOW_MAP = 448  # [px]


class Lights:
    """The lights of a scene: ambient, one directional light, two point lights.

    Only the directional light casts a shadow: each shadowed point light would draw the scene six
    times more. All scenes of a process have the same lights and shadows, because SAPIEN compiles
    its pipelines anew for every combination; colours may change from picture to picture.
    """

    def __init__(self, scene: sapien.Scene) -> None:
        self._scene = scene
        scene.set_ambient_light(AMBIENT)
        self._directional = scene.add_directional_light(
            DIRECTION,
            DIRECTIONAL,
            shadow=True,
            shadow_scale=SHADOW_HALF_SIZE,
            shadow_near=-SHADOW_REACH,
            shadow_far=SHADOW_REACH,
            shadow_map_size=SHADOW_MAP,
            position=SHADOW_CENTRE,
        )
        self._points = [scene.add_point_light(place, POINT, shadow=False) for place in POINTS]

    def recolour(self, colours: LightColours) -> None:
        """Change the colours; None among them: the official one."""
        self._scene.set_ambient_light(colours.ambient)
        self._directional.set_color(colours.directional or DIRECTIONAL)
        for lamp, colour in zip(self._points, colours.points or (POINT, POINT), strict=True):
            lamp.set_color(colour)


def configure(shader: str = "slim") -> None:
    """Choose how this process draws. Repeating the same choice does nothing.

    Args:
        shader: "slim" (default), "default" or "minimal" (SAPIEN's own), "rt" (ray tracing, 32
            samples a pixel, depth 8, denoised where possible; for machines with a GPU).

    Raises:
        BadValue: unknown shader, or another one was chosen before in this process.
        NoRenderer: SAPIEN finds no device to draw with.
    """
    if shader not in SHADERS:
        raise BadValue("shader", shader, f"allowed: {', '.join(SHADERS)}")
    if _configured:
        if _configured[0] != shader:
            raise BadValue("shader", shader, f"this process already draws with {_configured[0]!r}")
        return
    sapien.render.set_log_level("error")
    sapien.render.set_camera_shader_dir(_shader_folder(shader))
    # Pictures arrive as bytes: reading floats back and converting costs three times as much.
    sapien.render.set_picture_format("Color", "r8g8b8a8unorm")
    sapien.render.set_picture_format("Surface", "r16g16b16a16sfloat")  # slim's own
    sapien.render.set_picture_format("Segmentation", "r16g16b16a16uint")  # half of its own
    if shader == "rt":
        sapien.render.set_ray_tracing_samples_per_pixel(32)
        sapien.render.set_ray_tracing_path_depth(8)
        try:
            cuda = sapien.Device("cuda").is_cuda()
        except RuntimeError:
            cuda = False
        sapien.render.set_ray_tracing_denoiser("oidn" if cuda else "none")
    _configured.append(shader)


def ready(shader: str = "slim", senses: bool = False) -> None:
    """`configure`, and `hold_anchor`."""
    configure(shader)
    hold_anchor(senses)


def pictures_ready() -> bool:
    """Whether `configure` has run in this process."""
    return bool(_configured)


def hold_anchor(senses: bool = False) -> None:
    """Keep one tiny scene drawn and alive, so that later scenes reuse its compiled pipelines.

    SAPIEN drops everything it compiled when the last camera of the process dies. Call this before
    the first world with pictures; it also tries the slim shader out, and falls back if SAPIEN
    refuses it.

    Args:
        senses: also for cameras that are asked for depth and ids.

    Raises:
        NoRenderer: no device, or the first frame fails.
        BadValue: senses are asked for, and the shader gives none.
    """
    if not _configured:
        configure()
    if "" not in _anchors:
        try:
            _anchors[""] = _first_frame()
        except _DRAW_ERRORS as error:
            refusal: Exception = error
            if _configured[0] == "slim":
                _warn_slower(refusal)
                sapien.render.set_camera_shader_dir("default")
                try:
                    _anchors[""] = _first_frame()
                except _DRAW_ERRORS as again:
                    refusal = again
            if "" not in _anchors:
                cure = "`rtphys doctor` names the cure"
                raise NoRenderer(f"no picture: {refusal}; {cure}") from refusal
    if senses:
        hold(sensing_shader())


def hold(shader: str) -> None:
    """As `hold_anchor`, for cameras of another shader than the process's own."""
    if shader not in _anchors:
        _anchors[shader] = _first_frame(shader)


def _first_frame(shader: str = "") -> sapien.Scene:
    scene = sapien.Scene()
    Lights(scene)
    camera = sapien.render.RenderCameraComponent(16, 16, shader)
    camera.set_fovy(0.6, compute_x=True)
    camera.near, camera.far = 0.1, 100.0
    mount = sapien.Entity()
    mount.add_component(camera)
    scene.add_entity(mount)
    scene.update_render()
    capture(camera)
    return scene


class Sensed(NamedTuple):
    """What a camera gives beside colours, pixel by pixel, (H, W) each."""

    depth: NDArray[np.float32]  # [m] along the optical axis; 0 where nothing is
    shapes: NDArray[np.uint16]  # `per_scene_id` of the render shape; 0: nothing
    entities: NDArray[np.uint16]  # likewise of the entity


def check_senses(shader: str) -> None:
    """Refuses senses under a shader that gives none. Raises `BadValue`."""
    if shader not in SENSING:
        allowed = f"it draws colours alone; senses need {' or '.join(SENSING)}"
        raise BadValue("shader", shader, allowed)


def sensing_shader() -> str:
    """The shader of cameras that are asked for senses; empty: the process's own gives them.

    Raises:
        BadValue: no shader of this process does.
    """
    check_senses(_configured[0])
    pack = sensing_pack(Path(sapien.render.get_camera_shader_dir()))
    return str(pack) if pack.is_dir() else ""  # slim may have been refused: default gives them


def sensed(read: Read, near: float, far: float) -> Sensed:
    """Of the picture that a camera took last, in the same pass. `near`, `far` [m]: the camera's."""
    deep = read("GbufferDepth")
    # The inverse of Vulkan's projection of the range near .. far to 0 .. 1.
    # In place: a new array of this size costs five times as much as what is computed.
    depth = deep * np.float32(1 - near / far)
    np.subtract(np.float32(1), depth, out=depth)
    np.divide(np.float32(near), depth, out=depth)
    depth *= DEPTH_SCALE
    np.rint(depth, out=depth)
    depth /= DEPTH_SCALE
    depth[deep == 1] = 0
    ids = read("Segmentation")
    return Sensed(depth, np.array(ids[..., 0]), np.array(ids[..., 1]))


def capture(camera: sapien.render.RenderCameraComponent) -> Picture:
    """What a camera sees, (H, W, 3) uint8 RGB. Call `scene.update_render()` before."""
    camera.take_picture()
    return picture(camera.get_picture)


def picture(read: Read) -> Picture:
    """The picture that a camera took last, (H, W, 3) uint8 RGB; waits until it is drawn."""
    colour = read("Color")
    if colour.dtype == np.uint8:
        # Channel by channel: dropping the fourth byte at once, numpy copies pixel by pixel, which
        # takes five times as long.
        rgb = np.empty((*colour.shape[:2], 3), np.uint8)
        for i in range(3):
            rgb[..., i] = colour[..., i]
        return rgb
    # Ray tracing gives floats.
    return np.rint(np.clip(colour[..., :3], 0, 1) * 255).astype(np.uint8)


def _shader_folder(shader: str) -> str:
    if shader != "slim":
        return shader  # SAPIEN looks its own packs up by name
    source = Path(sapien.__file__).parent / "vulkan_shader"
    try:
        return str(slim_pack(source, sapien.__version__, cache_folder()))
    except (ShaderMismatch, NoCache, OSError) as error:
        _warn_slower(error)
        return "default"


def _warn_slower(error: Exception) -> None:
    warnings.warn(f"drawing with SAPIEN's slower default shader: {error}", stacklevel=4)
