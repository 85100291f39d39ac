"""One builtin pack for all asset tests of a run."""

import pytest

from rtphys.assets.build import build
from rtphys.assets.pack import Pack


@pytest.fixture(scope="session")
def builtin(tmp_path_factory) -> Pack:
    return Pack(build(tmp_path_factory.mktemp("builtin") / "pack"))
