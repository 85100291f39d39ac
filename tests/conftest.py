"""Without a Vulkan device the tests that draw are skipped, except where CI promises one."""

import os
import sys
from pathlib import Path

import pytest

from rtphys import doctor

# Helpers that tests of several folders share: synthetic episodes, jobs of worker processes.
for folder in ("data", "campaign/workers"):
    sys.path.insert(0, str(Path(__file__).parent / folder))

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
