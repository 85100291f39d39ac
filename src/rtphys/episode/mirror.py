"""A second world for pictures alone, so that drawing cannot change the simulated one."""

from collections.abc import Sequence

from rtphys.assets.pack import Pack
from rtphys.episode.instance import Instance, prepare
from rtphys.episode.observation import CameraView
from rtphys.sim import renderer
from rtphys.sim.camera import SHORT
from rtphys.sim.studio import Studio, matrices

_SHORT_NAMES = {official: short for short, official in SHORT.items()}


class Mirror:
    """Draws the simulated world. Built on the first picture, because a blind policy needs none.

    Args:
        instance: the simulated one.
        cameras: short or official names.
    """

    def __init__(self, instance: Instance, pack: Pack, cameras: Sequence[str]) -> None:
        self._instance, self._pack, self._cameras = instance, pack, tuple(cameras)
        self._studio: Studio | None = None

    def views(self, packed: bytes, frame: int) -> dict[str, CameraView]:
        """Every camera, by short name, of the state that `scene.pack_poses` gave.

        Args:
            frame: number of frames since the policy stage began; lights may flicker by it.

        Raises:
            NoRenderer: no device to draw with.
        """
        studio = self._opened()
        studio.light(self._instance.look.backdrop.lights_at(frame))
        studio.show(packed)
        pictures, poses = studio.pictures(), studio.poses()
        return {
            _SHORT_NAMES[spec.name]: CameraView(
                pictures[spec.name], *matrices(spec, poses[spec.name])
            )
            for spec in studio.specs
        }

    def _opened(self) -> Studio:
        if self._studio is None:
            renderer.hold_anchor()
            recipe, task = self._instance.recipe, self._instance.task
            drawn = prepare(recipe, task, self._pack, visuals=True)
            self._studio = Studio(drawn.world, self._cameras)
        return self._studio
