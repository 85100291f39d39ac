"""The builtin pack, as it was made of the code at hand."""

import pytest

from rtphys.assets.pack import Pack, builtin_pack


@pytest.fixture(scope="session")
def builtin() -> Pack:
    return builtin_pack()
