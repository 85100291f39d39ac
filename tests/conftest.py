"""Without a Vulkan device the tests that draw are skipped, except where CI promises one."""

import os
import sys
from pathlib import Path

# So that tests compute the bits that every other process of rtphys does.
import rtphys.core.pinned  # noqa: F401  # isort: skip  (before numpy)

import numpy as np
import pytest
from hypothesis import settings

from rtphys import doctor

settings.register_profile("any machine", deadline=None)  # a loaded one is slow, not wrong
settings.load_profile("any machine")

# No test pulls the plug; tests of what is on the disk by when replace this by their own.
os.fsync = lambda handle: None

# Helpers of several folders' tests: synthetic episodes, records, jobs of worker processes.
for folder in ("data", "campaign", "physics", "results"):
    sys.path.insert(0, str(Path(__file__).parent / folder))
sys.path.append(str(Path(__file__).parents[1] / "scripts"))  # their functions are tested too

# Written by the set-up once a frame was drawn; spares every run a probe.
DRAWS = Path(sys.prefix) / ".driver-stamp"


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    drawing = [item for item in items if item.get_closest_marker("render")]
    if not drawing or DRAWS.is_file() or os.environ.get("CI"):
        return
    finding = doctor.check_renderer()
    if finding.status == "fail":
        reason = f"no renderer: {finding.detail}; `rtphys doctor` names the cure"
        for item in drawing:
            item.add_marker(pytest.mark.skip(reason=reason))


@pytest.fixture(scope="session")
def pack():
    from rtphys.assets.pack import default_pack

    return default_pack()


@pytest.fixture(scope="session")
def expert_actions() -> np.ndarray:
    """Recorded commands (n, 14) that solve click_bell, seed 0."""
    from rtphys.assets.pack import default_pack
    from rtphys.episode.control import actions_of
    from rtphys.episode.generate import attempt
    from rtphys.spec.episode import EpisodeSpec
    from rtphys.task.spec import load_task

    done = attempt(
        EpisodeSpec("click_bell", "clean").at(0), load_task("click_bell"), default_pack()
    )
    assert done.accepted, done.reason
    assert done.recording is not None
    actions = actions_of(done.recording)
    actions.setflags(write=False)  # all tests share it
    return actions
