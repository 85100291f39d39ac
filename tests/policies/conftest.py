"""A real episode with painted pictures, for policies behind a server."""

from collections.abc import Callable
from importlib.util import find_spec

import numpy as np
import pytest

from rtphys.assets.pack import default_pack
from rtphys.episode import CameraView, PolicyEpisode, View, begin
from rtphys.episode.observation import Mirror
from rtphys.spec.episode import EpisodeSpec
from rtphys.task.spec import load_task

# What needs the extra rtphys[serve] is left out where that is not installed.
NEEDS_A_SERVER = (
    *("test_websocket.py", "test_openpi.py", "test_xpolicylab.py", "test_hostile_server.py"),
    "test_wrong_languages.py",
)
collect_ignore = [] if find_spec("websockets") and find_spec("msgpack") else [*NEEDS_A_SERVER]
SHADES = {"head": 10, "left": 20, "right": 30}


@pytest.fixture
def painted(monkeypatch: pytest.MonkeyPatch) -> None:
    """Cameras see one colour each, so that no renderer is needed."""

    def view(self: Mirror, packed: bytes, frame: int) -> View:
        eye, views = np.eye(4, dtype=np.float32), dict[str, CameraView]()
        for name, shade in SHADES.items():
            picture = np.full((240, 320, 3), (shade, 0, 255), np.uint8)
            views[name] = CameraView(picture, eye[:3, :3], eye[:3], eye)
        return View(views)

    monkeypatch.setattr(Mirror, "view", view)


@pytest.fixture
def new_episode(painted: None) -> Callable[[], PolicyEpisode]:
    recipe, task = EpisodeSpec("click_bell", "clean").at(0), load_task("click_bell")
    return lambda: begin(recipe, task, default_pack())


@pytest.fixture
def episode(new_episode: Callable[[], PolicyEpisode]) -> PolicyEpisode:
    return new_episode()
